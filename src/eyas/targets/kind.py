"""What the other rooms know of a kind of target, and what each kind brings along."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.state.draw import DrawList
from eyas.state.mesh import Mesh
from eyas.state.motion import ActorState
from eyas.state.scene import ObjectClass

__all__ = ["Colour", "Group", "Kind", "Looks", "Model", "Rig"]

Colour = tuple[float, float, float]
"""sRGB, each 0 to 1."""


class Model(Protocol):
    """One model of a kind, such as one make of car."""

    @property
    def name(self) -> str:
        """The original's name of the model."""
        ...

    @property
    def kind(self) -> str:
        """Name of its kind."""
        ...

    @property
    def size(self) -> tuple[float, float, float]:
        """Length, width and height [m]."""
        ...

    @property
    def rise(self) -> float:
        """Height of the reference point over the road [m]."""
        ...


class Group(NamedTuple):
    """The G actors of one kind, and where they are in a draw list."""

    actor: NDArray[np.int64]
    """Which actors, shape (G,)."""
    slot: NDArray[np.int64]
    """The first slot of each, shape (G,); it has as many as its kind needs."""
    first_part: int
    """Index of the kind's first part in the part library."""
    first_model: int
    """Index of the kind's first model in `eyas.targets.catalogue.MODELS`."""


class Looks(NamedTuple):
    """Models and colours of A actors in each of W worlds."""

    model: NDArray[np.int32]
    """Index into `eyas.targets.catalogue.MODELS`, of the actor's kind, shape (W, A)."""
    colour: NDArray[np.float32]
    """Body colours, sRGB 0 to 1, shape (W, A, 3)."""


class Rig(Protocol):
    """The parts of a kind's models, and the function that poses them."""

    @property
    def slots(self) -> int:
        """Slots of the draw list that an actor needs, whatever its model."""
        ...

    @property
    def part_count(self) -> int:
        """Number of parts of all models."""
        ...

    def part_levels(self) -> Sequence[tuple[Mesh, ...]]:
        """Return the meshes of each part, the finest first, in the part's own frame."""
        ...

    def pose(self, group: Group, actors: ActorState, looks: Looks, out: DrawList) -> None:
        """Write part, pose and colour of all slots of the kind's actors, in all worlds.

        A slot that is not used, or whose actor is absent, gets part -1.
        """
        ...


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of target: all that tells it from other kinds."""

    name: str
    """Of vehicles SUMO's class."""
    models: tuple[Model, ...]
    """At least one."""
    colours: tuple[Colour, ...]
    """Of which each actor has one."""
    object_class: ObjectClass
    """What its pixels are."""
    rig: Callable[[], Rig]
    """Returns the rig of all its models."""
    ahead: float = 0.0
    """How far the middle, which is what the reward looks for, lies ahead of the reference point
    [m]."""
    lamps: bool = False
    """Whether it has head and tail lamps that light the road."""
    keeps_colours: bool = False
    """Whether `traffic.colour` leaves its colours alone, as the original does for motorcycles."""
