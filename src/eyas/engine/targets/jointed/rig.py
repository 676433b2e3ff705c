"""The rig of people and robots, and the box in which one of them fits at a moment."""

import math
from functools import cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.shipped import Block, read_block
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.kind import Group, Looks
from eyas.engine.targets.posing import ActorFrame, Slots
from eyas.engine.targets.shapes import FILE, Columns, ShapeArrays, ShippedRig, records
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos, tan

# Poses of the parts of people and robots.
#
# The frames of the parts through a cycle are in a table (`art/jointed/cycle.py` makes it), so an
# actor costs the same however it walks: each part is read, put into the world, and perhaps rolled.

_TIGHTEST = 0.3  # Radius of the tightest curve that wheels steer [m]


PART: Final = np.dtype(
    [
        ("part", np.int64),
        ("spins", "?"),
        ("steers", np.float64),
        ("own", "?"),
        ("red", np.float64),
        ("green", np.float64),
        ("blue", np.float64),
    ],
    align=True,
)
"""A part of a model.

part: index among the parts of the kind, -1 for an unused slot; spins: whether it rolls about its y
axis; steers: distance ahead of the axle that does not steer [m], 0 if it does not; own: whether it
has a colour of its own, sRGB, in the place of the actor's.
"""

BODY: Final = np.dtype(
    [
        ("per_metre", np.float64),
        ("slowest", np.float64),
        ("wheel_radius", np.float64),
        ("upright", "?"),
    ],
    align=True,
)
"""A model.

per_metre: cycles in a metre [1/m]; slowest: speed from which it moves fully [m/s]; wheel_radius:
of what spins [m], 0 if nothing does; upright: whether it stays upright on slopes.
"""


class CycleTable(NamedTuple):
    """Data of M models with S slots each, for the kernel."""

    slot: NDArray[np.void]  # Parts of dtype `PART`, shape (M, S)
    body: NDArray[np.void]  # Models of dtype `BODY`, shape (M,)
    rest: NDArray[np.float32]
    """Frames of the parts of a standing model: x, y and z axis and origin, shape (M, S, 4, 3)."""
    cycle: NDArray[np.float32]
    """The same of a moving one at the beginnings of K intervals of a cycle, and at its end, shape
    (M, K + 1, S, 4, 3)."""


@kernel
def _base_of(actors: ActorState, w: int, a: int, upright: bool) -> ActorFrame:
    """Return the frame of an actor on its ground.

    On a slope, one that stays upright is sheared, so that its feet are on the ground.
    """
    yaw, slope = actors.yaw[w, a], actors.slope[w, a]
    s, c = sin_cos(yaw)
    cp, sp, rise = 1.0, 0.0, 0.0
    if slope != 0.0:
        if upright:
            rise = tan(slope)
        else:
            sp, cp = sin_cos(slope)
            rise = sp
    return ActorFrame(
        c * cp, -s, -c * sp,
        s * cp, c, -s * sp,
        rise, 0.0, cp,
        actors.position[w, a, 0], actors.position[w, a, 1], actors.position[w, a, 2],
    )  # fmt: skip


@kernel
def _place_part(
    pose: NDArray[np.float32],  # Pose to write, shape (3, 4)
    base: ActorFrame,
    # Its frame at the beginning of an interval of the cycle, shape (4, 3)
    first: NDArray[np.float32],
    second: NDArray[np.float32],  # Its frame at the end of the interval
    later: float,  # Share of the interval that is over
) -> None:
    """Write the pose of one part."""
    for axis in range(4):
        x = first[axis, 0] + later * (second[axis, 0] - first[axis, 0])
        y = first[axis, 1] + later * (second[axis, 1] - first[axis, 1])
        z = first[axis, 2] + later * (second[axis, 2] - first[axis, 2])
        pose[0, axis] = base.xx * x + base.xy * y + base.xz * z
        pose[1, axis] = base.yx * x + base.yy * y + base.yz * z
        pose[2, axis] = base.zx * x + base.zz * z
    pose[0, 3] += base.x
    pose[1, 3] += base.y
    pose[2, 3] += base.z


@kernel
def _fade_part(
    pose: NDArray[np.float32], base: ActorFrame, rest: NDArray[np.float32], moving: float
) -> None:
    """Blend a pose with the resting one; arguments as above."""
    for axis in range(4):
        x, y, z = float(rest[axis, 0]), float(rest[axis, 1]), float(rest[axis, 2])
        u = base.xx * x + base.xy * y + base.xz * z
        v = base.yx * x + base.yy * y + base.yz * z
        w = base.zx * x + base.zz * z
        if axis == 3:
            u, v, w = u + base.x, v + base.y, w + base.z
        pose[0, axis] = u + moving * (pose[0, axis] - u)
        pose[1, axis] = v + moving * (pose[1, axis] - v)
        pose[2, axis] = w + moving * (pose[2, axis] - w)


@kernel
def _turn(pose: NDArray[np.float32], a: int, b: int, cosine: float, sine: float) -> None:
    """Turn a part about an axis of its own: axis a towards axis b."""
    for row in range(3):
        u, v = float(pose[row, a]), float(pose[row, b])
        pose[row, a] = cosine * u + sine * v
        pose[row, b] = cosine * v - sine * u


@kernel
def _steering(ahead: float, yaw_rate: float, speed: float) -> tuple[float, float]:
    """Return cosine and sine of a wheel's steering angle."""
    bound = speed / _TIGHTEST
    curve = min(max(yaw_rate, -bound), bound) / max(speed, 1e-3)
    turn = ahead * curve
    cosine = 1.0 / np.sqrt(1.0 + turn * turn)
    return cosine, turn * cosine


