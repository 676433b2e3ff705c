"""Live traffic: SUMO drives in this process, a little ahead of the trackers.

The motion is that of a recording with the same settings, as it grows: SUMO's poses are filtered and
laid on the ground piece by piece. What has been driven stays, so a time that is past can be asked
for again; only what lies ahead can still be changed.
"""

import gc
import math
import weakref
from collections.abc import Callable, Sequence
from dataclasses import fields
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.state.motion import (
    BLOCK,
    FOOTING,
    OFTEN,
    SELDOM,
    TRACK,
    ActorState,
    Motion,
    joined,
)
from eyas.engine.state.roads import RoadGraph
from eyas.engine.state.terrain import Terrain
from eyas.engine.traffic.config import Demand, TrafficConfig, VehicleType
from eyas.engine.traffic.cover import Cover
from eyas.engine.traffic.fleet import ROOMS, fleet_of
from eyas.engine.traffic.interpolation import interpolate_actors
from eyas.engine.traffic.record import WARM_UP, roads_for
from eyas.engine.traffic.recorded import table_of
from eyas.engine.traffic.recording import ANGLE_UNIT, POSITION_UNIT, quantised, restored
from eyas.engine.traffic.smoothing import (
    REACH,
    SIGMA,
    Tracks,
    as_far,
    filtered,
    follow,
    front_path,
    lead_of,
    rate_of,
    runs,
)
from eyas.engine.traffic.source import Stays
from eyas.engine.traffic.sumo import RATE, Drive, SumoRun, no_room
from eyas.engine.traffic.trailer import Links, tow
from eyas.lanes import exact

# Smooth tracks of traffic that is still being driven: those of a recording, piece by piece.

_FILTER = round(REACH * SIGMA * RATE)
"""Samples before and after one that its filtered position depends on."""

_AHEAD = {Demand.KEEP_ALIVE: _FILTER + 2, Demand.RESPAWN: 3 * _FILTER}
"""Samples that are driven before one is smooth: the filter, and the differences of its speed. A
vehicle that is as far along the filtered path as SUMO has it needs more of that path, too."""

_BEFORE = 4 * _FILTER  # Samples before those to smooth that are filtered again

Floats = NDArray[np.float64]


