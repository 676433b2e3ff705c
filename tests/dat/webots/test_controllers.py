"""The controllers of a project of Webots, against a stand-in of Webots and real counterparts: Eyas'
own simulation, SUMO, and a client of the original's protocol.
"""

import copy
import csv
import importlib.util
import json
import os
import random
import socket
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import shapely

from eyas.dat.settings.layout import original_defaults
from eyas.dat.webots.controllers import global_receiver
from eyas.dat.webots.controllers.drone import Drone
from eyas.dat.webots.controllers.ground import ground_of, settings_of
from eyas.dat.webots.controllers.sumo_supervisor import Traffic, pose_of
from eyas.dat.webots.controllers.tracking import Camera, Target, Tracker
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.scenes import load_network
from eyas.engine.sim.worlds import together
from eyas.engine.state.terrain import Terrain, reliefs
from eyas.engine.targets.catalogue import MODELS
from eyas.engine.task.packets import BASIC_COLUMNS, REWARD_COLUMNS
from eyas.engine.traffic.sumo_install import sumo_binary

from .conftest import MAP, WORLD
from .stand_in import Supervisor, World

TESTS = Path(__file__).parents[1]
_spec = importlib.util.spec_from_file_location("webots_client", TESTS / "wire" / "client.py")
client = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(client)

CAMERA = Camera(320, 240, 0.7854)
FLOOR = -0.1


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        return taken.getsockname()[1]


def numbers(line):
    return [float(word) for word in line.split(",")[:60]]


def test_rewards_are_the_original_s():
    """Vectors that its compiled code has given, see spec/behaviour.md, 19."""
    with (TESTS.parent / "kit" / "reward_vectors.csv").open() as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        value = {key: float(text) for key, text in row.items()}
        settings = dict(original_defaults(), Tracking_Object="Pedestrian")
        for mode, kind, column in (
            ("continuous", "view", "continuous"),
            ("discrete", "view", "discrete"),
            ("continuous", "distance", "dist_continuous"),
            ("discrete", "distance", "dist_discrete"),
        ):
            settings["Reward_Config"] = {
                "reward_mode": mode, "reward_type": kind, "view_range": value["lambda"],
                "view_scale": value["scale"], "distance_range": 7, "distance_scale": 0.01,
            }  # fmt: skip
            tracker = Tracker(settings, CAMERA, FLOOR, random.Random(1))
            tracker.yaw, tracker.pitch = value["yaw"], value["pitch"]
            eye = np.array(tracker._eye())
            tracker.position = tuple(np.array([value[f"c{axis}"] for axis in "xyz"]) - eye)
            target = Target((value["px"], value["py"], FLOOR), 0.3, FLOOR, "a")
            tracker._observe(target, target)
            assert tracker._reward == pytest.approx(value[column], abs=1e-5), (row, mode, kind)


def test_a_flight_is_that_of_eyas():
    sim = build_simulation(SimConfig(world={"map": "simpleway-grass"}), together(1))
    sim.reset()
    basic, reward = (rows[0] for rows in sim.packets())
    settings = dict(original_defaults())
    tracker = Tracker(settings, CAMERA, FLOOR, random.Random(1))
    target = target_of(sim)
    tracker.begin(target)
    tracker.position = tuple(basic[BASIC_COLUMNS["position"]])
    tracker.yaw = float(basic[BASIC_COLUMNS["euler"]][2])
    tracker.pitch = float(reward[REWARD_COLUMNS["camera_pitch"]])
    tracker._direction = float(reward[REWARD_COLUMNS["start_direction"]])
    tracker._seen = -1
    tracker._observe(target, target)
    for number in range(240):
        command = (20.0, -5.0, 0.01, 0.9) if number % 80 < 60 else (0.0, 0.0, 0.0, -2.0)
        sim.advance(np.array([command]), 1)
        before, target = target, target_of(sim)
        tracker.advance(command, before, target)
        basic, reward = (rows[0] for rows in sim.packets())
        theirs, ours = numbers(tracker.basic()), basic.tolist()
        felt, turning = BASIC_COLUMNS["felt_acceleration"], BASIC_COLUMNS["angular_velocity"]
        for column in range(22):  # what Eyas smooths is not compared
            if not (felt.start <= column < turning.stop):
                assert theirs[column] == pytest.approx(ours[column], abs=1e-6), (number, column)
        *words, kind = tracker.custom().split(",")
        assert kind == MODELS[sim.snapshot.targets.model[0]].typename
        change = REWARD_COLUMNS["relative_acceleration"]
        for column, word in enumerate(words):
            # Twice divided by 2 ms, the last digits of a place are seen.
            near = 1e-1 if change.start <= column < change.stop else 1e-5
            assert float(word) == pytest.approx(reward[column], abs=near), (number, column)


def target_of(sim):
    targets = sim.snapshot.targets
    kind = MODELS[targets.model[0]].typename
    return Target(tuple(targets.position[0].tolist()), float(targets.yaw[0]), FLOOR, kind)


def test_a_place_of_sumo_is_the_middle_of_the_vehicle():
    assert pose_of((12.0, 3.0), 90.0, 4.0, (2.0, 1.0)) == pytest.approx((8.0, 2.0, 0.0))
    assert pose_of((0.0, 0.0), 0.0, 4.0, (0.0, 0.0)) == pytest.approx((0.0, -2.0, np.pi / 2))


