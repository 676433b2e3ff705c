from contextlib import closing
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray

from eyas.dat.settings.adapter import from_original
from eyas.engine.core.errors import ConfigError
from eyas.engine.state.motion import ActorState
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode
from eyas.engine.traffic import sumo as sumo_room
from eyas.engine.traffic.config import Demand, Mix, TrafficConfig, VehicleType
from eyas.engine.traffic.fleet import fleet_of
from eyas.engine.traffic.network import network_xml
from eyas.engine.traffic.record import WARM_UP, record, resolved
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.recording_file import from_bytes, to_bytes
from eyas.engine.traffic.replay import Replay
from eyas.engine.traffic.smoothing import runs, smooth
from eyas.engine.traffic.sumo_install import import_libsumo

pytestmark = [pytest.mark.sumo, pytest.mark.usefixtures("sumo")]

CARS = TrafficConfig(max_vehicles=24)
GROUPS = TrafficConfig(
    demand=Demand.RESPAWN,
    max_vehicles=10,
    group_size=3,
    group_interval=20.0,
    route_length=(200.0, 900.0),
)


@pytest.fixture(scope="module")
def cars(grid: RoadGraph) -> TrafficRecording:
    return record("grid", 0, grid, CARS, 120.0, 1)


@pytest.fixture(scope="module")
def groups(grid: RoadGraph) -> TrafficRecording:
    return record("grid", 0, grid, GROUPS, 120.0, 1)


def _speed(recording: TrafficRecording) -> NDArray[np.float64]:
    """As SUMO drove, not smoothed; 0 where a vehicle comes or goes."""
    step = np.hypot(*np.moveaxis(np.diff(recording.position, axis=0), -1, 0)) * recording.rate
    step[~(recording.present[1:] & recording.present[:-1])] = 0.0
    return step


def test_the_same_seed_gives_the_same_bytes_twice_in_a_process(
    cars: TrafficRecording, grid: RoadGraph
):
    assert to_bytes(record("grid", 0, grid, CARS, 120.0, 1)) == to_bytes(cars)


def test_another_seed_gives_other_traffic(cars: TrafficRecording, grid: RoadGraph):
    other = record("grid", 0, grid, CARS, 10.0, 2)
    assert np.abs(other.position - cars.position[:101]).max() > 50.0


def test_kept_alive_cars_drive_from_start_to_end(cars: TrafficRecording):
    assert cars.present.all()
    assert cars.present.shape == (1201, 24)
    assert (smooth(cars).travelled[-1] > 500.0).all()


def test_no_car_jumps_or_drives_through_another(cars: TrafficRecording):
    assert _speed(cars).max() < 20.0
    tracks = smooth(cars)
    apart = tracks.position[:, :, None] - tracks.position[:, None]
    gap = np.hypot(apart[..., 0], apart[..., 1]) + 100.0 * np.eye(24)
    # Centres of cars 1.8 m wide: side by side in two lanes is nearest.
    assert gap.min() > 1.8


