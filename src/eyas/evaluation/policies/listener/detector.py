"""The network of the listener: which vehicles does a picture from above show, and how do they look?

An ONNX file with the input

- `image`, uint8, (N, 3, H, W)

and the outputs, of C cells of the picture, of `STRIDE` x `STRIDE` pixels each,

- `vehicles`, float32, (N, C): logarithm of the odds that the middle of a vehicle is in a cell;
- `places`, float32, (N, C, 2): where it is then, column and row [pixels];
- `headings`, float32, (N, C, 4): how it lies then: mean direction in which it heads, column and row,
  and the same of twice the angle, which does not tell front from back;
- `colours`, float32, (N, C, 22), and `bodies`, float32, (N, C, 9): logarithms of unnormalised
  probabilities of the words in `NAMES` and `BODIES`.
"""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.targets.colour_names import COLOUR_NAMES
from eyas.targets.grammar.in_view import BodyWord

__all__ = ["BODIES", "NAMES", "OUTPUTS", "STRIDE", "Detections", "VehicleDetector"]

Floats = NDArray[np.float64]

OUTPUTS: Final = ("vehicles", "places", "headings", "colours", "bodies")

STRIDE: Final = 4
"""Side of a cell [pixels]."""

NAMES: Final = tuple(COLOUR_NAMES)
"""Of colours."""

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
"""Own words of all that drives on roads."""

_LEAST: Final = -1.4
"""Least logarithm of the odds of a vehicle: a fifth."""

_APART: Final = 5.0
"""Two vehicles' middles are at least so far apart [pixels]."""


class Detections(NamedTuple):
    """The D vehicles that a picture shows, the surest first."""

    belief: Floats
    """Probability that it is one, shape (D,)."""
    place: Floats
    """Column and row [pixels], shape (D, 2)."""
    heading: Floats
    """As the output, shape (D, 4)."""
    colour: Floats
    """Logarithms of probabilities of `NAMES`, shape (D, 22)."""
    body: Floats
    """Logarithms of probabilities of `BODIES`, shape (D, 9)."""


class VehicleDetector:
    """The network.

    Args:
        session: Of onnxruntime.
    """

    def __init__(self, session: Any) -> None:  # noqa: ANN401  # no types
        self._session = session

    @staticmethod
    def fits(session: Any) -> bool:  # noqa: ANN401  # the same
        """Return whether a session is one of such a network."""
        return "vehicles" in {each.name for each in session.get_outputs()}

    def find(self, pictures: NDArray[np.uint8]) -> list[Detections]:
        """Return what N pictures show.

        Args:
            pictures: Shape (N, 3, H, W).
        """
        answers = self._session.run(OUTPUTS, {"image": pictures})
        return [_peaks(*(part[row] for part in answers)) for row in range(len(pictures))]


def _peaks(
    vehicles: NDArray[np.float32],
    places: NDArray[np.float32],
    headings: NDArray[np.float32],
    colours: NDArray[np.float32],
    bodies: NDArray[np.float32],
) -> Detections:
    """Return the vehicles in a picture: of cells that mean the same one, the surest."""
    cells = np.flatnonzero(vehicles > _LEAST)
    cells = cells[np.argsort(-vehicles[cells], kind="stable")]
    where = places[cells].astype(np.float64)
    near = np.square(where[:, None] - where).sum(axis=-1) < _APART * _APART
    kept: list[int] = []
    for row in range(len(cells)):
        if not near[row, kept].any():
            kept.append(row)
    cells = cells[kept]
    return Detections(
        1.0 / (1.0 + np.exp(-vehicles[cells].astype(np.float64))),
        where[kept],
        headings[cells].astype(np.float64),
        _shares(colours[cells]),
        _shares(bodies[cells]),
    )


def _shares(scores: NDArray[np.float32]) -> Floats:
    """Return logarithms of probabilities, shape (D, K)."""
    above = scores.astype(np.float64) - scores.max(axis=1, keepdims=True, initial=-np.inf)
    shares: Floats = above - np.log(np.exp(above).sum(axis=1, keepdims=True))
    return shares
