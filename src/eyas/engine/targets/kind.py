"""Interface between a kind of target and the other rooms."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.habit import Habit

Colour = tuple[float, float, float]  # sRGB, each 0 to 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """One model of a kind, such as one make of car: all that is known of it."""

    name: str  # The original's name of the model; for others, one that no other has
    typename: str  # The original's `typename` of a target of this model, which packets tell
    kind: str  # Name of its kind
    size: tuple[float, float, float]  # Length, width and height, standing, without antennas [m]
    rise: float  # Height of the reference point above the ground [m]
    words: tuple[str, ...]
    """Phrases that describe it, from short to long, "a {} car": `{}` is the name of its colour.
    One that is true of two models is a phrase of both: none that holds for others in view tells a
    target."""
    motion: str  # How it usually moves, in words
    speed: float  # A usual speed [m/s]
    stride: float  # Distance after which its motion repeats [m]: a stride, or a turn of its wheels
    mass: float | None = None  # [kg]; None: not known

    @property
    def length(self) -> float:
        """Overall length [m]."""
        return self.size[0]

    @property
    def width(self) -> float:
        """Overall width, of vehicles with mirrors [m]."""
        return self.size[1]

    @property
    def height(self) -> float:
        """Overall height [m]."""
        return self.size[2]

    def check(self) -> None:
        """Raise a `ConfigError` if something is missing or cannot be."""
        if not self.words or not all(map(str.strip, self.words)):
            raise ConfigError(
                f"targets: {self.name!r} has no words; allowed: phrases like 'a {{}} car'"
            )
        if not all(side > 0.0 for side in self.size):
            raise ConfigError(f"targets: {self.name!r} is {self.size} m; allowed: above 0")


class Solid(NamedTuple):
    """An upright box on the ground."""

    ahead: float
    """Distance of its middle ahead of that of the vehicle when it drives straight on [m]."""
    size: tuple[float, float, float]  # Length, width and height [m]


class Section(NamedTuple):
    """A rigid part of an articulated vehicle, and the upright box around it."""

    name: str  # "truck" or "trailer"
    ahead: float  # See `Solid`
    size: tuple[float, float, float]  # See `Solid`
    towed: int  # 1 for a trailer, 0 for what pulls it, see `eyas.engine.traffic.trailer.folded`.
    blocks: tuple[Solid, ...]  # What is solid of it


HIDDEN = -1
"""Model of an actor that is in the table of motion, but not in a world, see
`eyas.engine.sim.evader_traffic`."""


class Group(NamedTuple):
    """The G actors of one kind, and their slots in a draw list; kernels read it."""

    actor: NDArray[np.int64]  # Indices of the actors, shape (G,)
    slot: NDArray[np.int64]
    """First slot of each actor, shape (G,); `Rig.slots` is the number of its slots."""
    first_part: int  # Index of the kind's first part in the part library
    first_model: int  # Index of the kind's first model in `eyas.engine.targets.catalogue.MODELS`.


class Looks(NamedTuple):
    """Models and colours of A actors in each of W worlds."""

    model: NDArray[np.int32]
    """Index into `eyas.engine.targets.catalogue.MODELS`, shape (W, A); a model of the actor's
    kind.
    """
    colour: NDArray[np.float32]  # Body colours, sRGB 0 to 1, shape (W, A, 3)


class Rig(Protocol):
    """The parts of a kind's models, and the function that poses them."""

    @property
    def slots(self) -> int:
        """Number of draw list slots that each actor needs, the same for all models."""
        ...

    @property
    def part_count(self) -> int:
        """Total number of parts of all models."""
        ...

    def part_levels(self) -> Sequence[tuple[Mesh, ...]]:
        """Return the meshes of each part, the finest first, in the part's own frame."""
        ...

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of an actor may be from its reference point [m].

        Args:
            parts: How far the points of each part are from the part's origin, at most [m], shape
                (part_count,).
        """
        ...

    def pose(self, group: Group, actors: ActorState, looks: Looks, out: DrawList) -> None:
        """Write part, pose and colour of all slots of the kind's actors, in all worlds.

        Unused slots and slots of absent actors get part -1.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class KindFacts:
    """What distinguishes a kind of target, but for how it is drawn."""

    name: str  # Name of the kind; for vehicles SUMO's class
    models: tuple[Model, ...]  # At least one model
    colours: tuple[Colour, ...]  # Body colours to draw from for each actor
    object_class: ObjectClass  # Class of its pixels
    ahead: float = 0.0
    """Distance of the middle, the point that the reward uses, ahead of the reference point [m]."""
    slowest: float = 0.01  # Speed below which it counts as standing [m/s]
    lamps: bool = False  # Whether it has head and tail lamps that light the road
    trailers: tuple[int, ...] = ()
    """Parts of its rig that are towed: they have shadows of their own, and no lamps."""
    sections: tuple[tuple[Section, ...], ...] = ()
    """Of each model what it consists of, if that is not one rigid body."""
    keeps_colours: bool = False
    """Whether `traffic.colour` does not change its colours, as for the original's motorcycles."""
    habit: Habit | None = None  # How it moves off the traffic by itself; None: it cannot


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind(KindFacts):
    """A kind of target: everything that distinguishes it from other kinds."""

    rig: Callable[[], Rig]  # Returns the rig of all its models
    flies: bool = False
    """Whether the reward uses the level plane through it, and not the ground below it."""
    extent: Callable[[str, float, float], NDArray[np.float64]] | None = None
    """Returns the box of a model at a moment, by its name, the way that it has travelled along the
    ground [m] and its speed [m/s]: least and largest x, y and z in the model frame [m], shape
    (2, 3). None: it is always that of its size."""