def test_the_ground_is_that_of_the_map(tmp_path):
    rng = np.random.default_rng(4)
    terrain = Terrain(FLOOR, np.float32(rng.uniform(0, 9, (5, 7))).round(3), -12.0, -8.0, 4.0)
    relief = terrain.relief.astype(float).tolist()
    told = {"floor": FLOOR, "west": -12.0, "south": -8.0, "spacing": 4.0, "relief": relief}
    (tmp_path / "ground.json").write_text(json.dumps(told))
    ground = ground_of(tmp_path)
    points = rng.uniform(-20, 20, (50, 2))
    theirs = [ground.above_floor(*point) for point in points]
    np.testing.assert_allclose(theirs, reliefs(terrain, points), atol=1e-5)


@pytest.fixture
def world(project, protos, told):
    nodes = copy.deepcopy([node for node in told[0] if node.name.isupper() or "_VEH" in node.name])
    return World(project / "worlds" / WORLD, protos, nodes)


@pytest.fixture
def traffic(project, world):
    """The vehicles of a world, driven by the SUMO that the controller starts."""
    import traci

    roads = project / "worlds" / f"{MAP}_net"
    command = [str(sumo_binary("sumo")), "-c", str(roads / "sumo.sumocfg")]
    traci.start([*command, "--step-length", "0.1", "--seed", "1"], stdout=subprocess.DEVNULL)
    yield Traffic(Supervisor(world, "SUMO_INTERFACE"), traci, ground_of(roads), (0.0, 0.0), 30)
    traci.close()


@pytest.mark.sumo
def test_vehicles_drive_on_the_lanes_of_the_map(world, traffic):
    for _ in range(30):
        traffic.advance(0.1)
        world.advance(100)
    before = places(world)
    traffic.advance(0.1)
    world.advance(100)
    now = places(world)
    assert 10 <= len(now) <= 30
    network = load_network(MAP, 0)
    parts = zip(network.lane_first[:-1], network.lane_first[1:], strict=True)
    lanes = shapely.MultiLineString([network.lane_points[a:b] for a, b in parts])
    away = [lanes.distance(shapely.Point(place[:2])) for place, _ in now.values()]
    assert np.mean(np.array(away) < 0.5) > 0.7
    assert max(away) < 20.0  # on a crossing
    for name, (place, yaw) in now.items():
        assert 0.2 < place[2] < 0.6
        way = np.array(place[:2]) - before.get(name, (place, 0))[0][:2]
        if np.hypot(*way) > 0.3:
            assert np.cos(np.arctan2(way[1], way[0]) - yaw) > 0.95
    moved = [np.hypot(*(np.array(now[k][0]) - before[k][0])[:2]) for k in now if k in before]
    assert 0.3 < np.median(moved) < 3.0


def places(world):
    found = {}
    for node in world.nodes:
        if node.name.startswith("SUMO_VEHICLE") and node["translation"][0] < 5000:
            *axis, angle = node["rotation"]
            found[node["name"]] = node["translation"], angle * axis[2]
    return found


@pytest.mark.sumo
def test_clients_of_the_original_are_served(project, world, traffic, monkeypatch):
    """Two agents announce themselves, reset, fly, and follow different vehicles."""
    port = free_port()
    files = project / "Files2Alg"
    (files / "DRONE0_AlgAction.txt").write_text("left over")
    settings = settings_of(project)
    monkeypatch.setattr(
        global_receiver, "settings_of", lambda _: {**settings, "Config_Agen_Num_Port": port}
    )
    world.each_step.append(lambda time: traffic.advance(0.1) if time % 100 == 0 else None)
    receiver = Supervisor(world, "GLOBAL_RECEIVER", steps=400)
    serving = threading.Thread(target=global_receiver.serve, args=(receiver, project))
    serving.start()
    while not (files / "start.txt").exists():
        pass
    client.Client.announce(port, 2, b"two\n")  # passed over
    client.Client.announce(port, 2)
    serving.join(60.0)
    assert [node.name for node in world.nodes[-2:]] == ["DRONE0", "DRONE1"]
    assert not (files / "DRONE0_AlgAction.txt").exists()
    drones = []
    for number in range(2):
        # 16 steps for each: a reset and three actions.
        robot = Supervisor(world, f"DRONE{number}", steps=16)
        drones.append(Drone(robot, number, project))
        flight = threading.Thread(target=drones[-1].run)
        flight.start()
        agent = client.Client(project.parents[1], number, patience=60.0)
        state, rewards, _ = agent.reset()
        assert state[0] == 0.0
        assert state[20] > 0.5
        assert rewards[60].endswith("Simple")
        for round_ in range(3):
            state, rewards, jpeg = agent.step((5.0, 0.0, 0.0, 0.1))
            assert state[0] == 4.0 * (round_ + 1)
            assert jpeg[:2] == b"\xff\xd8"
        assert robot.devices["camera pitch"].position == pytest.approx(rewards[4])
        assert robot.devices["camera"].period == 8
        assert world.find(f"DRONE{number}")["translation"] == tuple(state[1:4])
        agent.send("0,0,0,0,1\n")  # Webots ends during this reset
        flight.join(60.0)
        assert not flight.is_alive()
    followed = [world.find(f"DRONE{number}")["customData"] for number in range(2)]
    assert len(set(followed)) == 2
    assert all(name.startswith("SUMO_VEHICLE") for name in followed)


@pytest.mark.sumo
def test_controllers_run_where_there_is_no_eyas(project, tmp_path):
    """Each imports but what lies beside it; the module `controller` is Webots'."""
    (tmp_path / "controller.py").write_text("def Supervisor():\n    raise SystemExit(77)\n")
    (tmp_path / "traci.py").write_text("")
    for name in ("global_receiver", "drone", "sumo_supervisor"):
        script = project / "controllers" / name / f"{name}.py"
        environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
        done = subprocess.run(
            [sys.executable, "-S", str(script), "0"],
            env=environment,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 77, done.stderr
