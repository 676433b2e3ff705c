"""The wind among buildings."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.sim import urban_wind
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.urban_wind import winds_over
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.terrain import Terrain
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.wind_field import UNIT, WindField, wind_among
from eyas.lanes import interpreted

from ...kit.flight import Drones, held

SIDE, HIGH = 30, 20.0
BLOCK = slice(13, 17)


@pytest.fixture(scope="module")
def table():
    """The wind over a block of 20 x 20 x 20 m, from the west, and so on round the compass."""
    heights = np.zeros((SIDE, SIDE))
    heights[BLOCK, BLOCK] = HIGH
    return winds_over(heights)


def profile(height):
    return (height / 10.0) ** 0.22


def test_far_from_buildings_it_is_the_profile_over_open_ground(table):
    east = UNIT * table[0, :, 2, 2]
    heights = 5.0 * np.arange(len(east)) + 2.5
    assert east[:, 0] == pytest.approx(profile(heights), rel=0.02)
    assert np.abs(east[:, 1:]).max() < 0.02


def test_nothing_blows_through_walls_and_behind_them_it_turns_back(table):
    wind = UNIT * table[0]
    assert not wind[:3, 14:16, 14:16].any()
    row = wind[1, 14]
    assert row[18, 0] < 0.0  # in the lee
    assert 0.0 < row[24, 0] < 0.8 * profile(7.5)  # in the wake
    assert row[12, 0] < 0.5 * profile(7.5)  # before the wall
    assert wind[3, 14, 12, 2] > 0.1  # up over its edge
    beside = wind[1, 17, 15, 0]
    assert beside > 1.03 * profile(7.5)
    assert wind[4, 15, 15, 0] > 1.03 * profile(22.5)


def test_what_flows_in_flows_out(table):
    """Around a cell of the grid, read back at the middles of cells, so to their order."""
    wind = UNIT * table[3].astype(float)
    open_sky = wind[6:12, 2:-2, 2:-2]
    out = np.gradient(open_sky[..., 0], axis=2) + np.gradient(open_sky[..., 1], axis=1)
    out += np.gradient(open_sky[..., 2], axis=0)
    assert np.abs(out).max() < 0.02


def test_a_quarter_turn_of_the_wind_turns_all_of_it(table):
    north = UNIT * np.rot90(table[0].astype(float), axes=(2, 1))
    turned = np.stack([-north[..., 1], north[..., 0], north[..., 2]], axis=-1)
    assert UNIT * table[4] == pytest.approx(turned, abs=0.03)


def test_a_street_leads_the_wind_along(monkeypatch):
    monkeypatch.setattr(urban_wind, "_DIRECTIONS", 8)
    heights = np.zeros((SIDE, SIDE))
    heights[4:26, 8:13] = heights[4:26, 16:21] = HIGH
    wind = UNIT * winds_over(heights)[1]  # from the south-west
    east, north, _ = wind[1, 15, 14]
    assert north > 2.0 * abs(east)


def test_between_its_points_it_changes_evenly():
    made = np.random.default_rng(1).integers(-900, 900, (8, 4, 5, 6, 3)).astype(np.int16)
    field = WindField(made, -10.0, -20.0, 5.0, 1)
    among = interpreted(wind_among)
    for direction in range(8):
        east, north = (f(2 * math.pi * direction / 8) for f in (math.cos, math.sin))
        assert among(field, east, north, 5.0, -5.0, 12.5) == pytest.approx(
            UNIT * made[direction, 2, 3, 3], abs=1e-9
        )
    east, north = (f(2 * math.pi * 2.5 / 8) for f in (math.cos, math.sin))
    halfway = among(field, east, north, 7.5, -2.5, 10.0)
    assert halfway == pytest.approx(UNIT * made[2:4, 1:3, 3:5, 3:5].mean(axis=(0, 1, 2, 3)))
    assert among(field, 1.0, 0.0, 1e5, -1e5, -3.0) == pytest.approx(UNIT * made[0, 0, 0, -1])


def test_a_drone_in_the_lee_is_blown_less_far_than_one_in_the_open(table):
    config = TrackerConfig(supervised=False, drag_area=0.05, wind={"speed": 8.0, "buildings": True})
    drones = Drones(2, config=config)
    drones.memory = drones.memory._replace(field=WindField(table, 0.0, 0.0, 5.0, 1))
    drones.memory.flight.wind.mean[:] = 8.0, 0.0
    drones.memory.flight.wind.along[:] = 1.0, 0.0
    first = np.array([90.0, 10.0])
    drones.start(np.array([[90.0, 72.5, 7.5, 0.0, 1.0], [10.0, 10.0, 7.5, 0.0, 1.0]]))
    log = drones.fly(held(steps=1000))
    lee, free = log.position[-1, :, 0] - first
    assert free > 0.15
    assert lee < 0.3 * free


@pytest.mark.thorough
def test_drones_feel_it_on_a_map():
    wind = {"speed": 8.0, "direction": 0.3}
    flown = {"supervised": False, "drag_area": 0.05}
    places = []
    for buildings in (False, True):
        tracker = flown | {"wind": wind | {"buildings": buildings}}
        made = build_simulation(SimConfig.model_validate({"tracker": tracker}), each_alone(3))
        made.reset()
        made.advance(np.zeros((3, 4)), 200)
        places.append(made.snapshot.trackers.position.copy())
        made.close()
    apart = np.abs(places[0] - places[1]).max(axis=1)
    assert (apart > 1e-3).all()
    assert (apart < 2.0).all()


def test_maps_that_are_too_large_are_refused_in_one_line(monkeypatch):
    heights = np.zeros((10, 500), np.float32)
    heights[5, 5] = heights[5, 495] = 20.0
    monkeypatch.setattr(urban_wind, "height_map", lambda *_: heights)
    scene = SimpleNamespace(size=(2500.0, 50.0), terrain=Terrain.flat(0.0), name="long")
    with pytest.raises(ConfigError, match=r"^tracker\.wind\.buildings: true is not allowed"):
        urban_wind.wind_field(scene)
