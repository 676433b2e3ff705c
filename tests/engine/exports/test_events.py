"""Raw files of events, read as their format says."""

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.camera.esim import EVENT
from eyas.engine.core.errors import ConfigError
from eyas.engine.exports.episode_files import EventWriter, evt2
from eyas.engine.exports.registry import chosen_writers
from eyas.engine.exports.writer import Run
from eyas.engine.sim.config import SimConfig


def read(data: bytes) -> np.ndarray:
    """Read EVT 2.0 word by word, as Metavision's documentation has it."""
    while data.startswith(b"%"):
        line, _, data = data.partition(b"\n")
    assert line == b"% end"
    high, events = None, []
    for word in np.frombuffer(data, "<u4").tolist():
        kind = word >> 28
        if kind == 8:
            high = word & 0xFFFFFFF
        else:
            time = (high << 6) | ((word >> 22) & 63)
            events.append(((word >> 11) & 2047, word & 2047, kind, time))
    return np.array(events, EVENT)


def some_events(count: int) -> np.ndarray:
    rng = np.random.default_rng(1)
    events = np.zeros(count, EVENT)
    events["x"], events["y"] = rng.integers(0, 640, count), rng.integers(0, 480, count)
    events["p"] = rng.integers(0, 2, count)
    events["t"] = np.sort(rng.integers(0, 30_000_000, count))
    return events


def test_events_come_back():
    events = some_events(5000)
    np.testing.assert_array_equal(read(evt2(events, (640, 480), 7)), events)


def test_no_events_make_an_empty_file():
    assert read(evt2(np.zeros(0, EVENT), (640, 480), 0)).shape == (0,)


def run_of(tmp_path, **camera) -> Run:
    return Run(tmp_path, ("DRONE0",), SimConfig(camera=CameraConfig(**camera)),
               target_direction=False, jpeg_quality=95, depth_unit=0.01)  # fmt: skip


def test_the_writer_needs_the_sensor(tmp_path):
    with pytest.raises(ConfigError, match=r"'events' needs camera\.events\.enabled"):
        EventWriter(run_of(tmp_path))


def test_a_sensor_that_is_too_large_for_the_format_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="at most 2048"):
        EventWriter(run_of(tmp_path, width=3000, events={"enabled": True}))


def test_flow_is_refused_with_a_rolling_shutter(tmp_path):
    (flow,) = chosen_writers(["flow"])
    with pytest.raises(ConfigError, match="rolling shutter"):
        flow(run_of(tmp_path, shutter={"readout": 0.01}))


def test_a_summary_is_the_number_of_frames(tmp_path):
    writer = EventWriter(run_of(tmp_path, events={"enabled": True}))
    assert writer.read(tmp_path) is None
    (tmp_path / "events.raw").write_bytes(evt2(some_events(20), (320, 240), 13))
    assert writer.read(tmp_path).frames == 13