class LiveTracks:
    """Tracks that grow.

    Attributes:
        driven: Number of samples that SUMO has driven.
        ready: Number of samples that are smooth.
        ahead: Number of samples that are driven before one is smooth.
        present: Whether each actor is in the world, shape (S, A).

    Args:
        run: SUMO's simulation.
        samples: Number of all samples, S.
        demand: When vehicles enter and leave, on which smoothing depends.
    """

    def __init__(self, run: SumoRun, samples: int, demand: Demand) -> None:
        self.driven = self.ready = 0
        self._run = run
        self._raw = Drive.create(samples, run.actors, run.vehicle_length)
        self._tracks = Tracks.create(float(RATE), samples, len(run.actors))
        self.present = self._raw.present
        self._yaw = np.full(len(run.actors), np.nan)
        self._grouped = demand is Demand.RESPAWN
        self.ahead = _AHEAD[demand]

    def append(self) -> None:
        """Append SUMO's poses now as a sample, rounded as in a recording."""
        raw, row = self._raw, self.driven
        self._run.read(raw, row)
        here = raw.present[row]
        raw.position[row] = restored(quantised(raw.position[row], POSITION_UNIT), POSITION_UNIT)
        yaw = np.where(here, raw.yaw[row], self._yaw)
        before = np.where(np.isnan(self._yaw), yaw, self._yaw)
        self._yaw = np.unwrap([before, yaw], axis=0)[1]
        raw.yaw[row] = restored(quantised(np.where(here, self._yaw, 0.0), ANGLE_UNIT), ANGLE_UNIT)
        self.driven += 1

    def smooth(self) -> slice:
        """Smooth the samples for which enough is driven; return them."""
        first, tracks = self.ready, self._tracks
        all_driven = self.driven == len(self.present)
        last = self.driven if all_driven else max(self.driven - self.ahead, first)
        window = slice(max(first - _BEFORE, 0), self.driven)
        tracks.present[first:last] = self.present[first:last]
        for actor in range(self.present.shape[1]):
            for begin, end in runs(self.present[window, actor]):
                stay = slice(window.start + begin, window.start + end)
                self._smooth_stay(stay, actor, slice(max(first, stay.start), min(last, stay.stop)))
        self._finish(first, last)
        self.ready = last
        return slice(first, last)

    def rows(self, rows: slice) -> Tracks:
        """Return some samples; the arrays are shared."""
        arrays = {field.name: getattr(self._tracks, field.name) for field in fields(Tracks)}
        rate = arrays.pop("rate")
        return Tracks(rate=rate, **{name: array[rows] for name, array in arrays.items()})

    def _smooth_stay(
        self,
        stay: slice,  # Its samples, as far as they are in the window
        actor: int,
        wanted: slice,  # The samples to write
    ) -> None:
        """Smooth some samples of a stay in the world."""
        if wanted.start >= wanted.stop:
            return
        tracks, length = self._tracks, float(self._raw.vehicle_length[actor])
        articulated = self._raw.vehicle_types[actor] is VehicleType.TRAILER
        arm = lead_of(length, articulated=articulated)
        yaw = self._raw.yaw[stay, actor]
        driven = front_path(self._raw.position[stay, actor], yaw, arm)
        front = filtered(driven, RATE)
        # In the middle of a stay, the filter has not seen what came before, so its first samples
        # are wrong; they are known, and so is the pose after them.
        within = stay.start > 0 and bool(self.present[stay.start - 1, actor])
        skipped = _FILTER if within else 0
        front, driven, yaw = front[skipped:], driven[skipped:], yaw[skipped:]
        if self._grouped:
            front = as_far(front, driven, yaw)
        begin = stay.start + skipped
        own = slice(wanted.start - begin, wanted.stop - begin)
        heading = float(tracks.yaw[begin, actor] if within else yaw[0])
        if articulated:
            links = Links.straight(heading)
            if within:
                hitch = float(tracks.hitch[begin, actor])
                links = Links.of(front[0], tracks.position[begin, actor], heading, hitch)
            centre, headings, hitches = tow(front, length, links)
            tracks.hitch[wanted, actor] = hitches[own]
        else:
            centre, headings = follow(front, heading, 2.0 * arm)
        tracks.position[wanted, actor] = centre[own]
        tracks.yaw[wanted, actor] = headings[own]
        if len(yaw) > 1:
            tracks.velocity[wanted, actor] = rate_of(centre, RATE)[own]
            tracks.yaw_rate[wanted, actor] = rate_of(headings, RATE)[own]

    def _finish(self, first: int, last: int) -> None:
        """Hold the poses of those who are absent, and add up the ways."""
        tracks = self._tracks
        for row in range(max(first, 1), last):
            absent = ~self.present[row]
            tracks.position[row, absent] = tracks.position[row - 1, absent]
            tracks.yaw[row, absent] = tracks.yaw[row - 1, absent]
            tracks.hitch[row, absent] = 0.0
            step = exact.hypot(*(tracks.position[row] - tracks.position[row - 1]).T)
            step[absent | ~self.present[row - 1]] = 0.0
            tracks.travelled[row] = tracks.travelled[row - 1] + step


Reaction = Callable[[SumoRun, float], None]
"""Called before each of SUMO's steps, with the time of the traffic [s]: it may change anything in
the running simulation through `SumoRun.sumo`, for example the speed of a vehicle."""

_FARTHEST = 1
"""Whole seconds beyond the one asked for that are ready: drawing looks up to one ahead [s]."""

_running: "weakref.ref[LiveSumo] | None" = None


