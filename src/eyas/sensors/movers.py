"""The boxes of what moves near a tracker: actors, and the bodies of other trackers."""

import math
from typing import NamedTuple

from eyas.core.clock import PHYSICS_STEP
from eyas.core.jit import step_kernel
from eyas.sensors.bodies import body_box
from eyas.sensors.obstacles import Boxes, Movers
from eyas.state.scene import ACTOR_OBJECT
from eyas.state.snapshot import TrackerState
from eyas.traffic.interpolation import ActorPose, interpolate_actor, sample_before
from eyas.traffic.trailer import folded

__all__ = ["find_boxes"]

_SLACK = 20.0
"""Half the length of the longest actor, and more than any drives between two samples [m]."""


@step_kernel
def find_boxes(
    movers: Movers, n: int, tick: int, place: tuple[float, float, float], reach: float, boxes: Boxes
) -> int:
    """Find the boxes of what moves and may be near a place; return their number.

    Args:
        movers: What moves.
        n: The tracker in whose world it is, and whose own body does not count.
        tick: Time in the traffic, in physics steps.
        place: World frame [m].
        reach: How far from the place anything matters, along each axis [m].
        boxes: Where its boxes are written.
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
        before = interpolate_actor(motion, actor, time - PHYSICS_STEP)
        model = movers.model[world, actor]
        middle = movers.middle[model]
        for k in range(movers.first[model], movers.first[model + 1]):
            towed = movers.block[k].towed
            now, last = _carried(pose, middle, towed), _carried(before, middle, towed)
            _write_box(now, movers, k, boxes, count)
            moved = boxes.moved[count]
            moved[0], moved[1], moved[2] = now.x - last.x, now.y - last.y, now.z - last.z
            boxes.thing[count] = ACTOR_OBJECT + actor
            count += 1
    bodies = movers.bodies
    for other in range(bodies.position.shape[0]):
        if other == n or movers.world[other] != world:
            continue
        at = bodies.position[other]
        if abs(at[0] - place[0]) < far and abs(at[1] - place[1]) < far:
            _write_body(bodies, other, boxes, count)
            boxes.thing[count] = ACTOR_OBJECT + motion.table.shape[1] + other
            count += 1
    return count


@step_kernel
def _write_body(bodies: TrackerState, other: int, boxes: Boxes, count: int) -> None:
    """Write the box of a tracker's body, which stands upright around the tilted one."""
    at, box = bodies.position[other], body_box(bodies.orientation[other])
    for corner in range(4):
        forward = box.half_length if corner == 0 or corner == 3 else -box.half_length
        left = box.half_width if corner < 2 else -box.half_width
        boxes.corners[4 * count + corner, 0] = at[0] + box.cosine * forward - box.sine * left
        boxes.corners[4 * count + corner, 1] = at[1] + box.sine * forward + box.cosine * left
    boxes.bottom[count] = at[2] - box.half_height
    boxes.top[count] = at[2] + box.half_height
    for axis in range(3):
        boxes.moved[count, axis] = bodies.velocity[other, axis] * PHYSICS_STEP


class _Place(NamedTuple):
    """Where the reference point of the straight vehicle is, carried by its truck or trailer."""

    x: float
    """[m]"""
    y: float
    z: float
    cosine: float
    """Of the heading of that one."""
    sine: float


@step_kernel
def _carried(pose: ActorPose, middle: float, towed: int) -> _Place:
    """Return where a truck or its trailer is; others, and straight ones, are where the pose is.

    Args:
        pose: Pose of the whole.
        middle: Distance of its middle ahead of its reference point [m].
        towed: See `folded`.
    """
    cosine, sine = math.cos(pose.yaw), math.sin(pose.yaw)
    if pose.hitch == 0.0:
        return _Place(pose.x, pose.y, pose.z, cosine, sine)
    x, y, turn = folded(pose.hitch, towed)
    x, y = x + middle * (1.0 - math.cos(turn)), y - middle * math.sin(turn)
    return _Place(
        pose.x + cosine * x - sine * y,
        pose.y + sine * x + cosine * y,
        pose.z,
        math.cos(pose.yaw + turn),
        math.sin(pose.yaw + turn),
    )


@step_kernel
def _write_box(place: _Place, movers: Movers, k: int, boxes: Boxes, count: int) -> None:
    """Write box `k` of the models, which stands upright: its pitch on a slope is neglected."""
    block = movers.block[k]
    for corner in range(4):
        forward = block.ahead + (0.5 if corner == 0 or corner == 3 else -0.5) * block.length
        left = (0.5 if corner < 2 else -0.5) * block.width
        boxes.corners[4 * count + corner, 0] = place.x + place.cosine * forward - place.sine * left
        boxes.corners[4 * count + corner, 1] = place.y + place.sine * forward + place.cosine * left
    boxes.bottom[count] = place.z
    boxes.top[count] = place.z + block.height
