"""The boxes of what moves near a tracker: actors, and the bodies of other trackers."""

from typing import NamedTuple

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.sensors.bodies import body_box
from eyas.engine.sensors.obstacles import Boxes, MovingObstacles
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.traffic.interpolation import ActorPose, interpolate_actor, place_of, sample_before
from eyas.engine.traffic.trailer import folded
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos

_SLACK = 20.0
"""Half the length of the longest actor, and more than any drives between two samples [m]."""


@kernel(inline=True)
def find_boxes(
    movers: MovingObstacles,  # What moves
    n: int,  # The tracker in whose world it is, and whose own body does not count
    tick: int,  # Time in the traffic, in physics steps
    place: tuple[float, float, float],  # World frame [m]
    reach: float,  # How far from the place anything matters, along each axis [m]
    boxes: Boxes,  # Where its boxes are written
) -> int:
    """Find the boxes of what moves and may be near a place; return their number."""
    count, motion, time = 0, movers.motion, tick * PHYSICS_STEP
    row, world, far = sample_before(motion, time), movers.world[n], reach + _SLACK
    for actor in range(motion.start.shape[1]):
        sample = motion.track[place_of(motion, row, actor)]
        # Most are far away: a look at the last sample is a tenth of an interpolation.
        if abs(sample.x - place[0]) > far or abs(sample.y - place[1]) > far:
            continue
        if abs(motion.footing[sample.footing].z - place[2]) > far:
            continue
        pose = interpolate_actor(motion, actor, time)
        if not pose.present:
            continue
        begin = count
        count = _write_boxes(pose, movers, movers.model[world, actor], boxes, count)
        # A trailer that swings moves some millimetres more, which is neglected like all turns.
        before = interpolate_actor(motion, actor, time - PHYSICS_STEP)
        for box in range(begin, count):
            moved = boxes.moved[box]
            moved[0], moved[1], moved[2] = pose.x - before.x, pose.y - before.y, pose.z - before.z
            boxes.thing[box] = ACTOR_OBJECT + actor
    bodies = movers.bodies
    for other in range(bodies.position.shape[0]):
        if other == n or movers.world[other] != world:
            continue
        at = bodies.position[other]
        if abs(at[0] - place[0]) < far and abs(at[1] - place[1]) < far:
            _write_body(bodies, other, boxes, count)
            boxes.thing[count] = ACTOR_OBJECT + motion.start.shape[1] + other
            count += 1
    for box in range(count):
        _write_bounds(boxes, box)
    return count


@kernel(inline=True)
def _write_bounds(boxes: Boxes, box: int) -> None:
    """Write the bounds of a box whose corners are known."""
    corners, first = boxes.corners, 4 * box
    for axis in range(2):
        a, b = corners[first, axis], corners[first + 1, axis]
        c, d = corners[first + 2, axis], corners[first + 3, axis]
        boxes.bounds[box, axis] = min(a, b, c, d)
        boxes.bounds[box, 2 + axis] = max(a, b, c, d)


@kernel(inline=True)
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

    x: float  # [m]
    y: float
    cosine: float  # Of the heading of that one
    sine: float


@kernel(inline=True)
def _carried(
    whole: _Place,  # Pose of both together
    hitch: float,  # Heading of the trailer less that of the truck [rad]
    middle: float,  # Distance of the middle of the whole ahead of its reference point [m]
    towed: int,  # See `folded`
) -> _Place:
    """Return where a truck or its trailer is."""
    x, y, c, s = folded(hitch, towed)
    x, y = x + middle * (1.0 - c), y - middle * s
    return _Place(
        whole.x + whole.cosine * x - whole.sine * y,
        whole.y + whole.sine * x + whole.cosine * y,
        whole.cosine * c - whole.sine * s,
        whole.sine * c + whole.cosine * s,
    )


@kernel(inline=True)
def _write_boxes(
    pose: ActorPose, movers: MovingObstacles, model: int, boxes: Boxes, count: int
) -> int:
    """Write an actor's boxes, which stand upright: its pitch on a slope is neglected.

    Returns:
        How many there are then, with `count` before.
    """
    sine, cosine = sin_cos(pose.yaw)
    whole = _Place(pose.x, pose.y, cosine, sine)
    for k in range(movers.first[model], movers.first[model + 1]):
        block, at = movers.block[k], whole
        if pose.hitch != 0.0:
            at = _carried(whole, pose.hitch, movers.middle[model], block.towed)
        for corner in range(4):
            forward = block.ahead + (0.5 if corner == 0 or corner == 3 else -0.5) * block.length
            left = (0.5 if corner < 2 else -0.5) * block.width
            boxes.corners[4 * count + corner, 0] = at.x + at.cosine * forward - at.sine * left
            boxes.corners[4 * count + corner, 1] = at.y + at.sine * forward + at.cosine * left
        boxes.bottom[count] = pose.z
        boxes.top[count] = pose.z + block.height
        count += 1
    return count
