"""Every number of the packets of a flight, computed anew from poses alone, with numpy."""

import math

import numpy as np
import pytest

from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.targets.catalogue import MODELS, kind_of
from eyas.engine.task.packets import BASIC_FIELDS, REWARD_FIELDS

STEP = 0.002
LIFT = np.array([0, 0, 0.1])
"""The floor is z = 0 in the land frame."""


def spin(yaw, pitch=0.0):
    """Rotation by yaw, then by pitch, positive down."""
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array(
        [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]
    )


class State:
    """What a packet must say, from the poses of drone, gimbal and target in one step."""

    def __init__(self, snapshot):
        trackers, cameras, targets, episodes, _ = snapshot.copy()
        self.step, self.yaw = int(episodes.step_count[0]), float(trackers.euler[0, 2])
        self.place, self.target_yaw = trackers.position[0], float(targets.yaw[0])
        self.field, self.start = cameras.field_of_view[0], episodes.start_offset[0, 3]
        self.commanded, self.pitch = trackers.commanded_position[0], trackers.gimbal[0, 1]
        self.aimed = trackers.commanded_gimbal[0, 0]
        self.target = targets.position[0]
        ahead = kind_of(int(targets.model[0])).ahead
        self.centre = self.target + spin(self.target_yaw) @ [ahead, 0, 0]
        arm = np.array([0.130625212, -0.01, -0.0337448])
        link = spin(0.0, self.pitch) @ [0.00754686, 0.0160388, -0.00586401]
        self.eye = self.place + spin(self.yaw) @ (arm + link)
        self.look = spin(self.yaw, self.pitch)
        self.seen = spin(self.yaw).T @ (self.centre - self.place)


def matrix(rotation, place):
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = rotation, place + LIFT
    return whole.ravel()


def turn(angle):
    return (angle + math.pi) % (2 * math.pi) - math.pi


def test_every_number_is_what_the_poses_say(config, assets):
    simulation = build_simulation(config, each_alone(1))
    simulation.reset()
    rng = np.random.default_rng(4)
    states = [State(simulation.snapshot)]
    for _ in range(60):
        command = rng.uniform(-1, 1, (1, 4)) * [20.0, 20.0, 0.01, 2.0]
        for _ in range(5):
            simulation.advance(command)
            states.append(State(simulation.snapshot))
            basic, reward = (rows[0] for rows in simulation.packets())
            check_basic(dict(zip(BASIC_FIELDS, basic, strict=True)), states)
            if len(states) > 3:
                check_reward(reward, states)
    typename = MODELS[simulation.snapshot.targets.model[0]].typename
    assert typename.isidentifier()


def check_basic(row, states):
    before, now = states[-2:]
    velocity = (now.place - before.place) / STEP
    assert row["step_count"] == now.step == len(states) - 1
    for axis, name in enumerate("xyz"):
        assert row[f"position_{name}"] == now.place[axis]
        assert row[f"velocity_{name}"] == pytest.approx(velocity[axis], abs=1e-9)
    quaternion = [math.cos(now.yaw / 2), 0, 0, math.sin(now.yaw / 2)]
    assert [row[f"orientation_{n}"] for n in "wxyz"] == pytest.approx(quaternion)
    assert [row["roll"], row["pitch"], row["yaw"]] == [0, 0, now.yaw]


def check_reward(row, states):
    then, before, now = states[-3:]
    at = {name: REWARD_FIELDS.index(name) for name in REWARD_FIELDS}
    focal = 160 / math.tan(now.field / 2)
    assert row[:7] == pytest.approx(
        [320, 240, now.field, focal, now.aimed, now.commanded[2], now.start]
    )
    assert row[7:23] == pytest.approx(matrix(now.look, now.eye), abs=1e-9)
    target = matrix(spin(now.target_yaw), now.centre)
    assert row[23:39] == pytest.approx(target, abs=1e-9)
    ahead = now.look[:, 0]
    ground = now.eye + ahead * (now.eye[2] + 0.1) / -ahead[2]
    assert row[39:42] == pytest.approx(ground, abs=1e-6)
    assert row[42:45] == pytest.approx(now.centre + LIFT)
    assert row[45:48] == pytest.approx(now.eye + LIFT)
    assert row[48] == pytest.approx(turn(now.target_yaw - now.yaw))
    assert row[49:52] == pytest.approx(now.seen, abs=1e-9)
    speed, last = (now.seen - before.seen) / STEP, (before.seen - then.seen) / STEP
    assert row[52:55] == pytest.approx(speed, abs=1e-6)
    assert row[55:58] == pytest.approx((speed - last) / STEP, abs=1e-2)
    assert row[at["crash"]] == 0.0
    turned = turn(now.target_yaw - before.target_yaw)
    moved = math.dist(now.target[:2], before.target[:2])
    direction = 2 if turned > 1e-4 else 3 if turned < -1e-4 else 0 if moved < 1e-3 else 1
    assert row[at["target_direction"]] == direction