def test_a_recording_is_what_sumo_itself_writes_down(
    grid: RoadGraph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    log = tmp_path / "fcd.xml"
    told = sumo_room.options(TrafficConfig())
    monkeypatch.setattr(sumo_room, "options", lambda _, **how: (*told, "--fcd-output", str(log)))
    recording = record("grid", 0, grid, CARS, 20.0, 1)
    compared = 0
    for step in ElementTree.parse(log).iter("timestep"):
        # SUMO's log says the state at the end of a step with the time at its beginning.
        sample = round((float(step.get("time", "")) + 0.1 - WARM_UP) * 10)
        for vehicle in step if sample >= 0 else ():
            angle = np.radians(90.0 - float(vehicle.get("angle", "")))
            bumper = [float(vehicle.get("x", "")), float(vehicle.get("y", ""))]
            middle = bumper - 2.5 * np.array([np.cos(angle), np.sin(angle)])
            actor = int(vehicle.get("id", ""))
            np.testing.assert_allclose(recording.position[sample, actor], middle, atol=0.02)
            assert abs(np.sin(recording.yaw[sample, actor] - angle)) < 0.002
            compared += 1
    assert compared == 24 * 201


def test_replay_stays_near_sumo(cars: TrafficRecording, flat_motion):
    replay = Replay(flat_motion(cars))
    time = np.arange(0, 1201, 7) / 10.0
    out = ActorState.create(len(time), replay.actors)
    replay.at(time, out)
    error = out.position[..., :2] - cars.position[::7]
    sideways = np.abs(-np.sin(out.yaw) * error[..., 0] + np.cos(out.yaw) * error[..., 1])
    ahead = np.abs(np.cos(out.yaw) * error[..., 0] + np.sin(out.yaw) * error[..., 1])
    # Turns are cut as real cars cut them; braking at 25 m/s^2 is spread over half a second.
    assert np.percentile(sideways, 50) < 0.05
    assert sideways.max() < 1.25
    assert ahead.max() < 1.5
    assert np.abs(out.yaw - cars.yaw[::7]).max() < np.radians(35.0)


def test_smoothed_cars_turn_and_brake_like_cars(cars: TrafficRecording):
    tracks = smooth(cars)
    assert np.degrees(np.abs(tracks.yaw_rate).max()) < 120.0
    slip = (
        np.cos(tracks.yaw) * tracks.velocity[..., 1] - np.sin(tracks.yaw) * tracks.velocity[..., 0]
    )
    assert np.abs(slip).max() < 3.0
    bend = np.diff(tracks.velocity, axis=0) * tracks.rate
    assert np.hypot(bend[..., 0], bend[..., 1]).max() < 25.0


def test_groups_enter_drive_and_leave(groups: TrafficRecording):
    stays = [runs(groups.present[:, actor]) for actor in range(10)]
    entered = sorted(first for spans in stays for first, _ in spans if first > 0)
    assert len(entered) > 10
    left = [last for spans in stays for _, last in spans if last < len(groups.present)]
    assert len(left) > 10
    # A group comes every 20 s, and the 60 s of warm-up are three intervals. A few have to wait.
    prompt = [first for first in entered if first % 200 < 10]
    assert len(prompt) > len(entered) / 2
    assert groups.present.sum(axis=1).max() <= 10


def test_actors_are_used_again_after_a_break(groups: TrafficRecording):
    spans = [runs(groups.present[:, actor]) for actor in range(10)]
    assert max(len(stays) for stays in spans) >= 2
    assert _speed(groups).max() < 20.0


def test_routes_are_used_up(grid: RoadGraph):
    few = GROUPS.model_copy(update={"route_count": 6, "group_interval": 5.0})
    recording = record("grid", 0, grid, few, 240.0, 1)
    assert not recording.present[-1].any()
    assert sum(len(runs(recording.present[:, actor])) for actor in range(10)) <= 6


@pytest.mark.parametrize(
    ("vehicle_type", "length"),
    [
        (VehicleType.BUS, 12.0),
        (VehicleType.TRUCK, 7.1),
        (VehicleType.TRAILER, 16.5),
        (VehicleType.MOTORCYCLE, 2.2),
    ],
)
def test_the_vehicle_type_reaches_sumo(grid: RoadGraph, vehicle_type: VehicleType, length: float):
    config = TrafficConfig(vehicle_type=vehicle_type, max_vehicles=3)
    recording = record("grid", 0, grid, config, 5.0, 1)
    assert (recording.vehicle_length == length).all()
    assert recording.provenance.config.vehicle_type is vehicle_type


MIX = Mix(passenger=5, bus=2, motorcycle=1)


@pytest.mark.parametrize("demand", Demand)
def test_a_mix_gives_each_class_its_share(grid: RoadGraph, demand: Demand):
    base = GROUPS if demand is Demand.RESPAWN else CARS
    config = base.model_copy(update={"vehicle_type": MIX, "max_vehicles": 10})
    made = record("grid", 0, grid, config, 90.0, 1)
    classes = np.array(made.vehicle_types)
    # 6.25, 2.5 and 1.25 of ten: the one that is left goes to the largest remainder.
    assert [int((classes == name).sum()) for name in VehicleType] == [6, 3, 0, 0, 1]
    for name, length in ((VehicleType.PASSENGER, 5.0), (VehicleType.BUS, 12.0)):
        assert (made.vehicle_length[classes == name] == length).all()
        assert made.present[:, classes == name].any()
    assert from_bytes(to_bytes(made), "").vehicle_types == made.vehicle_types
    again = record("grid", 0, grid, config, 90.0, 1)
    assert to_bytes(again) == to_bytes(made)


def test_a_mix_of_one_class_is_that_class(cars: TrafficRecording, grid: RoadGraph):
    alone = CARS.model_copy(update={"vehicle_type": Mix(passenger=0.3)})
    assert to_bytes(record("grid", 0, grid, alone, 120.0, 1)) == to_bytes(cars)


def test_top_speed_and_acceleration_reach_sumo(grid: RoadGraph):
    slow = TrafficConfig(max_vehicles=6, max_speed=6.0, max_acceleration=1.0, max_deceleration=3.0)
    speed = _speed(record("grid", 0, grid, slow, 60.0, 1))
    assert 5.8 < speed.max() < 6.2
    change = np.diff(speed, axis=0) * 10.0
    # Whole centimetres at 10 Hz are off by up to 2 m/s^2; a half-second mean is fine. At the mouths
    # of crossings the middle of a vehicle is now and then moved by its turning.
    mean = np.mean([change[k : len(change) - 5 + k] for k in range(5)], axis=0)
    assert 0.9 < np.percentile(mean, 99) < 1.4


@pytest.mark.parametrize("demand", Demand)
def test_no_driver_exceeds_the_maximum(grid: RoadGraph, demand: Demand):
    """By SUMO's own figures."""
    slow = TrafficConfig(demand=demand, max_vehicles=20, max_speed=3.0, group_interval=5.0)
    config = resolved(slow.model_copy(update={"route_length": (100.0, 2000.0)}), 1)
    speed = []
    with closing(sumo_room.SumoRun(network_xml(grid), config, fleet_of(config, 60.0))) as run:
        for _ in range(600):
            run.advance()
            speed += map(run.sumo.vehicle.getSpeed, run.sumo.vehicle.getIDList())
    assert 2.9 < max(speed) < 3.01


@pytest.mark.slow
def test_more_cars_than_fit_are_an_error_before_all_is_driven(grid: RoadGraph):
    shares: list[float] = []
    config = TrafficConfig(max_vehicles=1000)
    with pytest.raises(
        ConfigError, match=r"^traffic\.max_vehicles: 1000 is too many .* about \d+$"
    ):
        record("grid", 0, grid, config, 600.0, 1, shares.append)
    assert max(shares) < 0.1


def test_keeping_alive_needs_a_way_round():
    nodes = (RoadNode("a", 0.0, 0.0), RoadNode("b", 200.0, 0.0), RoadNode("c", 400.0, 0.0))
    line = RoadGraph("line", 0, nodes, (RoadEdge("ab", "a", "b"), RoadEdge("bc", "b", "c")))
    with pytest.raises(ConfigError, match="'keep_alive' needs roads that form a loop"):
        record("line", 0, line, CARS, 1.0, 1)
    assert not import_libsumo().simulation.isLoaded()


def test_a_simulation_of_someone_else_is_left_alone(grid: RoadGraph, tmp_path):
    (tmp_path / "net.xml").write_bytes(network_xml(grid))
    libsumo = import_libsumo()
    libsumo.start(["sumo", "-n", str(tmp_path / "net.xml")])
    try:
        with pytest.raises(ConfigError, match="SUMO already runs in this process"):
            record("grid", 0, grid, CARS, 1.0, 1)
        assert libsumo.simulation.isLoaded()
    finally:
        libsumo.close()


def test_provenance_says_what_was_driven(groups: TrafficRecording):
    origin = groups.provenance
    assert (origin.map_name, origin.map_seed, origin.warm_up) == ("grid", 0, WARM_UP)
    assert origin.config == resolved(GROUPS, 1)
    assert origin.sumo_version


def test_settings_that_sumo_does_not_see_make_no_difference():
    painted = TrafficConfig(colour=(1.0, 0.0, 0.0), update_routes=False, group_interval=3.0)
    assert resolved(painted, 1) == resolved(TrafficConfig(), 1)
    assert resolved(TrafficConfig(demand=Demand.RESPAWN), 1, trackers=4).group_size == 12


@pytest.mark.parametrize(
    ("said", "trackers", "used"), [(None, 0, 3), (2, 0, 2), (2, 1, 3), (5, 1, 5), (5, 2, 6)]
)
def test_a_group_has_at_least_three_for_each_tracker(said: int | None, trackers: int, used: int):
    config = TrafficConfig(demand=Demand.RESPAWN, group_size=said)
    assert resolved(config, 1, trackers).group_size == used


def test_groups_start_and_brake_in_an_instant(groups: TrafficRecording, cars: TrafficRecording):
    """As in the original; the others decide twice a second and are smoothed."""
    for recording, least, most in ((groups, 20.0, 30.0), (cars, 5.0, 15.0)):
        tracks = smooth(recording)
        speed = np.hypot(*np.moveaxis(tracks.velocity, -1, 0))
        change = np.abs(np.diff(speed, axis=0)) * tracks.rate
        both = tracks.present[1:] & tracks.present[:-1]
        assert least < np.percentile(change[both], 99.5) < most


@pytest.mark.slow
def test_what_the_original_says_of_groups_and_routes_is_driven(grid: RoadGraph):
    """Each of its keys reaches SUMO: sizes, times, lengths and number of the routes, the seed."""
    keys = {
        "fixed_car_group_num": True,
        "car_group_num": 4,
        "car_import_interval": 17.0,
        "min_rou_distance": 300,
        "max_rou_distance": 500,
        "route_num": 22,
        "fixed_seed": True,
        "random_seed": 7,
    }

    def driven(**changes: object) -> TrafficRecording:
        config = from_original({"Sumo_Params": keys | changes}).traffic
        assert config.seed is not None
        return record("grid", 0, grid, config, 60.0, config.seed)

    def entries(**changes: object) -> list[float]:
        present = driven(**changes).present.T
        firsts = [first for stays in map(runs, present) for first, _ in stays if first]
        return sorted(first / 10.0 + WARM_UP for first in firsts)

    def longest(**changes: object) -> float:
        """Longest way of those that entered and left [m]."""
        made = driven(route_num=100, **changes)
        ways = [
            _speed(made)[first:last, actor].sum() / made.rate
            for actor, present in enumerate(made.present.T)
            for first, last in runs(present)
            if first and last < len(present)
        ]
        return max(ways)

    # Groups of 4 at 68 and 85 s have entered; no other comes after the 22nd vehicle.
    usual = entries()
    assert np.floor(usual[-6:]).tolist() == [68.0] * 4 + [85.0] * 2
    assert len(entries(car_group_num=5)) < len(usual)  # 20 of the 22 are there before
    assert len(entries(route_num=100)) > len(usual)
    assert entries(route_num=100, car_import_interval=40.0)[0] >= 80.0
    # Lengths are those of the roads, without the crossings between them.
    assert longest() < 600.0 < longest(min_rou_distance=500, max_rou_distance=900)
    assert longest(min_rou_distance=100, max_rou_distance=300) < 360.0
    assert not np.array_equal(driven(random_seed=8).position, driven().position)
