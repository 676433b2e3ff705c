"""Traffic with a further actor for each tracker: its target, whose motion is written as it goes.

All worlds read one table of motion, each at a time of its own, so a target that is moved in one
world is there in all. What a world must not show has the model `HIDDEN` in its looks: the targets
of other worlds, and the recorded actor whose place a target has taken.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.state.motion import BLOCK, FOOTING, TRACK, ActorState, Motion
from eyas.engine.state.terrain import Terrain, reliefs
from eyas.engine.traffic.interpolation import interpolate_actors
from eyas.engine.traffic.source import Stays, TrafficSource
from eyas.engine.traffic.steering import Steps
from eyas.lanes import exact

_BEFORE: Final = 2  # Recorded samples that a target keeps before the one at which it begins
_AFTER: Final = 3  # Samples after the last of an episode, one of them foretold
_SPAN: Final = 0.5  # Half the distance over which the slope of the ground is taken [m]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class Pose(NamedTuple):
    """Where K actors are at a sample."""

    place: Floats  # East and north [m], shape (K, 2)
    yaw: Floats  # [rad], shape (K,)
    speed: Floats  # [m/s], shape (K,)


class EvaderTraffic:
    """Traffic of another source, and N actors behind its own, of one kind.

    Attributes:
        motion: Motion of all actors; the columns of the last N are written by `take_over` and
            `write`.
        own: Number of actors of the other source, A: target n is actor A + n.
        ticks: Physics steps between two samples.
    """

    live: Final = False

    def __init__(
        self,
        source: TrafficSource,  # Recorded traffic
        kind: int,  # Kind of the targets, index into `eyas.engine.targets.catalogue.KINDS`
        count: int,  # N
        longest: int,  # Length of an episode in physics steps
        terrain: Terrain,
    ) -> None:
        motion, self._terrain = source.motion, terrain
        self.duration: Final = source.duration  # Last time of the traffic [s]; the first is 0
        self.own: Final = len(motion.kind)
        self.ticks: Final = round(1.0 / motion.rate / PHYSICS_STEP)
        wanted = min(longest // self.ticks + 1, motion.samples) + _BEFORE + _AFTER
        self._blocks = wanted // BLOCK + 2
        rows, first = self._blocks * BLOCK, len(motion.track)
        absent = first + count * rows  # one sample for all times at which no target is there
        track, footing = np.zeros(count * rows + 1, TRACK), np.zeros(count * rows + 1, FOOTING)
        track["footing"] = len(motion.footing) + np.arange(len(track))
        start = np.full((len(motion.start), count), ~np.int64(absent), np.int32)
        lamps = motion.lamps
        if lamps.size:
            lamps = np.concatenate([lamps, np.zeros((len(lamps), count), np.uint8)], axis=1)
        self.motion: Final = Motion(
            track=np.concatenate([motion.track, track]),
            start=np.ascontiguousarray(np.concatenate([motion.start, start], axis=1)),
            samples=motion.samples,
            footing=np.concatenate([motion.footing, footing]),
            kind=np.concatenate([motion.kind, np.full(count, kind)]).astype(np.int32),
            rate=motion.rate,
            first_time=0.0,
            lamps=lamps,
        )
        # Views of what is written, which an environment that is copied takes along.
        self.track = self.motion.track[first:]
        self.footing = self.motion.footing[len(motion.footing) :]
        self.start = self.motion.start[:, self.own :]
        self.lamps = self.motion.lamps[:, self.own :] if lamps.size else lamps
        self._absent: Final = absent
        self._first: Final = first
        self._begun = np.zeros(count, np.int64)  # Block in which each target has begun
        self.known = np.zeros(count, np.int64)  # Last sample of each that has been decided
        may = motion.kind == kind
        stays = source.stays()
        kept = may[stays.actor]
        self._stays = Stays(stays.actor[kept], stays.enters[kept], stays.leaves[kept], stays.known)

    @property
    def actors(self) -> int:
        """Number of actors."""
        return len(self.motion.kind)

    def prepare(self, until: float) -> None:
        """Do nothing: what is recorded is known, and targets move by `write`."""

    def close(self) -> None:
        """Do nothing: nothing drives."""

    def at(self, time: Floats, out: ActorState) -> None:
        """Write all actors of W worlds at the time of each world [s], shape (W,)."""
        interpolate_actors(self.motion, time, out)

    def stays(self) -> Stays:
        """Return when recorded actors are there whose places targets may take."""
        return self._stays

    def take_over(self, target: int, actor: int, tick: int) -> None:
        """Let a target go on where a recorded actor is, from the next sample on [physics step]."""
        motion = self.motion
        row = min(tick // self.ticks, motion.samples - 2)
        begun = max(row - _BEFORE, 0) // BLOCK
        self._begun[target], self.known[target] = begun, row + 1
        column, end = self.start[:, target], min(begun + self._blocks, len(self.start))
        column[:] = ~np.int32(self._absent)
        base = self._first + target * self._blocks * BLOCK
        column[begun:end] = base + BLOCK * np.arange(end - begun)
        mine = self._places(np.array([target]), np.arange(begun * BLOCK, end * BLOCK))[0]
        self.footing["present"][mine] = 0.0
        rows = np.arange(max(row - _BEFORE, begun * BLOCK), row + 2)
        theirs = motion.places(rows)[:, actor]
        mine = self._places(np.array([target]), rows)[0]
        for name in TRACK.names or ():
            if name != "footing":
                self.track[name][mine] = motion.track[name][theirs]
        self.footing[mine] = motion.footing[motion.track["footing"][theirs]]
        if self.lamps.size:
            self.lamps[rows, target] = motion.lamps[rows, actor]
        self._foretell(np.array([target]))

    def pose(self, targets: Integers) -> Pose:
        """Return where targets are at the last sample that is decided."""
        track = self.track[self._place(targets, self.known[targets])]
        x, y, east, north = (
            track[name].astype(np.float64) for name in ("x", "y", "velocity_x", "velocity_y")
        )
        yaw, speed = track["yaw"].astype(np.float64), np.asarray(exact.hypot(east, north))
        return Pose(np.stack([x, y], axis=1), yaw, speed)

    def write(
        self, targets: Integers, steps: Steps, height: Floats, lamps: NDArray[np.uint8]
    ) -> None:
        """Write the next sample of targets, at heights [m] and with lamps, shapes (K,)."""
        before = self.track["travelled"][self._place(targets, self.known[targets])]
        self.known[targets] += 1
        at = self._place(targets, self.known[targets])
        self.track["x"][at], self.track["y"][at] = steps.place.T
        self.track["velocity_x"][at], self.track["velocity_y"][at] = steps.velocity.T
        self.track["yaw"][at], self.track["yaw_rate"][at] = steps.yaw, steps.yaw_rate
        self.track["travelled"][at] = before + steps.driven
        ahead = _SPAN * np.stack([exact.cos(steps.yaw), exact.sin(steps.yaw)], axis=1)
        rise = reliefs(self._terrain, steps.place + ahead) - reliefs(
            self._terrain, steps.place - ahead
        )
        slope = rise / (2.0 * _SPAN)
        self.footing["z"][at], self.footing["slope"][at] = height, exact.atan(slope)
        speed = exact.hypot(steps.velocity[:, 0], steps.velocity[:, 1])
        self.footing["velocity_z"][at], self.footing["hitch"][at] = slope * speed, 0.0
        self.footing["present"][at] = 1.0
        if self.lamps.size:
            self.lamps[self.known[targets], targets] = lamps
        self._foretell(targets)

    def _foretell(self, targets: Integers) -> None:
        """Write the sample after the last that is decided, as if nothing changed: some pictures
        look a little ahead.
        """
        period = 1.0 / self.motion.rate
        inside = self.known[targets] + 1 < self.motion.samples
        targets = targets[inside]
        last = self._place(targets, self.known[targets])
        at = self._place(targets, self.known[targets] + 1)
        for name in TRACK.names or ():
            if name != "footing":
                self.track[name][at] = self.track[name][last]
        self.footing[at] = self.footing[last]
        self.track["x"][at] += period * self.track["velocity_x"][last]
        self.track["y"][at] += period * self.track["velocity_y"][last]

    def _place(self, targets: Integers, rows: Integers) -> Integers:
        """Return where samples of targets, one of each, are in `track`, shape (K,)."""
        own = rows - self._begun[targets] * BLOCK
        return np.asarray(
            targets * self._blocks * BLOCK + np.minimum(own, self._blocks * BLOCK - 1)
        )

    def _places(self, targets: Integers, rows: Integers) -> Integers:
        """Return where the same samples of targets are in `track`, shape (K, R)."""
        own = rows[None] - self._begun[targets, None] * BLOCK
        return np.asarray(targets[:, None] * self._blocks * BLOCK + own)
