"""The built-in rewards: how well the camera looks at the target.

The view reward is the gauge of the ground quadrilateral that the rewarded part of the picture
covers: 1 where the optical axis meets the ground, 0 on the edge and outside, linear between. The
original gets it from slopes of lines on the ground and breaks on lines along y and at the horizon.
Here each edge is the plane through the optical centre and a side of the rectangle. Height over
that plane is affine on the ground and zero on the edge, so its share of the height of the middle
is the same number, and there are no corners to lose.
"""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import kernel, step_kernel
from eyas.state.terrain import Plane, height_over
from eyas.task.rules import BuiltinReward, Rules

__all__ = [
    "axis_depth",
    "distance_continuous",
    "distance_discrete",
    "reward_value",
    "view_centre",
    "view_continuous",
    "view_discrete",
    "view_share",
]

_FARTHEST = 1e12
"""A ground point farther than this along the optical axis counts as none [m]."""

_VIEW_CONTINUOUS, _VIEW_DISCRETE = (
    int(BuiltinReward.VIEW_CONTINUOUS),
    int(BuiltinReward.VIEW_DISCRETE),
)
_DISTANCE_CONTINUOUS = int(BuiltinReward.DISTANCE_CONTINUOUS)


@step_kernel
def axis_depth(
    position: NDArray[np.float64], rotation: NDArray[np.float64], ground: Plane
) -> float:
    """Return how far along the optical axis the ground is [m]; 0 if the axis does not meet it.

    Args:
        position: Optical centre, world frame [m], shape (3,).
        rotation: Camera to world; columns forward, left, up, shape (3, 3).
        ground: The plane under the target.
    """
    height = height_over(ground, position[0], position[1], position[2])
    sinking: float = (
        ground.rise_east * rotation[0, 0] + ground.rise_north * rotation[1, 0] - rotation[2, 0]
    )
    if 0.0 < height < _FARTHEST * sinking:
        return height / sinking
    return 0.0


@step_kernel
def view_centre(
    position: NDArray[np.float64], rotation: NDArray[np.float64], depth: float
) -> tuple[float, float]:
    """Return the ground point in the middle of the picture, east and north [m].

    It is the point below the camera if `depth`, from `axis_depth`, is 0.
    """
    return position[0] + depth * rotation[0, 0], position[1] + depth * rotation[1, 0]


@step_kernel
def view_share(
    position: NDArray[np.float64],
    rotation: NDArray[np.float64],
    depth: float,
    ground: Plane,
    rules: Rules,
) -> float:
    """Return 1 for a target in the middle of the picture, 0 on the edge and outside.

    If the picture shows the horizon, the quadrilateral is open there, and the share is 1 along
    the optical axis from the middle to infinity.

    Args:
        position: Optical centre, world frame [m], shape (3,).
        rotation: Camera to world; columns forward, left, up, shape (3, 3).
        depth: From `axis_depth`.
        ground: The plane under the target, which it touches where the target is.
        rules: `half_width`, `half_height` are used.
    """
    dx, dy, dz = ground.x - position[0], ground.y - position[1], ground.z - position[2]
    forward = rotation[0, 0] * dx + rotation[1, 0] * dy + rotation[2, 0] * dz
    left = rotation[0, 1] * dx + rotation[1, 1] * dy + rotation[2, 1] * dz
    up = rotation[0, 2] * dx + rotation[1, 2] * dy + rotation[2, 2] * dz
    margin: float = forward - max(abs(left) / rules.half_width, abs(up) / rules.half_height)
    # Written so that 0 / 0 and infinity - infinity, which only absurd inputs give, are no reward.
    if depth > 0.0 and margin > 0.0:
        return min(margin / depth, 1.0)
    return 0.0


@step_kernel
def reward_value(share: float, distance: float, depth: float, rules: Rules) -> float:
    """Return the reward, 0 to 1; 0 if the optical axis does not meet the ground.

    Args:
        share: From `view_share`.
        distance: From the target to the ground point in the middle of the picture [m].
        depth: From `axis_depth`.
        rules: Which reward, and its constants.
    """
    if not depth > 0.0:
        return 0.0
    if rules.reward == _VIEW_CONTINUOUS:
        return view_continuous(share, rules)
    if rules.reward == _VIEW_DISCRETE:
        return view_discrete(share)
    if rules.reward == _DISTANCE_CONTINUOUS:
        return distance_continuous(distance, rules)
    return distance_discrete(distance, rules)


@kernel
def view_continuous(share: float, rules: Rules) -> float:
    """Return the reward for a place in the picture that falls off smoothly."""
    return math.tanh(rules.view_scale * share * share * share)


@kernel
def view_discrete(share: float) -> float:
    """Return 1 inside the rewarded part of the picture, else 0."""
    return 1.0 if share > 0.0 else 0.0


@kernel
def distance_continuous(distance: float, rules: Rules) -> float:
    """Return the reward for a distance [m] from the middle of the view that falls off smoothly."""
    if not distance < rules.distance_range:
        return 0.0
    return 1.0 - math.tanh(rules.distance_scale * distance * distance * distance)


@kernel
def distance_discrete(distance: float, rules: Rules) -> float:
    """Return 1 within the rewarded distance [m] of the middle of the view, else 0."""
    return 1.0 if distance < rules.distance_range else 0.0
