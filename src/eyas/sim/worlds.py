"""The worlds of N trackers: one each or one for all; what moves in them and how it looks."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.rng import stream
from eyas.sim.config import SimConfig
from eyas.sim.place import Place
from eyas.state.draw import DrawList
from eyas.state.scene import ACTOR_OBJECT
from eyas.state.tracker import ActorState
from eyas.targets.looks import draw_looks

__all__ = ["Worlds"]


class Worlds:
    """What moves around each tracker.

    Attributes:
        shared: Whether all trackers are in one world.

    Args:
        config: The settings.
        place: Map and traffic.
        count: Number of trackers, N.
        shared: One world for all, or one for each.
    """

    def __init__(self, config: SimConfig, place: Place, count: int, *, shared: bool) -> None:
        self.shared = shared
        self._colour_of_all = config.traffic.colour
        self._place = place
        worlds, actors = (1 if shared else count), place.replay.actors
        self._model = np.zeros((worlds, actors), np.int32)
        self._colour = np.ones((worlds, actors, 3), np.float32)
        self._buffers: dict[int, tuple[ActorState, DrawList]] = {}

    def draw_looks(self, tracker: int, seed: int, episode: int) -> None:
        """Draw models and colours of the actors around a tracker; in a shared world once."""
        if self.shared and (tracker, episode) != (0, 0):
            return
        rng = stream(seed, "looks", tracker, episode)
        replay = self._place.replay
        vehicle_type = replay.recording.provenance.config.vehicle_type
        model, colour = draw_looks(rng, vehicle_type, replay.actors, self._colour_of_all)
        self._model[self._of(tracker)], self._colour[self._of(tracker)] = model, colour

    def model_of(self, tracker: int, actor: int) -> int:
        """Return which of `VEHICLES` an actor around a tracker is."""
        return int(self._model[self._of(tracker), actor])

    def object_ids(self, actors: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return the object ids of actors."""
        return (actors + ACTOR_OBJECT).astype(np.int32)

    def draw_list(
        self, trackers: NDArray[np.integer], tick: NDArray[np.int64]
    ) -> tuple[NDArray[np.int32], DrawList]:
        """Return the world of each of V trackers in a list of moving parts, and that list.

        The list is overwritten by the next call for as many worlds.

        Args:
            trackers: Which, shape (V,).
            tick: Time of all N trackers in physics steps, shape (N,).
        """
        if self.shared:
            rows, world = np.zeros(1, np.int64), np.zeros(len(trackers), np.int32)
        else:
            rows, world = np.asarray(trackers, np.int64), np.arange(len(trackers), dtype=np.int32)
        time = tick[rows].astype(np.float64) * PHYSICS_STEP
        actors, movers = self._buffer(len(rows))
        self._place.replay.at(time, actors)
        self._place.rigs.pose(actors, self._model[rows], self._colour[rows], movers)
        return world, movers

    def _buffer(self, worlds: int) -> tuple[ActorState, DrawList]:
        if worlds not in self._buffers:
            actors = self._place.replay.actors
            slots = actors * self._place.rigs.slots_per_actor
            pair = ActorState.create(worlds, actors), DrawList.create(worlds, slots)
            self._buffers[worlds] = pair
        return self._buffers[worlds]

    def _of(self, tracker: int) -> int:
        return 0 if self.shared else tracker