class LiveSumo:
    """SUMO in this process as a `TrafficSource`; there can be one, and no recording beside it.

    Attributes:
        motion: Motion of all actors; its table is filled while time goes on.
        reactions: What is called before each step of SUMO; append your own.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: SUMO already runs in this process, or the roads have no room for the traffic.
    """

    live: Final = True

    def __init__(
        self,
        graph: RoadGraph,
        config: TrafficConfig,  # Settings from `resolved`
        terrain: Terrain,  # The ground; roads follow its relief
        # Function of the name of a class that returns its index, see `Motion.kind`
        kind: Callable[[str], int],
        duration: float,  # Last time [s]
        *,
        # Motions of those who are in the world besides; only vehicles are targets
        others: Sequence[Motion] = (),
        cover: Cover = (),  # The stretches of lanes in which drivers hide
        lamps: bool = False,  # Whether they signal, as SUMO has it
    ) -> None:
        _check_alone()
        town = bool(graph.finished)
        # There is no second try.
        room = ROOMS[1] if town else None
        fleet = fleet_of(config, WARM_UP + duration, room=room)
        self._run = SumoRun(roads_for(config, graph), config, fleet, cover, town=town)
        self._end = weakref.finalize(self, self._run.close)
        self._lasting = config.demand is Demand.KEEP_ALIVE
        self._terrain = terrain
        samples = round(duration * RATE) + 1
        kinds = np.array([kind(name) for name in self._run.actors], np.int32)
        # The system gives memory only to what is written.
        start = BLOCK * np.arange(-(-samples // BLOCK) * len(kinds), dtype=np.int32)
        track, footing = (np.zeros(BLOCK * len(start), kept) for kept in (TRACK, FOOTING))
        track["footing"] = np.arange(len(track))
        block = start.reshape(-1, len(kinds))
        empty = Motion(track, block, samples, footing, kinds, float(RATE), 0.0)
        if lamps:
            empty = empty._replace(lamps=np.zeros((samples, len(kinds)), np.uint8))
        self.motion: Final = joined([empty, *others]) if others else empty
        self._vehicles = len(kinds)
        self.reactions: Final[list[Reaction]] = []
        self._tracks = LiveTracks(self._run, samples, config.demand)
        for _ in range(round(WARM_UP * RATE) - 1):
            self._run.advance()
        self.prepare(0.0)
        if self._lasting and not town and not self._tracks.present[0].all():
            self.close()
            raise no_room(self._tracks.present[0])
        global _running
        _running = weakref.ref(self)

    @property
    def actors(self) -> int:
        """Number of actors."""
        return len(self.motion.kind)

    @property
    def duration(self) -> float:
        """Last time of the traffic [s]; the first is 0."""
        return (self.motion.samples - 1) / RATE

    @property
    def ahead(self) -> float:
        """Last time that SUMO has driven: what is later can be changed [s]."""
        return (self._tracks.driven - 1) / RATE

    def close(self) -> None:
        """End SUMO's simulation; what it has driven can still be asked for."""
        self._end()

    def prepare(self, until: float) -> None:
        """Drive on until the motion is known up to a time [s].

        Raises:
            ConfigError: The simulation was closed before that time.
        """
        wanted = min((math.floor(until) + 1 + _FARTHEST) * RATE + 1, self.motion.samples)
        if wanted <= self._tracks.ready:
            return
        if not self._end.alive:
            raise ConfigError(
                f"traffic.source: the live traffic was closed at {self.ahead:g} s, but {until:g} s "
                "was asked for"
            )
        self._drive(min(wanted + self._tracks.ahead, self.motion.samples))

    def at(self, time: NDArray[np.float64], out: ActorState) -> None:
        """Write all actors of W worlds at the time of each world [s], shape (W,)."""
        self.prepare(float(np.max(time)))
        interpolate_actors(self.motion, time, out)

    def stays(self) -> Stays:
        """Return when each vehicle is in the world, as far as SUMO has driven.

        Vehicles that come and go may leave at any later time: where they go is not known before.
        """
        ready = self._tracks.ready
        present = self._tracks.present[:ready]
        stays = [(who, *stay) for who in range(self._vehicles) for stay in runs(present[:, who])]
        who, enters, ends = np.array(stays, np.int64).reshape(-1, 3).T.copy()
        # Half a sample longer: a time between two samples belongs to the nearer one.
        leaves = np.where(ends == ready, math.inf, (ends - 0.5) / RATE)
        everything = ready == self.motion.samples
        known = math.inf if everything else float((ready - 1) // RATE - _FARTHEST)
        return Stays(who, enters / RATE, leaves, known)

    def _drive(self, samples: int) -> None:
        """Let SUMO drive on until there are so many samples, and append what is known then."""
        tracks = self._tracks
        while tracks.driven < samples:
            for react in self.reactions:
                react(self._run, tracks.driven / RATE)
            self._run.advance()
            if self.motion.lamps.size:
                self._run.read_lamps(self.motion.lamps[tracks.driven])
            tracks.append()
        rows = tracks.smooth()
        made, track = table_of(tracks.rows(rows), self._terrain), self.motion.track
        at = self.motion.places(np.arange(rows.start, rows.stop))[:, : self._vehicles]
        for name in OFTEN:
            track[name][at] = made[name]
        on = track["footing"][at]
        for name in SELDOM:
            self.motion.footing[name][on] = made[name]


def _check_alone() -> None:
    """Refuse a second live world; one that nobody uses any more is ended."""
    gc.collect()
    other = _running() if _running is not None else None
    if other is not None and other._end.alive:
        raise ConfigError(
            "traffic.source: 'live' is in use in this process already, and libsumo runs one "
            "simulation in a process; close the other one, or use 'recorded'"
        )
