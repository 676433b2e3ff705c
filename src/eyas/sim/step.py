"""The step: one kernel call moves and judges all trackers for all physics steps of an action."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.jit import kernel
from eyas.sim.fleet import Fleet, Traffic
from eyas.task.direction import TARGET_COMPENSATION, target_centre
from eyas.task.done import judge
from eyas.task.observe import observe, start_episode
from eyas.task.packet_rows import fill_basic, fill_reward
from eyas.task.rules import Rules
from eyas.trackers.carry import carry_drone, offset_pose
from eyas.trackers.drone import advance_drone, reset_drone
from eyas.trackers.gimbal import advance_gimbal, camera_pose, reset_gimbal
from eyas.traffic.replay import interpolate_actor

__all__ = ["begin_episodes", "fill_packets", "fly", "follow"]


@kernel
def fly(
    steps: int, actions: NDArray[np.float64], fleet: Fleet, traffic: Traffic, rules: Rules
) -> None:
    """Fly all trackers by their actions, shape (N, 4), for a number of physics steps."""
    for n in range(fleet.tick.shape[0]):
        for _ in range(steps):
            advance_drone(
                actions[n],
                fleet.tracker_memory[n],
                fleet.position[n],
                fleet.velocity[n],
                fleet.acceleration[n],
                fleet.orientation[n],
                fleet.euler[n],
                fleet.angular_velocity[n],
                fleet.commanded_position[n],
            )
            fleet.tick[n] += 1
            _move_target(n, fleet, traffic)
            _look_and_judge(n, fleet, rules)


@kernel
def follow(steps: int, fleet: Fleet, traffic: Traffic, rules: Rules) -> None:
    """Carry all trackers along with their targets for a number of physics steps."""
    for n in range(fleet.tick.shape[0]):
        for _ in range(steps):
            fleet.tick[n] += 1
            _move_target(n, fleet, traffic)
            carry_drone(
                offset_pose(fleet.target_position[n], fleet.target_yaw[n], fleet.offset[n]),
                fleet.tracker_memory[n],
                fleet.position[n],
                fleet.velocity[n],
                fleet.acceleration[n],
                fleet.orientation[n],
                fleet.euler[n],
                fleet.angular_velocity[n],
                fleet.commanded_position[n],
            )
            _look_and_judge(n, fleet, rules)


@kernel
def begin_episodes(
    trackers: NDArray[np.int64],
    pitch: NDArray[np.float64],
    fleet: Fleet,
    traffic: Traffic,
    rules: Rules,
) -> None:
    """Put trackers at their starts, gimbals in place, and take the first look.

    Args:
        trackers: Which, shape (K,); their target, tick and offset are set.
        pitch: Commanded camera pitch of each, positive down [rad], shape (K,).
        fleet: Changes.
        traffic: Where the targets are.
        rules: Of the task.
    """
    for k in range(trackers.shape[0]):
        n = trackers[k]
        fleet.target_lost[n] = False
        _move_target(n, fleet, traffic)
        x, y, z, yaw = offset_pose(fleet.target_position[n], fleet.target_yaw[n], fleet.offset[n])
        reset_drone(
            x,
            y,
            z,
            yaw,
            fleet.tracker_memory[n],
            fleet.position[n],
            fleet.velocity[n],
            fleet.acceleration[n],
            fleet.orientation[n],
            fleet.euler[n],
            fleet.angular_velocity[n],
            fleet.commanded_position[n],
        )
        reset_gimbal(pitch[k], 0.0, fleet.tracker_memory[n], fleet.euler[n], fleet.gimbal[n])
        start_episode(fleet.offset[n, 3], fleet.task_memory[n])
        _look(n, fleet, rules)


@kernel
def fill_packets(fleet: Fleet, rules: Rules) -> None:
    """Fill the basic and the reward packets of all trackers."""
    for n in range(fleet.tick.shape[0]):
        fill_basic(
            fleet.position[n],
            fleet.velocity[n],
            fleet.acceleration[n],
            fleet.orientation[n],
            fleet.euler[n],
            fleet.angular_velocity[n],
            fleet.task_memory[n],
            fleet.basic[n],
        )
        fill_reward(
            rules.ground,
            fleet.tracker_memory[n],
            fleet.commanded_position[n],
            fleet.euler[n],
            fleet.camera_position[n],
            fleet.camera_rotation[n],
            fleet.target_yaw[n],
            fleet.target_centre[n],
            fleet.task_memory[n],
            fleet.reward[n],
        )


@kernel
def _move_target(n: int, fleet: Fleet, traffic: Traffic) -> None:
    """Read where the target of tracker n is; a target that has left stays where it was."""
    time = fleet.tick[n] * PHYSICS_STEP
    x, y, yaw, speed, _, _, present = interpolate_actor(
        traffic.table, traffic.rate, fleet.target_actor[n], time
    )
    if not present:
        fleet.target_lost[n] = True
        fleet.target_speed[n] = 0.0
        return
    fleet.target_position[n, 0], fleet.target_position[n, 1] = x, y
    fleet.target_yaw[n] = yaw
    fleet.target_speed[n] = speed
    fleet.target_centre[n, 0], fleet.target_centre[n, 1] = target_centre(
        x, y, yaw, TARGET_COMPENSATION
    )
    fleet.target_centre[n, 2] = fleet.target_position[n, 2]


@kernel
def _look(n: int, fleet: Fleet, rules: Rules) -> None:
    camera_pose(
        fleet.position[n],
        fleet.orientation[n],
        fleet.gimbal[n],
        fleet.camera_position[n],
        fleet.camera_rotation[n],
    )
    observe(
        rules,
        fleet.camera_position[n],
        fleet.camera_rotation[n],
        fleet.position[n],
        fleet.orientation[n],
        fleet.target_position[n],
        fleet.target_yaw[n],
        fleet.target_centre[n],
        fleet.task_memory[n],
    )


@kernel
def _look_and_judge(n: int, fleet: Fleet, rules: Rules) -> None:
    advance_gimbal(fleet.tracker_memory[n], fleet.euler[n], fleet.gimbal[n])
    _look(n, fleet, rules)
    judge(
        rules,
        fleet.target_lost[n],
        fleet.position[n],
        fleet.velocity[n],
        fleet.angular_velocity[n],
        fleet.euler[n],
        fleet.commanded_position[n],
        fleet.target_centre[n],
        fleet.task_memory[n],
    )
