"""Which model and which colour each actor has."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.targets.catalogue import BODY_COLOURS, KINDS, MOTORCYCLE_COLOURS, models_of
from eyas.traffic.config import VehicleType

__all__ = ["Looks"]


class _Group(NamedTuple):
    """The actors of one kind."""

    actors: NDArray[np.intp]
    """Which, shape (G,)."""
    models: NDArray[np.int32]
    """Of the kind, index into `VEHICLES`."""
    colours: NDArray[np.float32]
    """To draw from, sRGB 0 to 1, shape (., 3)."""
    keeps_colours: bool
    """Whether a colour that is given for all does not hold for these."""


class Looks:
    """Draws the looks of A actors.

    Args:
        kind: What each actor is, index into `KINDS`, shape (A,).
        colour: Colour of all, sRGB 0 to 1, or None. As in the original it does not hold for
            motorcycles.
    """

    def __init__(
        self, kind: NDArray[np.int32], colour: tuple[float, float, float] | None = None
    ) -> None:
        self._count, self._colour = len(kind), colour
        self._groups = [_group(int(k), np.flatnonzero(kind == k)) for k in np.unique(kind)]

    def sample(self, rng: np.random.Generator) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Draw model and colour of each actor, kind by kind.

        The model is uniform among those of the kind, the colour uniform among the original's. The
        same draws are made whether or not the colour is fixed, so fixing it changes no model.

        Args:
            rng: Stream of this room.

        Returns:
            Index into `VEHICLES`, shape (A,), and sRGB colour, shape (A, 3).
        """
        model, colour = np.empty(self._count, np.int32), np.empty((self._count, 3), np.float32)
        for group in self._groups:
            count = len(group.actors)
            model[group.actors] = group.models[rng.integers(len(group.models), size=count)]
            colour[group.actors] = group.colours[rng.integers(len(group.colours), size=count)]
            if self._colour is not None and not group.keeps_colours:
                colour[group.actors] = self._colour
        return model, colour


def _group(kind: int, actors: NDArray[np.intp]) -> _Group:
    two_wheeled = KINDS[kind] == VehicleType.MOTORCYCLE
    colours = MOTORCYCLE_COLOURS if two_wheeled else BODY_COLOURS
    models = np.array(models_of(KINDS[kind]), np.int32)
    return _Group(actors, models, np.array(colours, np.float32), two_wheeled)
