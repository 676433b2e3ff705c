"""Drivers who hide or evade."""

from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError, MissingExtraError
from eyas.engine.sim.cover import cover_of
from eyas.engine.state.roads import RoadGraph
from eyas.engine.traffic import library
from eyas.engine.traffic.config import Demand, Drivers, TrafficConfig
from eyas.engine.traffic.cover import Stretch, cover_hash
from eyas.engine.traffic.library import EVADING_MIX, find_recording
from eyas.engine.traffic.record import record
from eyas.engine.traffic.recording_file import from_bytes, load, to_bytes
from eyas.engine.traffic.smoothing import smooth
from eyas.engine.world.maps import MAPS

COVER = (Stretch("n11-n12_0", 40.0, 70.0), Stretch("n21-n22_1", 30.0, 50.0))
"""On the grid."""

SHIPPED = [
    ("village", Drivers.HIDING),
    ("citystreet", Drivers.HIDING),
    ("citystreet", Drivers.EVADING),
    ("downtown", Drivers.EVADING),
]


def shipped(name, drivers):
    (file,) = (one for one in MAPS.get(name).shipped_traffic() if f"-{drivers}." in one.name)
    return load(file)


@pytest.mark.sumo
@pytest.mark.usefixtures("sumo")
@pytest.mark.parametrize("drivers", [Drivers.HIDING, Drivers.EVADING])
def test_drivers_are_part_of_what_a_recording_is(grid: RoadGraph, drivers: Drivers):
    config = TrafficConfig(max_vehicles=12, drivers=drivers)
    made = record("grid", 0, grid, config, 40.0, 1, cover=COVER)
    assert to_bytes(record("grid", 0, grid, config, 40.0, 1, cover=COVER)) == to_bytes(made)
    assert made.provenance.config.drivers is drivers
    assert made.provenance.cover == cover_hash(COVER)
    assert from_bytes(to_bytes(made), "copy").provenance == made.provenance
    usual = record("grid", 0, grid, TrafficConfig(max_vehicles=12), 40.0, 1, cover=COVER)
    assert usual.provenance.cover == ""
    assert usual.provenance != replace(made.provenance, cover="")
    assert np.abs(usual.position - made.position).max() > 20.0


@pytest.mark.sumo
@pytest.mark.usefixtures("sumo")
def test_who_hides_stays_for_seconds_in_cover_and_nowhere_else(grid: RoadGraph):
    config = TrafficConfig(max_vehicles=12, drivers=Drivers.HIDING)
    made = record("grid", 0, grid, config, 300.0, 1, cover=COVER)
    usual = record("grid", 0, grid, TrafficConfig(max_vehicles=12), 300.0, 1)
    # The road from n11 to n12 leads north along x = -60, that from n21 to n22 along x = 60.
    slow = []
    for recording in (made, usual):
        step = np.diff(recording.position, axis=0)
        speed = 10.0 * np.hypot(step[..., 0], step[..., 1])
        east, north = np.moveaxis(recording.position[1:], -1, 0)
        road = np.minimum(abs(east - 60.0), abs(east + 60.0)) < 8.0
        middle = road & (abs(north) < 25.0)
        slow.append(int((middle & (speed < 6.0)).sum()))
    assert slow[0] > 100 > 5 * slow[1]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "drivers"), SHIPPED)
def test_shipped_drivers_drive_like_cars(name, drivers):
    recording = shipped(name, drivers)
    assert recording.duration == library.STANDARD_DURATION
    tracks = smooth(recording)
    assert tracks.present.all()
    assert (tracks.travelled[-1] > 7.0 * recording.duration).all()
    step = np.diff(recording.position, axis=0)
    assert 10.0 * np.hypot(step[..., 0], step[..., 1]).max() < 26.0  # the middle swings in turns
    speed = np.hypot(*np.moveaxis(tracks.velocity, -1, 0))
    assert speed.max() < 20.5
    bend = np.diff(tracks.velocity, axis=0) * tracks.rate
    assert np.hypot(bend[..., 0], bend[..., 1]).max() < 30.0
    # Nobody stands for ever: the longest halt of the usual recordings is as long.
    halts = np.lib.stride_tricks.sliding_window_view(speed < 0.1, 400, axis=0).all(axis=-1)
    assert not halts.any()
    # Middles nearer than 1.8 m overlap, in turns: so do those of 2 in 1,000 usual samples.
    near = 0
    for position in tracks.position[::5]:
        apart = np.hypot(*np.moveaxis(position[:, None] - position, -1, 0))
        near += (apart + 100.0 * np.eye(len(apart))).min() < 1.8
    assert near <= 0.004 * len(tracks.position[::5])


@pytest.mark.parametrize("name", ["village", "citystreet", "downtown"])
def test_shipped_drivers_know_the_cover_of_todays_map(name):
    cover = cover_of(name, 0)
    assert len(cover) > 20
    for map_name, drivers in SHIPPED:
        if map_name == name:
            assert shipped(name, drivers).provenance.cover == cover_hash(cover)


def test_tunnels_are_cover_and_open_roads_are_not():
    lengths = [stretch.end - stretch.start for stretch in cover_of("village", 0)]
    assert len(lengths) == 4 * 10  # ten tunnels, two lanes each way
    assert min(lengths) > 25.0
    assert max(lengths) < 40.0
    assert cover_of("farmland", 0) == ()


def test_shipped_drivers_need_no_sumo_and_are_not_taken_for_others(tmp_path, monkeypatch):
    def refused(purpose):
        raise MissingExtraError(purpose, "sumo")

    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(library, "sumo_version", refused)
    recipe = MAPS.get("citystreet")
    files = recipe.shipped_traffic()
    evading = TrafficConfig(drivers=Drivers.EVADING, vehicle_type=EVADING_MIX)
    hiding = TrafficConfig(drivers=Drivers.HIDING)
    for config in (hiding, evading):
        found = find_recording(recipe.roads(0), config, shipped=files)
        assert found.provenance.config.drivers is config.drivers
    usual = find_recording(recipe.roads(0), TrafficConfig(), shipped=files)
    assert usual.provenance.config.drivers is Drivers.NORMAL
    with pytest.raises(MissingExtraError, match="no recording fits"):
        find_recording(recipe.roads(0), TrafficConfig(drivers=Drivers.EVADING), shipped=files)


def test_who_comes_and_goes_does_not_hide():
    with pytest.raises(ConfigError, match=r"must be .normal. where demand is .respawn."):
        TrafficConfig(demand=Demand.RESPAWN, drivers=Drivers.HIDING)
