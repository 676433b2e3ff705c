"""The motion of all actors: one table, independent of its source."""

from collections.abc import Sequence
from enum import IntFlag
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

_NUMBERS: Final = (
    *("x", "y", "z", "velocity_x", "velocity_y", "velocity_z", "yaw", "yaw_rate", "slope"),
    *("hitch", "travelled", "present"),
)

# Aligned, else kernels read each number byte by byte on CUDA.
SAMPLE: Final = np.dtype([(name, np.float32) for name in _NUMBERS], align=True)
"""One actor at one instant, as motion is made.

x, y, z: reference point on the road, world frame [m]; velocity_x, velocity_y, velocity_z: its
velocity [m/s]; yaw: heading, counter-clockwise from east, without jumps at ±180° [rad]; yaw_rate
[rad/s]; slope: pitch of the road along the heading, positive up [rad]; hitch: heading of a trailer
less that of its truck, 0 of all others [rad]; travelled: horizontal path length since the first
sample [m]; present: 1 while the actor is in the world, else 0.

32 bits keep positions to 0.03 mm and halve the memory that each world's step touches.
"""

OFTEN: Final = ("x", "y", "velocity_x", "velocity_y", "yaw", "yaw_rate", "travelled")
"""What of `SAMPLE` always changes."""

SELDOM: Final = ("z", "velocity_z", "slope", "hitch", "present")
"""What seldom changes, on flat ground hardly ever."""

TRACK: Final = np.dtype(
    [*((name, np.float32) for name in OFTEN), ("footing", np.uint32)], align=True
)
"""One actor at one instant, as motion is kept and read: what always changes, and the row of
`Motion.footing` that holds the rest. Two fill a line of a cache."""

FOOTING: Final = np.dtype([(name, np.float32) for name in SELDOM], align=True)


class Lamp(IntFlag):
    """Lamps of a vehicle that are lit, as bits."""

    BRAKE = 1  # Brake lamps
    LEFT = 2  # It is going to go left: its indicators on the left blink
    RIGHT = 4  # It is going to go right: its indicators on the right blink


BLOCK: Final = 8  # Samples of an actor that are kept together

_AT_ONCE: Final = 512  # Samples that are sorted into blocks together

_DARK: Final = np.zeros((0, 0), np.uint8)  # Lamps of actors that have none


