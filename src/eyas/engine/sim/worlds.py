"""The worlds of N trackers: which tracker is in which, and models and colours of the actors."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.poses import Moving
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.views.near_lights import NearLights
from eyas.engine.sim.views.visible_actors import VisibleActors
from eyas.engine.state.draw import DrawList
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ACTOR_OBJECT, DRONE_CLASS
from eyas.engine.state.snapshot import CameraState
from eyas.engine.targets.catalogue import KINDS
from eyas.engine.targets.kind import HIDDEN, Colour, Looks
from eyas.engine.targets.looks import LookSampler
from eyas.engine.traffic.interpolation import sample_before
from eyas.lanes import interpreted

Integers = NDArray[np.int64]

_sample_before = interpreted(sample_before)


ALONE = -1
"""World number of a tracker with a world of its own, which starts again with each episode."""


def each_alone(count: int) -> NDArray[np.int32]:
    """Return world numbers for trackers that each have a world of their own, shape (N,)."""
    return np.full(count, ALONE, np.int32)


def together(count: int) -> NDArray[np.int32]:
    """Return world numbers for trackers that are all in one world, shape (N,)."""
    return np.zeros(count, np.int32)


def largest_world(world_of: NDArray[np.integer]) -> int:
    """Return the largest number of trackers that share a world; see `Worlds` for `world_of`."""
    shared = np.asarray(world_of)[np.asarray(world_of) != ALONE]
    return int(np.unique(shared, return_counts=True)[1].max(initial=1))


class Worlds:
    """The worlds around N trackers. All trackers of a world see the same traffic at one time.

    Attributes:
        of: World of each tracker, shape (N,).
        leader: First tracker of each world, shape (W,): its random streams are the world's.
        lasting: Whether the time of each world continues when an episode ends, shape (W,).
        looks: Models and colours of the actors in all W worlds; they change in place.
        look_table: What these are sampled from.
        stand_in: Recorded actor as whom each actor is drawn, shape (A,).

    Args:
        config: The settings.
        assets: Map and traffic.
        world_of: A number for each tracker, shape (N,): those with the same number share a world,
            whose time continues from episode to episode; `ALONE` for a world of its own.

    Raises:
        ValueError: `world_of` is not a list of whole numbers from -1 up.
    """

    def __init__(self, config: SimConfig, assets: Assets, world_of: NDArray[np.integer]) -> None:
        given = np.asarray(world_of)
        if given.ndim != 1 or given.dtype.kind not in "iu" or (given < ALONE).any():
            raise ValueError("world_of: must hold one whole number, at least -1, for each tracker")
        # Worlds are numbered in the order of their first trackers.
        own = np.where(given == ALONE, given.max(initial=0) + 1 + np.arange(len(given)), given)
        _, first, numbered = np.unique(own, return_index=True, return_inverse=True)
        order = np.argsort(np.argsort(first, kind="stable"), kind="stable")
        self.of: NDArray[np.int32] = order[numbered].astype(np.int32)
        self.leader: Integers = np.sort(first)
        self.lasting: NDArray[np.bool_] = given[self.leader] != ALONE
        self._any_lasting = bool(self.lasting.any())
        self._members = [np.flatnonzero(self.of == world) for world in range(len(first))]
        self._assets = assets
        # Targets that are moved have the looks of those whose places they take.
        known = getattr(assets.traffic, "own", None)
        kinds = assets.traffic.motion.kind[:known]
        self.look_table = LookSampler(kinds, config.traffic.colour).table
        worlds, actors = len(self.leader), assets.traffic.actors
        self.stand_in = np.arange(actors)
        self.looks = Looks(
            np.zeros((worlds, actors), np.int32), np.ones((worlds, actors, 3), np.float32)
        )

    @cached_property
    def _near(self) -> VisibleActors:
        """Lists the actors of a picture; made with the first one, as it needs the renderer."""
        assets, lights = self._assets, None
        far = assets.renderer.part_reach()
        reach = assets.renderer.influence(assets.rigs.reach(far))
        if assets.signals is not None:
            lights = NearLights(assets.signals, float(far[assets.signals.first_part :].max()))
        wet = assets.lighting.spray > 0.0
        known = getattr(assets.traffic, "own", None)
        return VisibleActors(
            assets.traffic.motion,
            assets.rigs,
            self.looks,
            reach,
            spray=wet,
            lights=lights,
            stand_in=None if known is None else self.stand_in,
            known=known or 0,
        )

    @property
    def models(self) -> NDArray[np.int32]:
        """Model of each actor in each world, index into the catalogue, shape (W, A); it changes in
        place.
        """
        return self.looks.model

    @property
    def actors(self) -> int:
        """Number of actors in each world."""
        return self._assets.traffic.actors

    def trackers_of(self, tracker: int) -> Integers:
        """Return all trackers in the world of a tracker, shape (K,)."""
        return self._members[int(self.of[tracker])]

    def make_alike(self, tracker: int, actor: int) -> None:
        """Give all actors of an actor's kind around a tracker the model and colour of that one."""
        world, kinds = self.of[tracker], self._assets.traffic.motion.kind
        same = kinds == kinds[actor]
        self.looks.model[world, same] = self.looks.model[world, actor]
        self.looks.colour[world, same] = self.looks.colour[world, actor]

    def dress(self, tracker: int, actor: int, model: int, colour: Colour) -> None:
        """Give an actor around a tracker a model of its kind and a colour, until looks are sampled.

        Args:
            tracker: The tracker.
            actor: The actor.
            model: Index into `eyas.engine.targets.catalogue.MODELS`.
            colour: sRGB, each 0 to 1.
        """
        world = self.of[tracker]
        self.looks.model[world, actor], self.looks.colour[world, actor] = model, colour

    def copy_looks(self, tracker: int, source: int) -> None:
        """Give the actors around a tracker the looks of those around another one."""
        for looks in self.looks:
            looks[self.of[tracker]] = looks[self.of[source]]

    def model_of(self, tracker: int, actor: int) -> int:
        """Return the model of an actor around a tracker, an index into the catalogue."""
        return int(self.looks.model[self.of[tracker], actor])

    def looks_around(self, tracker: int) -> Looks:
        """Return the looks of all actors around a tracker, one world; they may change."""
        world = self.of[tracker]
        return Looks(self.looks.model[world : world + 1], self.looks.colour[world : world + 1])

    def classes_of(self, objects: NDArray[np.integer]) -> Integers:
        """Return the `ObjectClass` of objects and actors, -1 for the id -1, and `DRONE_CLASS` for
        the bodies of trackers, shape (K,).
        """
        static, kinds = self._assets.scene.object_class, self._assets.traffic.motion.kind
        moving = np.array([KINDS[kind].object_class for kind in kinds.tolist()], np.int64)
        classes = np.full(len(objects), -1, np.int64)
        still, actor = (objects >= 0) & (objects < ACTOR_OBJECT), objects - ACTOR_OBJECT
        moves = (actor >= 0) & (actor < len(moving))
        classes[still] = static[objects[still]]
        classes[moves] = moving[actor[moves]]
        classes[actor >= len(moving)] = DRONE_CLASS
        return classes

    def object_ids(self, actors: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return the object ids of actors."""
        return np.add(actors, ACTOR_OBJECT, dtype=np.int32)

    def actors_around(self, tracker: int, tick: int) -> tuple[ActorState, NDArray[np.int32]]:
        """Return all actors around a tracker at a time, and their models, see `Looks`.

        Args:
            tracker: The tracker.
            tick: Time of its world in physics steps.
        """
        actors = ActorState.create(1, self._assets.traffic.actors)
        self._assets.traffic.at(np.array([tick * PHYSICS_STEP]), actors)
        models = self.looks.model[self.of[tracker]]
        actors.present[0] &= models != HIDDEN
        return actors, models

    def lamps_around(
        self,
        tick: int,  # Time of a world in physics steps
    ) -> NDArray[np.uint8] | None:
        """Return what the actors signal at a time, a `Lamp` each, shape (A,); None: nobody does."""
        motion = self._assets.traffic.motion
        if not motion.lamps.size:
            return None
        lamps: NDArray[np.uint8] = motion.lamps[_sample_before(motion, tick * PHYSICS_STEP)]
        return lamps

    def draw_list(
        self,
        trackers: NDArray[np.integer],
        tick: Integers,
        cameras: CameraState,
        aspect: float,
        later: NDArray[np.float64] | None = None,
    ) -> tuple[NDArray[np.int32], DrawList]:
        """Return the row of each of V views in a list of moving parts, and that list.

        The list holds the actors that may matter in the views of their world, and is overwritten
        by the next call.

        Args:
            trackers: The tracker whose world each view shows, shape (V,).
            tick: Time of all N trackers in physics steps, shape (N,).
            cameras: The V cameras.
            aspect: Height of what they show over its width.
            later: How long after that time each view is [s], shape (V,); None: all are at it.
        """
        worlds, rows, time = self._at(trackers, tick, later)
        movers = self._near.of(worlds, time, rows, cameras, aspect)
        rows = np.arange(len(trackers)) if rows is None else rows
        return rows.astype(np.int32), movers

    def moving(
        self, trackers: NDArray[np.integer], tick: Integers, cameras: CameraState, aspect: float
    ) -> Moving:
        """Return the motion of the actors in the list of `draw_list`; the same arguments."""
        worlds, rows, time = self._at(trackers, tick, None)
        return self._near.moving(worlds, time, rows, cameras, aspect)

    def _at(
        self, trackers: NDArray[np.integer], tick: Integers, later: NDArray[np.float64] | None
    ) -> tuple[NDArray[np.integer], NDArray[np.integer] | None, NDArray[np.float64]]:
        """Return worlds, which of them each view shows (None: its own), and their times [s]."""
        worlds, rows = self.of[trackers], None
        if self._any_lasting and later is None:
            if len(self._members) == 1:
                worlds, rows = np.zeros(1, np.int32), np.zeros(len(trackers), np.int64)
            else:
                worlds, rows = np.unique(worlds, return_inverse=True)
        time = tick[self.leader[worlds]].astype(np.float64) * PHYSICS_STEP
        return worlds, rows, time if later is None else time + later
