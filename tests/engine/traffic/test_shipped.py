"""The recording in the package fits the map in the package, without SUMO."""

import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import shapely

from eyas.engine.core.errors import MissingExtraError
from eyas.engine.state.motion import ActorState
from eyas.engine.traffic import library
from eyas.engine.traffic.config import Demand, Mix, TrafficConfig, VehicleType
from eyas.engine.traffic.library import (
    STANDARD_DURATION,
    TEST_DURATION,
    TEST_TRAFFIC,
    find_recording,
)
from eyas.engine.traffic.network import graph_hash
from eyas.engine.traffic.recording_file import load
from eyas.engine.traffic.replay import Replay
from eyas.engine.traffic.smoothing import smooth
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import TEST_TOWNS
from eyas.engine.world.roads.areas import road_area
from eyas.maps.citystreet import CITYSTREET
from eyas.maps.downtown import DOWNTOWN

WITHOUT_SUMO = """
import sys
sys.modules.update(dict.fromkeys(["libsumo", "sumo", "sumolib", "traci"]))
from eyas.engine.traffic import library
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import find_recording
from eyas.engine.world.maps import MAPS
from eyas.maps.citystreet import CITYSTREET
def actors(config, trackers):
    shipped = CITYSTREET.shipped_traffic()
    roads = CITYSTREET.roads(0)
    return find_recording(roads, config, trackers=trackers, shipped=shipped).actors

groups = TrafficConfig(demand="respawn")
print(actors(TrafficConfig(), 4), actors(groups, 1), actors(groups, 4))
for size in (5, 10):  # of the manual's example, and of the original's own file
    print(actors(TrafficConfig(demand="respawn", group_size=size), 1))
"""


def recording(map_seed, config, trackers=1):
    shipped = CITYSTREET.shipped_traffic()
    return find_recording(CITYSTREET.roads(map_seed), config, trackers=trackers, shipped=shipped)


def test_the_default_traffic_of_citystreet_is_shipped():
    config = TrafficConfig(colour=(1.0, 1.0, 1.0))
    shipped = recording(0, config)
    assert shipped.duration == STANDARD_DURATION >= 20 * 60
    assert shipped.provenance.map_name == "citystreet"
    assert shipped.present.all()
    assert shipped.present.shape[1] == 40
    tracks = smooth(shipped)
    # No jam: every car gets on, all the time.
    assert (tracks.travelled[-1] > 7.0 * STANDARD_DURATION).all()
    # No car stands in another: middles of cars 1.8 m wide are nearest side by side.
    for position in tracks.position[::50]:
        apart = np.hypot(*np.moveaxis(position[:, None] - position, -1, 0))
        assert (apart + 100.0 * np.eye(40)).min() > 1.8


@pytest.mark.parametrize("demand", Demand)
def test_no_car_leaves_the_asphalt(flat_motion, demand):
    """Nine tenths of its length and width stay on it, each second of the recording."""
    shipped = recording(0, TrafficConfig(demand=demand), trackers=4)
    replay = Replay(flat_motion(shipped))
    time = np.arange(0.0, replay.duration, 1.0)
    cars = ActorState.create(len(time), replay.actors)
    replay.at(time, cars)
    size = 0.9 * np.array([shipped.vehicle_length[0], 1.8])
    corners = 0.5 * size * [[1, 1], [1, -1], [-1, -1], [-1, 1]]
    cosine, sine = np.cos(cars.yaw)[..., None], np.sin(cars.yaw)[..., None]
    east = cars.position[..., :1] + cosine * corners[:, 0] - sine * corners[:, 1]
    north = cars.position[..., 1:2] + sine * corners[:, 0] + cosine * corners[:, 1]
    network = CITYSTREET.shipped_network()
    assert network is not None
    asphalt = road_area(network)
    shapely.prepare(asphalt)
    on_it = shapely.contains_xy(asphalt, east.ravel(), north.ravel()).reshape(east.shape)
    assert on_it[cars.present].all()


@pytest.mark.parametrize("recipe", [CITYSTREET, DOWNTOWN], ids=lambda recipe: recipe.name)
def test_a_mixed_fleet_is_shipped_and_found_in_any_unit(recipe):
    percent = Mix(passenger=70, bus=10, truck=10, trailer=5, motorcycle=5)
    config = TrafficConfig(vehicle_type=percent)
    found = find_recording(recipe.roads(0), config, shipped=recipe.shipped_traffic())
    numbers = Counter(found.vehicle_types)
    assert [numbers[name] for name in VehicleType] == [28, 4, 4, 2, 2]
    assert found.present.all()
    assert (smooth(found).travelled[-1] > 7.0 * STANDARD_DURATION).all()


def test_it_needs_no_sumo():
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_SUMO], capture_output=True, text=True, check=False
    )
    assert (" ".join(done.stdout.split()), done.stderr) == ("40 40 40 40 40", "")


WITHOUT_SUMO_OF_ANY_NUMBER = """
import logging, sys
sys.modules.update(dict.fromkeys(["libsumo", "sumo", "sumolib", "traci"]))
logging.getLogger("eyas").disabled = True
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import find_file
from eyas.engine.world.maps import MAPS
groups = TrafficConfig(demand="respawn")
recipes = {str(recipe.folder): recipe for recipe in map(MAPS.get, MAPS.built_in)}
for recipe in recipes.values():  # the simple maps share theirs
    roads, shipped = recipe.roads(0), recipe.shipped_traffic()
    found = [
        find_file(roads, groups, trackers=count, shipped=shipped).outline().provenance.config
        for count in range(1, 41)
    ]
    print(*(one.group_size if one.demand == "respawn" else "lasting" for one in found))
"""


