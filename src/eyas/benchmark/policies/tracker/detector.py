"""The network of the tracker: where in a picture is this target, if it is seen at all?

An ONNX file with the inputs

- `image`, uint8, (N, 3, H, W);
- `expected`, float32, (N, 2): where the target should be, column and row [pixels];
- `spread`, float32, (N, 1): standard deviation of that [pixels];
- `key`, float32, (N, K): how the target looked, 0 if that is unknown; `known`, (N, 1): 1 or 0;
- `past`, float32, (N, 21): how it has moved of late, see `Course`

and the outputs, of C cells of the picture,

- `scores`, float32, (N, C + 1): logarithms of unnormalised probabilities that the target is in a
  cell, and last that it is not seen;
- `places`, float32, (N, C, 3): where in the picture it is then, column, row, and the logarithm of
  the standard deviation of both [pixels];
- `keys`, float32, (N, C, K): how it looks then;
- `ahead`, float32, (N, 7, 3): where that motion leads, see `Course`.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

Floats = NDArray[np.float64]
Session = Any  # onnxruntime has no types

OUTPUTS = ("scores", "places", "keys", "ahead")
STRIDE = 4  # Side of a cell [pixels]
_NEAR = 2  # Cells around the best one that are the same target
_LEAST = np.finfo(np.float64).tiny  # Belief that is as good as none


class TargetPrior(NamedTuple):
    """What is known of N targets before a picture is seen."""

    expected: Floats  # Column and row [pixels], shape (N, 2)
    spread: Floats  # Standard deviation of both [pixels], shape (N,)
    key: NDArray[np.float32]  # Shape (N, K)
    known: NDArray[np.bool_]  # Whether there is a key, shape (N,)
    past: NDArray[np.float32]  # How each has moved of late, shape (N, 21)


class TargetDetection(NamedTuple):
    """What N pictures show."""

    place: Floats
    """Mean place around the most probable one, if the target is seen, column and row [pixels],
    shape (N, 2)."""
    spread: Floats
    """Standard deviation of both, the network's own and that of the cells [pixels], (N,)."""
    belief: Floats  # Probability that it is there, shape (N,)
    key: NDArray[np.float32]  # How it looks, shape (N, K)
    ahead: NDArray[np.float32]  # Where its motion leads, shape (N, 7, 3)


class Detector:
    """The network.

    Args:
        size: Height and width of the pictures [pixels].
    """

    def __init__(self, session: Session, size: tuple[int, int]) -> None:
        self._session = session
        shapes = {each.name: each.shape for each in session.get_inputs()}
        self.keys: int = shapes["key"][1]
        down, across = np.indices((-(-size[0] // STRIDE), -(-size[1] // STRIDE)))
        self._cells = np.stack((across.ravel(), down.ravel()), axis=-1)

    @staticmethod
    def fits(session: Session) -> bool:
        """Return whether a session is one of such a network."""
        return "expected" in {each.name for each in session.get_inputs()}

    @staticmethod
    def foresees(session: Session) -> bool:
        """Return whether such a network says where targets will be that are not seen."""
        return "past" in {each.name for each in session.get_inputs()}

    def find(self, pictures: NDArray[np.uint8], clue: TargetPrior) -> TargetDetection:
        """Find targets."""
        feed = {
            "image": pictures,
            "expected": clue.expected.astype(np.float32),
            "spread": clue.spread.astype(np.float32)[:, None],
            "key": clue.key,
            "known": clue.known.astype(np.float32)[:, None],
            "past": clue.past,
        }
        scores, places, keys, ahead = self._session.run(OUTPUTS, feed)
        scores = scores.astype(np.float64)
        shares = np.exp(scores - scores.max(axis=1, keepdims=True))
        shares /= shares.sum(axis=1, keepdims=True)
        best = shares[:, :-1].argmax(axis=1)
        # A second candidate elsewhere takes from the belief in the best one.
        apart = np.abs(self._cells[None] - self._cells[best][:, None]).max(axis=-1)
        around = shares[:, :-1] * (apart <= _NEAR)
        belief = around.sum(axis=1)
        # Of a target far out of view all shares may be 0; what is found then is not believed.
        around /= np.maximum(belief, _LEAST)[:, None]
        place, spread = _moments(around, places.astype(np.float64))
        return TargetDetection(place, spread, belief, keys[np.arange(len(best)), best], ahead)


def _moments(
    shares: Floats,  # Of the cells, which add up to 1, shape (N, C)
    places: Floats,  # Output of the network, shape (N, C, 3)
) -> tuple[Floats, Floats]:
    """Return the mean of places, (N, 2), and its standard deviation in each axis, (N,).

    Of a target that is half hidden the cells disagree, each surer of its own place than it may be.
    """
    where = places[..., :2]
    mean = (shares[..., None] * where).sum(axis=1)
    away = 0.5 * np.square(where - mean[:, None]).sum(axis=-1)
    variance = (shares * (away + exact.exp(2.0 * places[..., 2]))).sum(axis=1)
    return mean, np.sqrt(variance)
