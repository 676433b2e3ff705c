"""Recordings that someone else has made, with right checksums and any content."""

import io
import json
import lzma
import os
import tracemalloc
import zipfile

import numpy as np
import pytest

from eyas.engine.core.errors import DataFileError
from eyas.engine.traffic.recording_file import (
    _checksum,
    _expanded,
    _unpacked_npz,
    from_bytes,
    load,
    to_bytes,
)

BOMB = 10**12


def packed(arrays) -> bytes:
    """Return a file of these arrays with the checksum that it must have."""
    arrays = {name: np.asarray(array) for name, array in arrays.items() if name != "checksum"}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays, checksum=_checksum(arrays))
    return buffer.getvalue()


@pytest.fixture
def arrays(wandering):
    return _unpacked_npz(to_bytes(wandering))


def with_header(arrays, **changes):
    header = {**json.loads(arrays["header"].tobytes()), **changes}
    return {**arrays, "header": np.frombuffer(json.dumps(header).encode(), np.uint8)}


def refused(data: bytes) -> str:
    """Return the line with which a file is refused, for which little memory may be used."""
    tracemalloc.start()
    try:
        with pytest.raises(DataFileError) as caught:
            from_bytes(data, "drive.npz")
        assert tracemalloc.get_traced_memory()[1] < 64 << 20
    finally:
        tracemalloc.stop()
    line = str(caught.value)
    assert line.startswith("drive.npz: ")
    assert "\n" not in line
    assert "\x1b" not in line
    return line


@pytest.mark.parametrize(
    "changes",
    [
        {"rate": 0},
        {"rate": float("nan")},
        {"rate": "fast"},
        {"rate": None},
        {"shape": [BOMB, 3]},
        {"shape": []},
        {"shape": 7},
        {"vehicle_length": -1},
        {"provenance": None},
        {"provenance": {"map_name": 3}},
        {"provenance": []},
        {"format": "eyas traffic recording 9\n\x1b[31m"},
        {"format": None},
    ],
)
def test_a_header_that_says_nonsense_is_refused(arrays, changes):
    refused(packed(with_header(arrays, **changes)))


@pytest.mark.parametrize("text", [b"", b"{", b"3", b"[" * 100_000, b"\xff\xfe", b"{}"])
def test_a_header_that_is_none_is_refused(arrays, text):
    refused(packed({**arrays, "header": np.frombuffer(text, np.uint8)}))


def test_a_type_in_the_origin_that_is_wrong_is_refused(arrays):
    origin = json.loads(arrays["header"].tobytes())["provenance"]
    for change in ({"graph_hash": 5}, {"options": 3}, {"config": {"colour": "red"}}, {"more": 1}):
        refused(packed(with_header(arrays, provenance={**origin, **change})))


@pytest.mark.parametrize("name", ["origin", "ahead", "aside", "yaw_start", "present"])
def test_arrays_that_do_not_fit_are_refused(arrays, name):
    array = arrays[name]
    for other in (array[:1], array[..., :1], array.astype(np.float64) + 0.5, array.ravel()):
        refused(packed({**arrays, name: other}))
    del arrays[name]
    refused(packed(arrays))


def test_vehicles_out_of_the_world_are_refused(arrays):
    far = np.full_like(arrays["ahead"], 30_000, np.int16)
    assert "out of the world" in refused(packed({**arrays, "ahead": far}))


def test_larger_changes_than_there_are_places_are_refused(arrays):
    for place in (arrays["ahead"].size, 2**40):
        more = {"ahead_far": np.array([place]), "ahead_far_value": np.array([1000])}
        refused(packed({**arrays, **more}))


class Trap:
    """An object that makes a file when it is unpickled."""

    def __init__(self, path) -> None:
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)


def test_objects_are_neither_made_nor_accepted(arrays, tmp_path):
    trap = tmp_path / "sprung"
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays, more=np.array([Trap(trap)], object))
    refused(buffer.getvalue())
    assert not trap.exists()


def npy(shape: tuple[int, ...], content: bytes = b"") -> bytes:
    member = io.BytesIO()
    layout = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(member, layout)
    return member.getvalue() + content


@pytest.mark.parametrize("content", [b"", b"\0" * 8])
def test_a_header_of_the_size_of_a_bomb_makes_no_array(arrays, content):
    buffer = io.BytesIO(packed(arrays))
    with zipfile.ZipFile(buffer, "a") as archive:
        archive.writestr("more.npy", npy((BOMB,), content))
    refused(buffer.getvalue())


def test_a_bomb_is_not_decompressed():
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        with archive.open("header.npy", "w") as member:
            for _ in range(300):
                member.write(bytes(1 << 20))
    assert len(buffer.getvalue()) < 4 << 20
    refused(buffer.getvalue())


def test_a_bomb_of_xz_is_not_decompressed():
    bomb = np.frombuffer(lzma.compress(bytes(64 << 20), preset=0), np.uint8)
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match="larger than"):
            _expanded(bomb, 16 << 20)
        assert tracemalloc.get_traced_memory()[1] < 40 << 20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("content", [b"", b"no xz", lzma.compress(b"no npz")])
def test_a_rest_that_is_none_is_refused(arrays, content):
    rest = np.frombuffer(content, np.uint8)
    refused(packed({"header": arrays["header"], "rest": rest}))


def test_what_is_no_ordinary_file_is_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", type(tmp_path)("/dev/zero")):
        with pytest.raises(DataFileError, match="cannot read: not an ordinary file"):
            load(path)
