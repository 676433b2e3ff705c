"""Live traffic: SUMO drives in this process, a little ahead of the trackers.

The motion is that of a recording with the same settings, as it grows: SUMO's poses are filtered and
laid on the ground piece by piece. What has been driven stays, so a time that is past can be asked
for again; only what lies ahead can still be changed.
"""

import gc
import math
import weakref
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.state.motion import SAMPLE, ActorState, Motion, joined
from eyas.engine.state.roads import RoadGraph
from eyas.engine.state.terrain import Terrain
from eyas.engine.traffic.config import Demand, TrafficConfig
from eyas.engine.traffic.cover import Cover
from eyas.engine.traffic.fleet import fleet_of
from eyas.engine.traffic.interpolation import interpolate_actors
from eyas.engine.traffic.live_tracks import LiveTracks
from eyas.engine.traffic.record import WARM_UP, roads_for
from eyas.engine.traffic.recorded import table_of
from eyas.engine.traffic.smoothing import runs
from eyas.engine.traffic.source import Stays
from eyas.engine.traffic.sumo import RATE, SumoRun, no_room

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

    Args:
        graph: The roads.
        config: Settings from `resolved`.
        terrain: The ground; roads follow its relief.
        kind: Function of the name of a class that returns its index, see `Motion.kind`.
        duration: Last time [s].
        others: Motions of those who are in the world besides; only vehicles are targets.
        cover: The stretches of lanes in which drivers hide.
        lamps: Whether they signal, as SUMO has it.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: SUMO already runs in this process, or the roads have no room for the traffic.
    """

    live: Final = True

    def __init__(
        self,
        graph: RoadGraph,
        config: TrafficConfig,
        terrain: Terrain,
        kind: Callable[[str], int],
        duration: float,
        *,
        others: Sequence[Motion] = (),
        cover: Cover = (),
        lamps: bool = False,
    ) -> None:
        _check_alone()
        fleet = fleet_of(config, WARM_UP + duration)
        self._run = SumoRun(roads_for(config, graph), config, fleet, cover)
        self._end = weakref.finalize(self, self._run.close)
        self._lasting = config.demand is Demand.KEEP_ALIVE
        self._terrain = terrain
        samples = round(duration * RATE) + 1
        kinds = np.array([kind(name) for name in self._run.actors], np.int32)
        # The system gives memory only to what is written.
        empty = Motion(np.zeros((samples, len(kinds)), SAMPLE), kinds, float(RATE), 0.0)
        if lamps:
            empty = empty._replace(lamps=np.zeros(empty.table.shape, np.uint8))
        self.motion: Final = joined([empty, *others]) if others else empty
        self._vehicles = len(kinds)
        self.reactions: Final[list[Reaction]] = []
        self._tracks = LiveTracks(self._run, samples, config.demand)
        for _ in range(round(WARM_UP * RATE) - 1):
            self._run.advance()
        self.prepare(0.0)
        if self._lasting and not self._tracks.present[0].all():
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
        return (len(self.motion.table) - 1) / RATE

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
        wanted = min((math.floor(until) + 1 + _FARTHEST) * RATE + 1, len(self.motion.table))
        if wanted <= self._tracks.ready:
            return
        if not self._end.alive:
            raise ConfigError(
                f"traffic.source: the live traffic was closed at {self.ahead:g} s, but {until:g} s "
                "was asked for"
            )
        self._drive(min(wanted + self._tracks.ahead, len(self.motion.table)))

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
        everything = ready == len(self.motion.table)
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
        self.motion.table[rows, : self._vehicles] = table_of(tracks.rows(rows), self._terrain)


def _check_alone() -> None:
    """Refuse a second live world; one that nobody uses any more is ended."""
    gc.collect()
    other = _running() if _running is not None else None
    if other is not None and other._end.alive:
        raise ConfigError(
            "traffic.source: 'live' is in use in this process already, and libsumo runs one "
            "simulation in a process; close the other one, or use 'recorded'"
        )
