"""The boxes of the actors near a tracker."""

import math

from eyas.core.clock import PHYSICS_STEP
from eyas.core.jit import step_kernel
from eyas.sensors.obstacles import Boxes, Movers
from eyas.state.scene import ACTOR_OBJECT
from eyas.traffic.interpolation import ActorPose, interpolate_actor, sample_before

__all__ = ["find_boxes"]

_SLACK = 20.0
"""Half the length of the longest actor, and more than any drives between two samples [m]."""


@step_kernel
def find_boxes(
    movers: Movers, n: int, tick: int, place: tuple[float, float, float], reach: float, boxes: Boxes
) -> int:
    """Find the actors that may be near a place; return their number.

    Args:
        movers: The actors.
        n: The tracker in whose world they are.
        tick: Time in the traffic, in physics steps.
        place: World frame [m].
        reach: How far from the place anything matters, along each axis [m].
        boxes: Where their boxes are written.
    """
    count, motion, time = 0, movers.motion, tick * PHYSICS_STEP
    row, world, far = sample_before(motion, time), movers.world[n], reach + _SLACK
    for actor in range(motion.table.shape[1]):
        sample = motion.table[row, actor]
        # Most are far away: a look at the last sample is a tenth of an interpolation.
        if abs(sample.x - place[0]) > far or abs(sample.y - place[1]) > far:
            continue
        if abs(sample.z - place[2]) > far:
            continue
        pose = interpolate_actor(motion, actor, time)
        if not pose.present:
            continue
        model = movers.model[world, actor]
        _write_box(pose, movers, model, boxes, count)
        before = interpolate_actor(motion, actor, time - PHYSICS_STEP)
        moved = boxes.moved[count]
        moved[0], moved[1], moved[2] = pose.x - before.x, pose.y - before.y, pose.z - before.z
        boxes.thing[count] = ACTOR_OBJECT + actor
        count += 1
    return count


@step_kernel
def _write_box(pose: ActorPose, movers: Movers, model: int, boxes: Boxes, count: int) -> None:
    """Write an actor's box, which stands upright: its pitch on a slope is neglected."""
    size, ahead = movers.size[model], movers.ahead[model]
    cosine, sine = math.cos(pose.yaw), math.sin(pose.yaw)
    for corner in range(4):
        forward = ahead + (0.5 if corner == 0 or corner == 3 else -0.5) * size[0]
        left = (0.5 if corner < 2 else -0.5) * size[1]
        boxes.corners[4 * count + corner, 0] = pose.x + cosine * forward - sine * left
        boxes.corners[4 * count + corner, 1] = pose.y + sine * forward + cosine * left
    boxes.bottom[count] = pose.z
    boxes.top[count] = pose.z + size[2]