@pytest.mark.slow
def test_one_to_forty_trackers_need_no_sumo_on_any_map():
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_SUMO_OF_ANY_NUMBER], capture_output=True, text=True
    )
    assert done.stderr == ""
    sizes = ["3", "10", "10", "12", *26 * ["40"], *10 * ["lasting"]]
    assert len(done.stdout.splitlines()) == 7
    assert {tuple(line.split()) for line in done.stdout.splitlines()} == {tuple(sizes)}


@pytest.mark.parametrize(
    "name", ["citystreet", "downtown", "lake", "village", "desert", "farmland", "simpleway-grass"]
)
def test_of_forty_cars_that_come_and_go_three_quarters_stay_for_an_episode(name):
    (file,) = (file for file in MAPS.get(name).shipped_traffic() if file.name.endswith("of-40.npz"))
    present = load(file).present
    stays = np.array([present[k : k + 32].all(axis=0).sum() for k in range(len(present) - 32)])
    assert stays.min() >= 31
    assert present.sum(axis=1).mean() > 39.8


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["citystreet", "downtown", "lake", "village", "desert", "farmland"]
)
def test_traffic_for_tests_is_shipped_and_each_is_another(name):
    recipe = MAPS.get(name)
    roads, shipped = recipe.roads(0), recipe.shipped_traffic()
    found = [
        find_recording(roads, TrafficConfig(seed=seed), shipped=shipped) for seed in TEST_TRAFFIC
    ]
    assert [each.duration for each in found] == [TEST_DURATION] * 3
    assert all(each.present.all() for each in found)
    starts = {each.position[0].tobytes() for each in found}
    assert len(starts) == 3
    # No jam: every car gets on, all the time.
    assert all((smooth(each).travelled[-1] > 7.0 * each.duration).all() for each in found)


@pytest.mark.parametrize("name", ["citystreet", "downtown", "village"])
def test_towns_for_tests_are_shipped_with_their_traffic(name):
    recipe = MAPS.get(name)
    for town in TEST_TOWNS:
        roads, shipped = recipe.roads(town), recipe.shipped_traffic()
        assert recipe.shipped_network(town).graph_hash == graph_hash(roads)
        config = TrafficConfig(seed=TEST_TRAFFIC[0])
        found = find_recording(roads, config, shipped=shipped)
        assert (found.duration, found.actors) == (300.0, 40)
        assert found.provenance.map_seed == town


def test_larger_groups_are_told_and_those_asked_for_are_not_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    caplog.set_level("INFO", "eyas")
    groups = TrafficConfig(demand=Demand.RESPAWN)
    assert recording(0, groups, trackers=2).provenance.config.group_size == 10
    assert caplog.messages == [
        "traffic: groups of 10 vehicles for 2 trackers, the next that are shipped; "
        "traffic.group_size=6 has SUMO record such groups"
    ]
    recording(0, groups, trackers=31)
    assert caplog.messages[1].startswith("traffic: of 40 vehicles that come and go, too few stay")
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(library, "sumo_version", not_installed)
    six = groups.model_copy(update={"group_size": 6})
    with pytest.raises(MissingExtraError, match="no recording fits"):
        recording(0, six, trackers=2)


def not_installed(purpose: str) -> str:
    raise MissingExtraError(purpose, "sumo")


def test_groups_drive_as_in_the_original():
    """Within 15 % of what its own network and settings give, for groups of 12 every 52 s."""
    shipped = recording(0, TrafficConfig(demand=Demand.RESPAWN), trackers=4)
    assert shipped.duration == STANDARD_DURATION
    tracks = smooth(shipped)
    present = tracks.present
    speed = np.hypot(*np.moveaxis(tracks.velocity, -1, 0))
    change = np.abs(np.diff(speed, axis=0))[present[1:] & present[:-1]] * tracks.rate
    assert present.sum(axis=1).mean() == pytest.approx(14.0, rel=0.15)
    assert speed[present].mean() == pytest.approx(12.9, rel=0.15)
    assert (speed[present] < 0.1).mean() == pytest.approx(0.004, rel=0.15)
    assert np.percentile(change, 99.5) == pytest.approx(24.9, rel=0.15)


@pytest.mark.parametrize(
    ("map_seed", "config"),
    [
        (1, TrafficConfig()),
        (0, TrafficConfig(seed=2)),
        (0, TrafficConfig(max_vehicles=39)),
        (0, TrafficConfig(vehicle_type=VehicleType.BUS)),
        (0, TrafficConfig(demand=Demand.RESPAWN, group_size=4)),
        (0, TrafficConfig(demand=Demand.RESPAWN, group_interval=20.0)),
        (0, TrafficConfig(demand=Demand.RESPAWN, route_count=10)),
        (0, TrafficConfig(demand=Demand.RESPAWN, route_length=(400.0, 7000.0))),
        (0, TrafficConfig(max_speed=10.0)),
    ],
)
def test_it_is_not_taken_for_anything_else(
    map_seed: int, config: TrafficConfig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(library, "sumo_version", not_installed)
    with pytest.raises(MissingExtraError, match="no recording fits"):
        recording(map_seed, config)
