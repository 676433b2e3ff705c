"""Random choice of a model and a colour for each actor."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.targets.catalogue import KINDS, models_of
from eyas.engine.targets.kind import Colour
from eyas.lanes import kernel
from eyas.lanes.pcg64 import whole


class LookTable(NamedTuple):
    """Possible looks of A actors, G kinds one after the other."""

    actors: NDArray[np.int64]  # The actors kind by kind, shape (A,)
    models: NDArray[np.int32]  # The models of all kinds, as indices into `MODELS`
    colours: NDArray[np.float32]  # The colours of all kinds, sRGB 0 to 1, shape (., 3).
    first: NDArray[np.int64]
    """Where each kind begins in `actors`, `models` and `colours`, and at last their lengths,
    shape (G + 1, 3)."""
    fixed: NDArray[np.bool_]  # Whether the actors of each kind have one colour, shape (G,)
    colour: NDArray[np.float32]  # That colour, shape (3,)


@kernel
def sample_looks(
    table: LookTable,  # The possible looks
    model: NDArray[np.int32],  # Index of each into `MODELS`, shape (A,); written
    colour: NDArray[np.float32],  # sRGB colour of each, shape (A, 3); written
    state: NDArray[np.int64],  # The random stream, see `eyas.lanes.pcg64`
) -> None:
    """Sample the looks of all actors, those that `LookSampler.sample` would return."""
    actors, first = table.actors, table.first
    for kind in range(len(table.fixed)):
        begin, end = first[kind, 0], first[kind + 1, 0]
        models, colours = first[kind, 1], first[kind, 2]
        for at in range(begin, end):
            pick = whole(state, first[kind + 1, 1] - models)
            model[actors[at]] = table.models[models + pick]
        for at in range(begin, end):
            pick = whole(state, first[kind + 1, 2] - colours)
            for channel in range(3):
                sampled = table.colours[colours + pick, channel]
                own = table.colour[channel] if table.fixed[kind] else sampled
                colour[actors[at], channel] = own


class _Choice(NamedTuple):
    """Possible looks of the actors of one kind."""

    actors: NDArray[np.intp]  # Indices of the actors, shape (G,)
    models: NDArray[np.int32]  # Models of the kind, as indices into `MODELS`
    colours: NDArray[np.float32]  # Colours to sample from, sRGB 0 to 1, shape (., 3).
    fixed: Colour | None  # Colour of all actors; None: sampled


class LookSampler:
    """Draws the looks of A actors.

    Args:
        kind: Kind of each actor, index into `KINDS`, shape (A,).
        colour: Colour of all actors except those of kinds that keep their colours, sRGB 0 to 1;
            None: sampled.
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

    @property
    def table(self) -> LookTable:
        """The possible looks as kernels read them."""
        parts = [(choice.actors, choice.models, choice.colours) for choice in self._choices]
        first = np.cumsum([(0, 0, 0), *([len(part) for part in row] for row in parts)], axis=0)
        actors, models, colours = map(np.concatenate, zip(*parts, strict=True))
        fixed = [choice.fixed for choice in self._choices]
        colour = next((one for one in fixed if one is not None), (0.0, 0.0, 0.0))
        return LookTable(
            actors.astype(np.int64),
            models,
            colours,
            first.astype(np.int64),
            np.array([one is not None for one in fixed]),
            np.array(colour, np.float32),
        )

    def sample(self, rng: np.random.Generator) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Sample the model and colour of each actor, kind by kind.

        Both are uniform, over the models and over the colours of the kind. The same samples are
        taken whether or not the colour is fixed, so fixing it changes no model.

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