@kernel
def pose_figure(
    table: CycleTable, group: Group, actors: ActorState, looks: Looks, out: Slots, w: int, g: int
) -> None:
    """Write the slots of one actor."""
    a, first = group.actor[g], group.slot[g]
    model = looks.model[w, a] - group.first_model
    body = table.body[model]
    base = _base_of(actors, w, a, body.upright)
    travelled, speed = actors.travelled[w, a], actors.speed[w, a]
    intervals = table.cycle.shape[1] - 1
    cycles = travelled * body.per_metre / base.zz
    place = (cycles - np.floor(cycles)) * intervals
    row = min(int(place), intervals - 1)
    moving = min(speed / body.slowest, 1.0)
    cosine, sine = 1.0, 0.0
    if body.wheel_radius > 0.0:
        angle = travelled / body.wheel_radius
        sine, cosine = sin_cos(angle)
    for k in range(table.slot.shape[1]):
        slot, part = first + k, table.slot[model, k]
        if part.part < 0:
            out.part[w, slot] = -1
            continue
        out.part[w, slot] = group.first_part + part.part
        pose = out.pose[w, slot]
        frames = table.cycle[model]
        _place_part(pose, base, frames[row, k], frames[row + 1, k], place - row)
        if moving < 1.0:
            _fade_part(pose, base, table.rest[model, k], moving)
        if part.steers != 0.0:
            steer = _steering(part.steers, actors.yaw_rate[w, a], speed)
            _turn(pose, 0, 1, steer[0], steer[1])
        if part.spins:
            _turn(pose, 2, 0, cosine, sine)
        if part.own:
            out.colour[w, slot, 0] = part.red
            out.colour[w, slot, 1] = part.green
            out.colour[w, slot, 2] = part.blue
        else:
            for channel in range(3):
                out.colour[w, slot, channel] = looks.colour[w, a, channel]


_SHEARED = 1.25  # Factor by which what stays upright on a slope may be farther from its origin

Floats = NDArray[np.float64]


class JointedArrays(NamedTuple):
    """A `CycleTable` as it ships: many parts of people move alike, but for their sizes."""

    slot: Columns
    body: Columns
    scale: Floats  # Factor on the lengths of each model, shape (M,)
    track: NDArray[np.int32]  # Index into `tracks` of each slot, -1 for none, shape (M, S)
    tracks: Floats
    """Frames of a part that stands, and then through a cycle, as in `CycleTable`, shape
    (., K + 2, 4, 3)."""

    def table(self) -> CycleTable:
        """Return what the kernel reads."""
        frames = self.tracks[np.maximum(self.track, 0)] * self.scale[:, None, None, None, None]
        frames[self.track < 0] = 0.0
        cycle = np.moveaxis(frames[:, :, 1:], 1, 2)
        return CycleTable(
            slot=records(self.slot, PART),
            body=records(self.body, BODY),
            rest=frames[:, :, 0].astype(np.float32),
            cycle=np.ascontiguousarray(cycle, np.float32),
        )


class JointedRig(ShippedRig):
    """The rig of the models of one kind."""

    def __init__(self, shapes: ShapeArrays) -> None:
        table = _table_of(shapes.table)
        super().__init__(shapes, table, pose_figure)
        self._table = table

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of an actor may be from its reference point, see `Rig` [m]."""
        slot = self._table.slot["part"]
        size = np.linalg.norm(self._table.rest[:, :, 0].astype(np.float64), axis=-1)
        away = _farthest(self._table) + size * parts[slot]
        return float(away[slot >= 0].max())


@cache  # all rigs of a kind have the same
def _table_of(block: Block) -> CycleTable:
    return read_block(FILE, block, JointedArrays).table()


def _farthest(table: CycleTable) -> Floats:
    """Return how far the origins of parts are from the actor's, at most [m], shape (M, S)."""
    away = np.linalg.norm(table.cycle[..., 3, :].astype(np.float64), axis=-1).max(axis=1)
    still = np.linalg.norm(table.rest[..., 3, :].astype(np.float64), axis=-1)
    return np.asarray(_SHEARED * np.maximum(away, still), np.float64)


class Extents(NamedTuple):
    """The boxes of a figure: least and largest x, y and z in the model frame [m]."""

    rest: Floats  # While it stands, shape (2, 3)
    cycle: Floats
    """While it moves, at the beginnings of K intervals of a cycle and at its end,
    shape (K + 1, 2, 3)."""
    stride: float  # Distance travelled in a cycle [m]
    slowest: float  # Speed from which it moves fully [m/s]

    def at(self, travelled: float, speed: float) -> Floats:
        """Return the box at a moment, shape (2, 3).

        Parts move along straight lines within an interval, and so between standing and moving, so
        boxes that are blended like them contain them.

        Args:
            travelled: Way since it entered the world, along the ground [m].
            speed: [m/s]
        """
        cycles, intervals = travelled / self.stride, len(self.cycle) - 1
        place = (cycles - math.floor(cycles)) * intervals
        row = min(int(place), intervals - 1)
        first, second = self.cycle[row], self.cycle[row + 1]
        moving = first + (place - row) * (second - first)
        blended: Floats = self.rest + min(speed / self.slowest, 1.0) * (moving - self.rest)
        return blended


def extent_at(block: Block, name: str, travelled: float, speed: float) -> Floats:
    """Return the box of a model at a moment, see `Kind.extent`."""
    return _extents_of(block)[name].at(travelled, speed)


@cache
def _extents_of(block: Block) -> dict[str, Extents]:
    return read_block(FILE, block, dict[str, Extents])
