"""When a target is lost and found again, from whether it is in the picture at each instant."""

from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAST_LOSS", "Watch", "watched"]

LEAST_LOSS = 0.5
"""Shortest time out of the picture that counts as a loss [s]."""


class Watch(TypedDict):
    """Fields of `eyas.evaluation.record.Record`."""

    found_after: float | None
    lost_after: float | None
    watched: float
    losses: int
    found_again: int
    search_time: float | None


def watched(in_view: NDArray[np.bool_], period: float, *, broken_off: bool) -> Watch:
    """Return when a target was found and lost.

    The time until the first loss begins when the target is first in the picture.

    Args:
        in_view: Whether the target is in the picture at each control step, shape (M,).
        period: Length of a control step [s].
        broken_off: Whether the episode has ended by a fault of the policy, which loses the target.
    """
    seen = np.flatnonzero(in_view)
    if not len(seen):
        return Watch(
            found_after=None,
            lost_after=None,
            watched=0.0,
            losses=0,
            found_again=0,
            search_time=None,
        )
    first, end = int(seen[0]), len(in_view)
    gaps = _gaps(in_view, first)
    least = round(LEAST_LOSS / period)
    lost = [(start, stop) for start, stop in gaps if stop - start >= least]
    found = [(start, stop) for start, stop in lost if stop < end]
    starts = [start for start, _ in lost]
    if broken_off and not (lost and lost[-1][1] == end):
        starts.append(end)
    until = starts[0] if starts else end
    return Watch(
        found_after=first * period,
        lost_after=(until * period if starts else None),
        watched=(until - first) * period,
        losses=len(starts),
        found_again=len(found),
        search_time=(
            float(np.mean([stop - start for start, stop in found])) * period if found else None
        ),
    )


def _gaps(in_view: NDArray[np.bool_], first: int) -> list[tuple[int, int]]:
    """Return start and end of each time out of the picture after `first`."""
    out = np.concatenate(([False], ~in_view[first:], [False]))
    edges = np.flatnonzero(out[1:] != out[:-1]) + first
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
