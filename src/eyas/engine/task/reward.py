"""The built-in rewards: how well the camera looks at the target.

The view reward depends on the target's place in the ground quadrilateral that the rewarded part of
the picture covers: a share of 1 where the optical axis meets the ground, 0 on the edges and
outside, linear between. The original computes it from slopes of lines on the ground, which fails
for lines along y and at the horizon. Here each edge is represented by the plane through the optical
centre and a side of the rewarded rectangle. The distance from that plane is an affine function on
the ground and 0 on the edge, so divided by its value in the middle it gives the same share, without
computing the corners.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.terrain import Plane, height_over
from eyas.engine.task.rules import BuiltinReward, Rules
from eyas.lanes import kernel
from eyas.lanes.elementary import tan, tanh

_FARTHEST = 1e12  # Largest depth of a ground point along the optical axis [m]

_VIEW_CONTINUOUS, _VIEW_DISCRETE = (
    int(BuiltinReward.VIEW_CONTINUOUS),
    int(BuiltinReward.VIEW_DISCRETE),
)
_DISTANCE_CONTINUOUS = int(BuiltinReward.DISTANCE_CONTINUOUS)
_CONSTANT = int(BuiltinReward.CONSTANT)


@kernel(inline=True)
def axis_depth(
    position: NDArray[np.float64],  # Optical centre, world frame [m], shape (3,)
    rotation: NDArray[np.float64],  # Camera to world; columns forward, left, up, shape (3, 3)
    ground: Plane,  # The plane under the target
) -> float:
    """Return the depth of the ground along the optical axis [m]; 0 if they do not meet."""
    height = height_over(ground, position[0], position[1], position[2])
    sinking: float = (
        ground.rise_east * rotation[0, 0] + ground.rise_north * rotation[1, 0] - rotation[2, 0]
    )
    if 0.0 < height < _FARTHEST * sinking:
        return height / sinking
    return 0.0


@kernel(inline=True)
def rewarded_size(
    field_of_view: float,  # Horizontal [rad]
    rules: Rules,  # `view_range`, `aspect` are used
) -> tuple[float, float]:
    """Return half the width and height of the rewarded part of the picture, at a depth of 1 m."""
    half_width = rules.view_range * tan(0.5 * field_of_view)
    return half_width, half_width * rules.aspect


@kernel(inline=True)
def view_centre(
    position: NDArray[np.float64], rotation: NDArray[np.float64], depth: float
) -> tuple[float, float]:
    """Return the ground point in the middle of the picture, east and north [m].

    It is the point below the camera if `depth`, from `axis_depth`, is 0.
    """
    return position[0] + depth * rotation[0, 0], position[1] + depth * rotation[1, 0]


@kernel(inline=True)
def view_share(
    position: NDArray[np.float64],  # Optical centre, world frame [m], shape (3,)
    rotation: NDArray[np.float64],  # Camera to world; columns forward, left, up, shape (3, 3)
    depth: float,  # Depth from `axis_depth`
    ground: Plane,  # The plane under the target; its point is the target's place
    half_size: tuple[float, float],  # From `rewarded_size`
) -> float:
    """Return the target's share: 1 in the middle of the picture, 0 on the edge and outside.

    If the picture shows the horizon, the quadrilateral is open there, and the share is 1 along
    the optical axis from the middle to infinity.
    """
    dx, dy, dz = ground.x - position[0], ground.y - position[1], ground.z - position[2]
    forward = rotation[0, 0] * dx + rotation[1, 0] * dy + rotation[2, 0] * dz
    left = rotation[0, 1] * dx + rotation[1, 1] * dy + rotation[2, 1] * dz
    up = rotation[0, 2] * dx + rotation[1, 2] * dy + rotation[2, 2] * dz
    margin: float = forward - max(abs(left) / half_size[0], abs(up) / half_size[1])
    # The form of this condition gives no reward for NaN, which only absurd inputs produce.
    if depth > 0.0 and margin > 0.0:
        return min(margin / depth, 1.0)
    return 0.0


@kernel(inline=True)
def reward_value(share: float, distance: float, depth: float, rules: Rules) -> float:
    """Return the reward, 0 to 1; 0 if the optical axis does not meet the ground, unless constant.

    Args:
        share: Share from `view_share`.
        distance: Distance from the target to the ground point in the middle of the picture [m].
        depth: Depth from `axis_depth`.
        rules: Type of the reward, and its constants.
    """
    if rules.reward == _CONSTANT:
        return 1.0
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
    """Return the reward that decreases smoothly from the middle of the view to its edge."""
    return tanh(rules.view_scale * share * share * share)


@kernel
def view_discrete(share: float) -> float:
    """Return 1 inside the rewarded part of the picture, else 0."""
    return 1.0 if share > 0.0 else 0.0


@kernel
def distance_continuous(distance: float, rules: Rules) -> float:
    """Return the reward that decreases smoothly with the distance [m] from the view centre."""
    if not distance < rules.distance_range:
        return 0.0
    return 1.0 - tanh(rules.distance_scale * distance * distance * distance)


@kernel
def distance_discrete(distance: float, rules: Rules) -> float:
    """Return 1 within the rewarded distance [m] from the view centre, else 0."""
    return 1.0 if distance < rules.distance_range else 0.0
