import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.core.errors import DataFileError, OutputError
from eyas.engine.traffic.recording import ANGLE_UNIT, POSITION_UNIT, TrafficRecording, quantised
from eyas.engine.traffic.recording_file import (
    RecordingFile,
    _checksum,
    _unpacked_npz,
    from_bytes,
    load,
    save,
    to_bytes,
)


def test_a_loaded_recording_equals_the_saved_one(wandering: TrafficRecording, tmp_path: Path):
    save(wandering, tmp_path / "drive.npz")
    back = load(tmp_path / "drive.npz")
    np.testing.assert_allclose(back.position, wandering.position, rtol=0, atol=1e-9)
    np.testing.assert_allclose(back.yaw, wandering.yaw, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(back.present, wandering.present)
    assert back.provenance == wandering.provenance
    assert back.rate == 10.0
    assert (back.vehicle_length == 5.0).all()
    assert (back.actors, back.duration) == (3, 20.0)
    assert [entry.name for entry in tmp_path.iterdir()] == ["drive.npz"]
    assert RecordingFile.read(tmp_path / "drive.npz").outline().provenance == wandering.provenance


def test_equal_recordings_give_equal_bytes(wandering: TrafficRecording):
    data = to_bytes(wandering)
    assert to_bytes(from_bytes(data, "memory")) == data


def test_an_actor_that_appears_far_away_is_kept(wandering: TrafficRecording):
    position = wandering.position.copy()
    position[100:, 0] += [1500.0, -900.0]
    moved = replace(wandering, position=position)
    np.testing.assert_allclose(from_bytes(to_bytes(moved), "far").position, position, atol=1e-9)


def test_a_file_of_before_is_read(wandering: TrafficRecording, tmp_path: Path):
    data = to_bytes(wandering)
    new = from_bytes(data, "new")
    header = json.loads(_unpacked_npz(data)["header"].tobytes())
    header["format"] = "eyas traffic recording 2"
    arrays = {
        "header": np.frombuffer(json.dumps(header).encode(), np.uint8),
        "present": np.packbits(new.present.T, axis=-1),
    }
    position = quantised(new.position, POSITION_UNIT).transpose(1, 2, 0)
    for name, values in (("position", position), ("yaw", quantised(new.yaw, ANGLE_UNIT).T)):
        second = np.diff(values, n=2, axis=-1)
        arrays[f"{name}_start"] = values[..., :2].astype(np.int32)
        arrays[f"{name}_second"] = np.zeros(second.shape, np.int8)
        arrays[f"{name}_far"] = np.flatnonzero(second)
        arrays[f"{name}_far_second"] = second[second != 0].astype(np.int32)
    np.savez_compressed(tmp_path / "old.npz", **arrays, checksum=_checksum(arrays))
    old = load(tmp_path / "old.npz")
    np.testing.assert_array_equal(old.position, new.position)
    np.testing.assert_array_equal(old.yaw, new.yaw)
    assert RecordingFile.read(tmp_path / "old.npz").outline().provenance == new.provenance


@pytest.mark.parametrize("share", [0.0, 0.01, 0.5, 0.99])
def test_a_file_that_is_cut_off_is_refused(wandering: TrafficRecording, share: float):
    data = to_bytes(wandering)
    with pytest.raises(DataFileError, match=r"^drive\.npz: not a complete traffic recording"):
        from_bytes(data[: int(share * len(data))], "drive.npz")


def test_no_damaged_byte_goes_unnoticed(wandering: TrafficRecording):
    data = to_bytes(wandering)
    for place in range(0, len(data), 29):
        broken = bytearray(data)
        broken[place] ^= 0x55
        try:  # bytes that only dress the archive may differ, the content may not
            back = from_bytes(bytes(broken), "drive.npz")
        except DataFileError:
            continue
        np.testing.assert_allclose(back.position, wandering.position, rtol=0, atol=1e-9)
        assert back.provenance == wandering.provenance


def test_changed_content_fails_the_checksum(wandering: TrafficRecording):
    arrays = _unpacked_npz(to_bytes(wandering))
    arrays["origin"] = arrays["origin"] + 1
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    with pytest.raises(DataFileError, match="damaged: its checksum"):
        from_bytes(buffer.getvalue(), "drive.npz")


def test_other_files_are_refused(tmp_path: Path):
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    np.save(tmp_path / "array.npy", np.zeros(3))
    (tmp_path / "text.npz").write_text("not an archive")
    for name in ("other.npz", "array.npy", "text.npz"):
        with pytest.raises(DataFileError, match=rf"{name}: not a (complete )?traffic recording"):
            load(tmp_path / name)
    for name in ("missing.npz", "."):
        with pytest.raises(DataFileError, match="cannot read"):
            load(tmp_path / name)


def test_a_folder_that_is_not_there_is_an_output_error(wandering: TrafficRecording, tmp_path: Path):
    with pytest.raises(OutputError, match="cannot write"):
        save(wandering, tmp_path / "missing" / "drive.npz")
