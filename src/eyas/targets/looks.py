"""Random choice of a model and a colour for each actor."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.targets.catalogue import KINDS, models_of
from eyas.targets.kind import Colour

__all__ = ["LookSampler"]


class _Choice(NamedTuple):
    """Possible looks of the actors of one kind."""

    actors: NDArray[np.intp]
    """Indices of the actors, shape (G,)."""
    models: NDArray[np.int32]
    """Models of the kind, as indices into `MODELS`."""
    colours: NDArray[np.float32]
    """Colours to draw from, sRGB 0 to 1, shape (., 3)."""
    fixed: Colour | None
    """Colour of all actors; None: drawn."""


class LookSampler:
    """Draws the looks of A actors.

    Args:
        kind: Kind of each actor, index into `KINDS`, shape (A,).
        colour: Colour of all actors except those of kinds that keep their colours, sRGB 0 to 1;
            None: drawn.
    """

    def __init__(self, kind: NDArray[np.int32], colour: Colour | None = None) -> None:
        self._count = len(kind)
        self._choices = [
            _Choice(
                actors=np.flatnonzero(kind == k),
                models=np.array(models_of(k), np.int32),
                colours=np.array(KINDS[k].colours, np.float32),
                fixed=None if KINDS[k].keeps_colours else colour,
            )
            for k in sorted({*kind.tolist()})
        ]

    def sample(self, rng: np.random.Generator) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Draw the model and colour of each actor, kind by kind.

        Both are uniform, over the models and over the colours of the kind. The same draws are made
        whether or not the colour is fixed, so fixing it changes no model.

        Args:
            rng: Random stream of this room.

        Returns:
            Index into `MODELS`, shape (A,), and sRGB colour, shape (A, 3).
        """
        model, colour = np.empty(self._count, np.int32), np.empty((self._count, 3), np.float32)
        for choice in self._choices:
            actors, count = choice.actors, len(choice.actors)
            model[actors] = choice.models[rng.integers(len(choice.models), size=count)]
            colour[actors] = choice.colours[rng.integers(len(choice.colours), size=count)]
            if choice.fixed is not None:
                colour[actors] = choice.fixed
        return model, colour
