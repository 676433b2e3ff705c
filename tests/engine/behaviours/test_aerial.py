"""Drones that are targets."""

import numpy as np
import pytest

from eyas.engine.behaviours.aerial import averaged, over_all
from eyas.engine.core.errors import SpawnError
from eyas.engine.sim.scenes import load_solids
from eyas.engine.state.motion import SampledMotion
from eyas.engine.state.terrain import reliefs
from eyas.engine.targets.catalogue import kind_index
from eyas.engine.targets.habit import AERIAL, Behaviour
from eyas.engine.task.clearance import Clearance, Margin
from eyas.engine.world.weather import Season

from .conftest import CLOCK, group, table_of

BODY = Margin(aside=0.25, above=0.1, ground=0.3)


def flights(ground, behaviour: Behaviour, count: int = 6) -> np.ndarray:
    return table_of(ground, group("Quadrotor", count, behaviour=behaviour))


def places(table) -> np.ndarray:
    return np.stack([table[axis] for axis in "xyz"], axis=-1).astype(np.float64)


@pytest.mark.parametrize("behaviour", sorted(AERIAL))
def test_drones_fly_through_nothing(hills, behaviour):
    table, scene = flights(hills, behaviour), hills.scene
    assert (table["present"] == 1.0).all()
    kinds = np.full(table.shape[1], kind_index("Quadrotor"), np.int32)
    motion = SampledMotion(table, kinds, CLOCK.rate, 0.0).packed()
    at = places(table).reshape(-1, 3)
    solids = load_solids(scene.name, 0, Season.SUMMER)
    lifted = Clearance(solids, scene.terrain, motion).lifted(at, BODY)
    assert (lifted <= at[:, 2] + 0.15).mean() > 0.99  # those below crowns brush a twig


@pytest.mark.parametrize("behaviour", sorted(AERIAL))
def test_velocities_are_changes_of_place(city, behaviour):
    table = flights(city, behaviour)
    said = np.stack([table[f"velocity_{axis}"] for axis in "xyz"], axis=-1)[1:-1]
    moved = (places(table)[2:] - places(table)[:-2]) * CLOCK.rate / 2.0
    assert np.quantile(np.abs(said - moved), 0.95) < 0.4  # where speed changes it is a mean
    assert np.abs(table["velocity_z"]).max() < 2.6
    assert (np.diff(table["travelled"], axis=0) >= 0.0).all()


def test_those_between_houses_are_low_and_the_others_above_all(city):
    def above_ground(behaviour):
        at = places(flights(city, behaviour))
        return at[..., 2] - reliefs(city.scene.terrain, at[..., :2]) - city.scene.terrain.floor

    for low in (Behaviour.ROAM, Behaviour.FLEE):
        assert above_ground(low).min() > 1.5
        assert above_ground(low).max() < 4.0
    for high in (Behaviour.CRUISE, Behaviour.ORBIT):
        assert above_ground(high).min() > 7.5


def test_who_flees_is_faster_and_turns_more(city):
    roams, flees = (flights(city, each) for each in (Behaviour.ROAM, Behaviour.FLEE))

    def fastest(table):
        return np.hypot(table["velocity_x"], table["velocity_y"]).max()

    assert fastest(flees) > 1.5 * fastest(roams)


def test_orbits_are_closed(city):
    table = flights(city, Behaviour.ORBIT)
    middle = places(table)[..., :2].mean(axis=0)
    radius = np.hypot(*np.moveaxis(places(table)[..., :2] - middle, -1, 0))
    assert (radius.max(axis=0) < 40.0).all()
    assert (np.abs(np.unwrap(table["yaw"], axis=0)[-1] - table["yaw"][0]) > 6.0).all()


def test_seeds_differ_and_repeat(city):
    one = group("Quadrotor", behaviour=Behaviour.CRUISE)
    assert np.array_equal(table_of(city, one, 1), table_of(city, one, 1))
    assert not np.array_equal(table_of(city, one, 1), table_of(city, one, 2))


def test_heights_stay_above_and_climb_slowly():
    top = np.array([0.0, 0.0, 10.0, 0.0, 0.0, 0.0])
    high = over_all(top, 1.0)
    assert high.tolist() == [5.0, 7.5, 10.0, 7.5, 5.0, 2.5]
    assert averaged(np.arange(5.0), 1).tolist() == [0.5, 1.0, 2.0, 3.0, 3.5]


def test_no_room_between_houses_is_one_line(city):
    crowded = group("Quadrotor", 2, breadth=400.0, behaviour=Behaviour.ROAM)
    with pytest.raises(SpawnError, match=r"objects\.max_count"):
        table_of(city, crowded)
