"""From what a network answers to an action: the largest, or one sampled."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import stream


class Chooser:
    """Chooses actions of N episodes by their scores."""

    def __init__(self, *, sampled: bool) -> None:
        self._sampled = sampled

    def begin(self, seeds: NDArray[np.int64]) -> None:
        """Begin the random numbers of each episode."""
        self._streams = [stream(seed, "policy") for seed in seeds.tolist()]

    def of(self, scores: NDArray[np.floating], deciding: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Return an action of each; random numbers are sampled for those who decide.

        Args:
            scores: Logarithms of unnormalised probabilities, shape (N, A).
            deciding: Who decides, shape (N,).
        """
        chosen: NDArray[np.int64] = scores.argmax(axis=1)
        if self._sampled:
            weights = np.exp(scores.astype(np.float64) - scores.max(axis=1, keepdims=True))
            shares = np.cumsum(weights, axis=1) / weights.sum(axis=1, keepdims=True)
            for row in np.flatnonzero(deciding).tolist():
                sampled = np.searchsorted(shares[row], self._streams[row].random(), side="right")
                chosen[row] = min(int(sampled), scores.shape[1] - 1)
        return chosen
