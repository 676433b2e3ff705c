"""The network of the listener: which vehicles does a picture from above show, and how do they look?

An ONNX file with the input

- `image`, uint8, (N, 3, H, W)

and the outputs, of C cells of the picture, of `STRIDE` x `STRIDE` pixels each,

- `vehicles`, float32, (N, C): logarithm of the odds that the middle of a vehicle is in a cell;
- `places`, float32, (N, C, 2): where it is then, column and row [pixels];
- `headings`, float32, (N, C, 4): how it lies then: the direction in which it heads, column and
  row, and the same of twice the angle, which does not tell front from back;
- `colours`, float32, (N, C, 22), and `bodies`, float32, (N, C, 9): logarithms of unnormalised
  probabilities of the words in `NAMES` and `BODIES`.
"""

from functools import cache
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.targets.catalogue import MODELS
from eyas.engine.targets.colour_names import COLOUR_NAMES
from eyas.engine.targets.grammar.in_view import BodyWord, body_of
from eyas.lanes import exact

Floats = NDArray[np.float64]
Session = Any  # onnxruntime has no types

OUTPUTS: Final = ("vehicles", "places", "headings", "colours", "bodies")
STRIDE: Final = 4  # Side of a cell [pixels]
NAMES: Final = tuple(
    COLOUR_NAMES
)  # Names of colours; index into `colours`, order: shipped networks

BODIES: Final = (
    BodyWord.SEDAN,
    BodyWord.SUV,
    BodyWord.HATCHBACK,
    BodyWord.SMALL_CAR,
    BodyWord.VAN,
    BodyWord.BUS,
    BodyWord.TRUCK,
    BodyWord.MOTORCYCLE,
    BodyWord.BICYCLE,
)
"""Words of all that drives on roads; index into `bodies` (order: shipped networks have it)."""

_LEAST: Final = -1.4  # Least logarithm of the odds of a vehicle: a fifth

_APART: Final = 0.8, 1.5
"""Two vehicles' middles are at least so far apart, as shares of half the length and half the width
of one of them."""


class Detections(NamedTuple):
    """The D vehicles that a picture shows, the surest first."""

    belief: Floats  # Probability that it is one, shape (D,)
    place: Floats  # Column and row [pixels], shape (D, 2)
    heading: Floats  # Output `headings`, shape (D, 4)
    colour: Floats  # Logarithms of probabilities of `NAMES`, shape (D, 22)
    body: Floats  # Logarithms of probabilities of `BODIES`, shape (D, 9)


class VehicleDetector:
    """The network."""

    def __init__(self, session: Session, scale: float) -> None:
        self._session, self._scale = session, scale

    @staticmethod
    def fits(session: Session) -> bool:
        """Return whether a session is one of such a network."""
        return "vehicles" in {each.name for each in session.get_outputs()}

    def find(self, pictures: NDArray[np.uint8]) -> list[Detections]:
        """Return what N pictures show."""
        answers = self._session.run(OUTPUTS, {"image": pictures})
        vehicles, *rest = answers
        return [
            self._peaks(vehicles[row], tuple(part[row] for part in rest))
            for row in range(len(pictures))
        ]

    def _peaks(
        self, vehicles: NDArray[np.float32], rest: tuple[NDArray[np.float32], ...]
    ) -> Detections:
        """Return the vehicles in a picture: of cells that mean the same one, the surest."""
        cells = np.flatnonzero(vehicles > _LEAST)
        cells = cells[np.argsort(-vehicles[cells], kind="stable")]
        places, headings, colours, bodies = (part[cells].astype(np.float64) for part in rest)
        found = Detections(
            1.0 / (1.0 + exact.exp(-vehicles[cells].astype(np.float64))),
            places,
            headings,
            shares(colours),
            shares(bodies),
        )
        same = self._same(found)
        kept: list[int] = []
        for row in range(len(cells)):
            if not same[row, kept].any():
                kept.append(row)
        return Detections(*(part[kept] for part in found))

    def _same(self, found: Detections) -> NDArray[np.bool_]:
        """Return which would overlap which if both were there, shape (D, D)."""
        sizes = self._scale * exact.product(exact.exp(found.body), body_sizes())
        axis = 0.5 * exact.atan2(found.heading[:, 3], found.heading[:, 2])
        column, row = exact.cos(axis), exact.sin(axis)
        away = found.place[:, None] - found.place
        along = np.abs(away[..., 0] * column + away[..., 1] * row)
        across = np.abs(away[..., 1] * column - away[..., 0] * row)
        half = 0.5 * sizes
        same: NDArray[np.bool_] = (along < _APART[0] * half[:, 0]) & (
            across < _APART[1] * half[:, 1]
        )
        return same


@cache
def body_sizes() -> Floats:
    """Return mean length and width of each of `BODIES` [m], shape (9, 2)."""
    found = []
    for body in BODIES:
        sizes = [model.size[:2] for k, model in enumerate(MODELS) if body_of(k) is body]
        found.append(np.mean(sizes, axis=0))
    return np.array(found)


def shares(
    scores: Floats,  # Such that are not normalised, shape (K, n)
) -> Floats:
    """Return logarithms of probabilities that add up to 1, shape (K, n)."""
    above = scores - scores.max(axis=1, keepdims=True, initial=-np.inf)
    found: Floats = above - exact.log(exact.exp(above).sum(axis=1, keepdims=True))
    return found