class Motion(NamedTuple):
    """Sampled motion of A actors, interpolated by kernels (`eyas.engine.traffic.interpolation`)."""

    track: NDArray[np.void]
    """Samples of dtype `TRACK`, shape (N,): of each actor `BLOCK` after each other, or one where it
    stands still or is away, as in a quarter of all."""
    start: NDArray[np.int32]
    """Where the samples of each block of each actor begin in `track`, or the bits of that number
    inverted where all are the same, shape (blocks, A)."""
    samples: int  # S, at least 2
    footing: NDArray[np.void]  # Of dtype `FOOTING`, shape (F,)
    kind: NDArray[np.int32]
    """Kind of each actor: index into `eyas.engine.targets.catalogue.KINDS`, shape (A,)."""
    rate: float  # Samples per second [Hz]
    first_time: float
    """Time of sample 0 [s]; 0 for a recording, later for traffic that is simulated live."""
    lamps: NDArray[np.uint8] = _DARK
    """`Lamp` of each actor at each sample, shape (S, A), or (0, 0) where nobody signals."""

    def places(self, rows: NDArray[np.integer]) -> NDArray[np.integer]:
        """Return where some samples of all actors are in `track`, shape (R, A)."""
        start = self.start[rows // BLOCK]
        own: NDArray[np.integer] = np.where(start < 0, ~start, start + (rows % BLOCK)[:, None])
        return own

    @property
    def table(self) -> NDArray[np.void]:
        """A copy of all samples of dtype `TRACK`, shape (S, A)."""
        samples: NDArray[np.void] = self.track[self.places(np.arange(self.samples))]
        return samples

    def of(self, table: NDArray[np.void]) -> "Motion":
        """Return the same with other samples of dtype `TRACK`, shape (S, A)."""
        return self._replace(**blocks_of(table)._asdict())

    def sampled(self) -> "SampledMotion":
        """Return the same with whole samples."""
        table = self.table
        made = np.zeros(table.shape, SAMPLE)
        for name in OFTEN:
            made[name] = table[name]
        for name in SELDOM:
            made[name] = self.footing[name][table["footing"]]
        return SampledMotion(made, *self[4:])


class SampledMotion(NamedTuple):
    """Motion as it is made; see `Motion`."""

    table: NDArray[np.void]  # Samples of dtype `SAMPLE`, shape (S, A)
    kind: NDArray[np.int32]
    rate: float
    first_time: float = 0.0
    lamps: NDArray[np.uint8] = _DARK

    def packed(self) -> Motion:
        """Return the same for kernels."""
        table, footing = packed(self.table)
        return Motion(*blocks_of(table), footing, self.kind, self.rate, self.first_time, self.lamps)


class Blocks(NamedTuple):
    """Fields of `Motion` of the same names."""

    track: NDArray[np.void]
    start: NDArray[np.int32]
    samples: int


def blocks_of(table: NDArray[np.void]) -> Blocks:
    """Return the blocks of samples of dtype `TRACK`, shape (S, A)."""
    samples, actors = table.shape
    tracks, starts, count = [], [], 0
    for first in range(0, samples, _AT_ONCE):  # all at once would take the memory of three tables
        some = table[first : first + _AT_ONCE]
        some = np.concatenate([some, np.repeat(some[-1:], -len(some) % BLOCK, axis=0)])
        whole = np.ascontiguousarray(some.reshape(len(some) // BLOCK, BLOCK, actors).swapaxes(1, 2))
        numbers = whole[..., None].view(np.uint64)  # they compare faster than records
        still = (numbers[:, :, 1:] == numbers[:, :, :1]).all(axis=(2, 3))
        kept = np.ones(whole.shape, np.bool_)
        kept[still, 1:] = False
        many = kept.sum(axis=2)
        start = np.cumsum(many).reshape(many.shape) - many + count
        tracks.append(whole[kept])
        starts.append(np.where(still, ~start, start).astype(np.int32))
        count += len(tracks[-1])
    return Blocks(np.concatenate(tracks), np.concatenate(starts), samples)


def packed(samples: NDArray[np.void]) -> tuple[NDArray[np.void], NDArray[np.void]]:
    """Return `Motion.table` and `Motion.footing` of samples of dtype `SAMPLE`, shape (S, A)."""
    whole = np.ascontiguousarray(samples).view(np.uint32).reshape(*samples.shape, len(_NUMBERS))
    seldom, new = whole[..., [*map(_NUMBERS.index, SELDOM)]], np.ones(samples.shape, np.bool_)
    new[1:] = (seldom[1:] != seldom[:-1]).any(axis=-1)
    table = np.empty((*samples.shape, len(OFTEN) + 1), np.uint32)
    table[..., :-1] = whole[..., [*map(_NUMBERS.index, OFTEN)]]
    number = np.where(new, np.cumsum(new).reshape(new.shape) - 1, 0)
    table[..., -1] = np.maximum.accumulate(number, axis=0)
    return table.view(TRACK)[..., 0], np.ascontiguousarray(seldom[new]).view(FOOTING)[:, 0]


class ActorState(NamedTuple):
    """State of A actors in each of W worlds."""

    position: NDArray[np.float64]
    """Reference point on the road, for a vehicle the middle of its SUMO length, world frame [m],
    shape (W, A, 3)."""
    yaw: NDArray[np.float64]  # Heading, counter-clockwise from east [rad], shape (W, A)
    slope: NDArray[np.float64]
    """Pitch of the road along the heading, positive up [rad], shape (W, A)."""
    speed: NDArray[np.float64]  # Horizontal speed [m/s], shape (W, A)
    velocity: NDArray[np.float64]  # Change of `position` [m/s], shape (W, A, 3)
    yaw_rate: NDArray[np.float64]  # [rad/s], shape (W, A)
    hitch: NDArray[np.float64]
    """Heading of a trailer less that of its truck [rad], shape (W, A); 0 of all others."""
    travelled: NDArray[np.float64]
    """Path length since the motion began [m], shape (W, A); it gives the rotation of wheels."""
    present: NDArray[np.bool_]  # Whether the actor is in the world, shape (W, A)

    @classmethod
    def create(cls, worlds: int, actors: int) -> "ActorState":
        """Return `actors` actors at the origin in each of `worlds` worlds."""
        plane = (worlds, actors)
        return cls(
            position=np.zeros((*plane, 3)),
            yaw=np.zeros(plane),
            slope=np.zeros(plane),
            speed=np.zeros(plane),
            velocity=np.zeros((*plane, 3)),
            yaw_rate=np.zeros(plane),
            hitch=np.zeros(plane),
            travelled=np.zeros(plane),
            present=np.zeros(plane, np.bool_),
        )

    def first(self, worlds: int) -> "ActorState":
        """Return the first worlds; the arrays are shared."""
        return ActorState._make(array[:worlds] for array in self)


class ActorView(NamedTuple):
    """All A actors of a tracker's world at the instant that its pictures show."""

    state: ActorState  # State of the actors of one world
    before: ActorState  # A physics step of 2 ms earlier
    model: NDArray[np.int32]  # Indices into `eyas.engine.targets.catalogue.MODELS`, shape (A,).
    colour: NDArray[np.float32]  # sRGB, 0 to 1, shape (A, 3)


def joined(motions: Sequence[Motion]) -> Motion:
    """Return one motion with the actors of several, in order.

    Args:
        motions: At least one motion, all with the same rate, first time and number of samples.

    Raises:
        ValueError: Their samples are not at the same times.
    """
    first = motions[0]
    if len(motions) == 1:
        return first
    for other in motions[1:]:
        times = [(m.samples, m.rate, m.first_time) for m in (first, other)]
        if times[0] != times[1]:
            raise ValueError(
                "motions: samples, rate [Hz] and first time [s] are {} and {}; "
                "allowed: the same in all".format(*times)
            )
    lamps = _DARK
    if any(motion.lamps.size for motion in motions):
        own = [
            m.lamps if m.lamps.size else np.zeros((m.samples, len(m.kind)), np.uint8)
            for m in motions
        ]
        lamps = np.concatenate(own, axis=1)
    track = np.concatenate([motion.track for motion in motions])
    counts, tracks = np.array([[len(m.footing), len(m.track)] for m in motions]).T
    track["footing"] += np.repeat(np.cumsum(counts) - counts, tracks).astype(np.uint32)
    starts = [
        np.where(m.start < 0, m.start - before, m.start + before)
        for m, before in zip(motions, (np.cumsum(tracks) - tracks).tolist(), strict=True)
    ]
    return Motion(
        track=track,
        start=np.ascontiguousarray(np.concatenate(starts, axis=1), np.int32),
        samples=first.samples,
        footing=np.concatenate([motion.footing for motion in motions]),
        kind=np.concatenate([motion.kind for motion in motions]),
        rate=first.rate,
        first_time=first.first_time,
        lamps=lamps,
    )
