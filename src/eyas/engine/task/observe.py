"""Observation of one target in one physics step: reward, direction, relative motion."""

import math

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.frames import rotate_back
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.snapshot import CameraState, TargetState, TrackerState
from eyas.engine.state.terrain import Plane, Terrain, height_over, plane_at
from eyas.engine.task.direction import target_direction
from eyas.engine.task.reward import axis_depth, reward_value, view_centre, view_share
from eyas.engine.task.rules import Rules
from eyas.lanes import kernel


@kernel(inline=True)
def clear_episode(episodes: EpisodeState, n: int) -> None:
    """Clear the previous episode, so that the next `observe` is the first of a new one."""
    episodes.step_count[n] = 0
    episodes.no_reward_count[n] = 0
    episodes.reward[n] = 0.0
    episodes.reason[n] = 0
    episodes.breach[n] = 0
    episodes.not_a_number[n] = False
    episodes.crash[n] = False
    episodes.contact_object[n] = -1
    episodes.direction[n] = 0
    episodes.observations[n] = 0
    for axis in range(3):
        episodes.contact[n, axis] = 0.0
        episodes.relative_velocity[n, axis] = 0.0
        episodes.relative_acceleration[n, axis] = 0.0


@kernel(inline=True)
def target_plane(targets: TargetState, n: int, terrain: Terrain) -> Plane:
    """Return the plane on which tracker `n` is to have its target in the middle of the picture: the
    one that touches the ground under it, or the level one through a target that flies.
    """
    x, y = targets.centre[n, 0], targets.centre[n, 1]
    if targets.flies[n]:
        return Plane(x, y, targets.centre[n, 2], 0.0, 0.0)
    return plane_at(terrain, x, y)


@kernel(inline=True)
def observe(
    trackers: TrackerState,
    cameras: CameraState,
    targets: TargetState,
    episodes: EpisodeState,
    n: int,
    terrain: Terrain,
    rules: Rules,
    half_size: tuple[float, float],
) -> None:
    """Compute tracker `n`'s observation of its target, at a reset and in each physics step.

    The reward uses the plane of the target, and the part of the picture of a size from
    `rewarded_size`.
    """
    position, rotation = cameras.position[n], cameras.rotation[n]
    x, y = targets.centre[n, 0], targets.centre[n, 1]
    ground = target_plane(targets, n, terrain)
    depth = axis_depth(position, rotation, ground)
    middle_x, middle_y = view_centre(position, rotation, depth)
    share = view_share(position, rotation, depth, ground, half_size)
    distance = math.sqrt((x - middle_x) ** 2 + (y - middle_y) ** 2)
    episodes.reward[n] = reward_value(share, distance, depth, rules)
    episodes.offset[n], episodes.proportion[n] = distance, share
    centre = episodes.view_centre[n]
    centre[0], centre[1] = middle_x, middle_y
    centre[2] = -height_over(ground, middle_x, middle_y, 0.0)
    _follow_target(targets, episodes, n)
    _follow_relative(trackers, targets, episodes, n)
    episodes.observations[n] = min(episodes.observations[n] + 1, 3)


@kernel(inline=True)
def _follow_target(targets: TargetState, episodes: EpisodeState, n: int) -> None:
    x, y, yaw = targets.position[n, 0], targets.position[n, 1], targets.yaw[n]
    last = episodes.last_target[n]
    if episodes.observations[n] > 0:
        slowest = targets.slowest[n]
        episodes.direction[n] = target_direction(x - last[0], y - last[1], yaw, last[2], slowest)
    last[0], last[1], last[2] = x, y, yaw


@kernel(inline=True)
def _follow_relative(
    trackers: TrackerState, targets: TargetState, episodes: EpisodeState, n: int
) -> None:
    """Differentiate the target's position in the rotating body frame.

    The velocity is 0 until there are two positions, the acceleration until there are two
    velocities. (The original divides its first sample by the absolute time.)
    """
    position, centre = trackers.position[n], targets.centre[n]
    relative = rotate_back(
        trackers.orientation[n],
        centre[0] - position[0],
        centre[1] - position[1],
        centre[2] - position[2],
    )
    for axis in range(3):
        if episodes.observations[n] > 0:
            speed = (relative[axis] - episodes.relative_position[n, axis]) / PHYSICS_STEP
            if episodes.observations[n] > 1:
                change = speed - episodes.relative_velocity[n, axis]
                episodes.relative_acceleration[n, axis] = change / PHYSICS_STEP
            episodes.relative_velocity[n, axis] = speed
        else:
            episodes.first_position[n, axis] = relative[axis]
        episodes.relative_position[n, axis] = relative[axis]
