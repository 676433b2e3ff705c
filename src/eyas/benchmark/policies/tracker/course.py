"""How targets have moved of late, and where that leads while they are not seen.

A filter knows how fast a target is, not that a car which has turned off slowly will speed up, or
that one in a bend goes on turning. The network does: it is told the motion of the last two seconds
as `past`, and answers with `ahead`, how far from a straight course the target will be.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]
Mask = NDArray[np.bool_]

LAGS = np.array((0.16, 0.32, 0.64, 1.28, 1.984))
"""Ages of the states in `past` [s] (order: input of shipped networks)."""

HORIZONS = np.array((0.256, 0.512, 0.768, 1.024, 1.536, 2.048, 3.072))
"""Times ahead of the forecast [s] (order: output `ahead` of shipped networks)."""

PAST = 1 + 4 * len(LAGS)
"""Numbers of `past`: the speed, then the velocity at each lag and the way since, all in the frame
of the present velocity [m/s, m]."""

_KEPT = 64  # States: two seconds of looks of 32 ms
_SLOWEST = 0.5  # Least speed of a target with a course [m/s]

_COVERED = 2.0
"""How long a target is followed as the network says [s]. One that is hidden for longer is below a
tunnel, a deck or a row of trees: had it turned off, it would have been seen."""

_STRAIGHTENING = 1.0  # How long it then takes until it is expected straight on [s]

_PACE = 2.0
"""How many times as fast it is expected from then on, until it is waited for: a drone that is ahead
of it sees it come out and pass; from one that is behind it drives away unseen."""


class Course:
    """The courses of N targets."""

    def __init__(self, count: int) -> None:
        self._now = np.zeros(count)
        self._noted = np.full((count, _KEPT), np.inf)
        """When the states were [s]; infinite: there is none."""
        self._states = np.zeros((count, _KEPT, 4))  # Place and velocity, east and north [m, m/s]
        self._next = np.zeros(count, np.int64)
        self.seen = np.full(count, np.nan)
        """When each was seen last with a course [s]; NaN: it has none."""
        self._from = np.zeros((count, 4))  # State at that time, shape (N, 4)
        self._ahead = np.full((count, len(HORIZONS), 3), np.nan)
        """What the network said of that; NaN: it was not asked yet."""
        self.past = np.zeros((count, PAST), np.float32)
        """What the network is told, see `PAST`, shape (N, 21)."""

    def forget(self, rows: Rows) -> None:
        """Forget what K targets did: they begin anew."""
        self._noted[rows] = np.inf
        self.leave(rows)

    def leave(self, rows: Rows) -> None:
        """Expect K targets no longer on their course."""
        self.seen[rows] = np.nan

    def pass_time(self, rows: Rows, time: Floats) -> None:
        """Let time pass [s], shape (K,)."""
        self._now[rows] += time

    def note(self, rows: Rows, place: Floats, velocity: Floats) -> None:
        """Note the states of K targets after a look, place and velocity of shape (K, 2)."""
        slot = self._next[rows] % _KEPT
        self._noted[rows, slot] = self._now[rows]
        self._states[rows, slot] = np.concatenate((place, velocity), axis=1)
        self._next[rows] += 1

    def set_out(self, rows: Rows) -> None:
        """Let the courses of K targets begin at their latest states: they were seen there."""
        latest = self._states[rows, (self._next[rows] - 1) % _KEPT]
        moves = _length(latest[:, 2:]) > _SLOWEST
        self.seen[rows] = np.where(moves, self._now[rows], np.nan)
        self._from[rows], self._ahead[rows] = latest, np.nan
        rows, latest = rows[moves], latest[moves]
        age = self._now[rows, None, None] - self._noted[rows][:, None]
        nearest = np.abs(age - LAGS[:, None]).argmin(axis=-1)  # the oldest, if all are younger
        before = self._states[rows[:, None], nearest]
        way = latest[:, None, :2] - before[..., :2]
        told = [_into(latest[:, 2:], each) for each in (before[..., 2:], way)]
        pairs = np.concatenate(told, axis=-1).reshape(len(rows), 4 * len(LAGS))
        self.past[rows] = np.concatenate((_length(latest[:, 2:])[:, None], pairs), axis=1)

    def answer(self, rows: Rows, ahead: NDArray[np.float32]) -> None:
        """Take what the network says of `past`, shape (K, 7, 3): metres ahead and to the left of a
        straight course, and the logarithm of their standard deviation in metres.
        """
        new = np.isnan(self._ahead[rows, 0, 0])
        self._ahead[rows[new]] = ahead[new]

    def known(self, rows: Rows) -> Mask:
        """Return which of K targets have a course that the network has answered for."""
        asked: Mask = ~np.isnan(self.seen[rows]) & ~np.isnan(self._ahead[rows, 0, 0])
        return asked

    def off(self, rows: Rows, places: Floats) -> Floats:
        """Return how far K targets are off a straight course after each of `HORIZONS`, ahead and to
        the left of it [m], for places east and north [m]; both of shape (K, 7, 2).
        """
        start, velocity = self._from[rows, None, :2], self._from[rows, 2:]
        return _into(velocity, places - start - velocity[:, None] * HORIZONS[:, None])

    def here(self, rows: Rows) -> tuple[Floats, Floats, Floats, Floats]:
        """Return where K targets with known courses are [m], (K, 2), their velocities [m/s], (K,
        2), the standard deviation of the places [m], (K,), and the time since they were seen [s].
        """
        since = self._now[rows] - self.seen[rows]
        covered = np.maximum(since - _COVERED, 0.0)
        pace = np.where(covered > 0.0, _PACE, 1.0)[:, None]
        offset, velocity, spread = self._as_said(rows, since + (_PACE - 1.0) * covered)
        straight, heading = covered / _STRAIGHTENING, self._from[rows, 2:]
        place = self._from[rows, :2] + _straightened(offset, heading, straight)
        return place, pace * _straightened(velocity, heading, straight), spread, since

    def _as_said(self, rows: Rows, since: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the ways of K targets after a time as the network says [m], their velocities, and
        the standard deviation of the places; beyond what it says, straight on.
        """
        times = np.concatenate(((0.0,), HORIZONS))
        part = np.clip(np.searchsorted(times, since, side="right") - 1, 0, len(HORIZONS) - 1)
        ahead = self._ahead[rows]
        points = np.concatenate((np.zeros_like(ahead[:, :1, :2]), ahead[..., :2]), axis=1)
        spreads = np.concatenate((np.zeros((len(rows), 1)), exact.exp(ahead[..., 2])), axis=1)
        each = np.arange(len(rows))
        lasts = times[part + 1] - times[part]
        share = (since - times[part]) / lasts
        slope = (points[each, part + 1] - points[each, part]) / lasts[:, None]
        aside = points[each, part] + slope * (since - times[part])[:, None]
        spread = spreads[each, part] + share * (spreads[each, part + 1] - spreads[each, part])
        velocity = self._from[rows, 2:]
        offset = velocity * since[:, None] + _out_of(velocity, aside)
        return offset, velocity + _out_of(velocity, slope), spread


def _straightened(vectors: Floats, heading: Floats, share: Floats) -> Floats:
    """Return vectors (K, 2), turned to headings of any length by a share, at most wholly, (K,)."""
    ahead = heading * (_length(vectors) / _length(heading))[:, None]
    share = np.minimum(share, 1.0)[:, None]
    return (1.0 - share) * vectors + share * ahead


def _length(vectors: Floats) -> Floats:
    length: Floats = np.sqrt(np.square(vectors).sum(axis=-1))
    return length


def _into(velocity: Floats, vectors: Floats) -> Floats:
    """Return vectors (K, L, 2) in the frame of velocities (K, 2): ahead and to the left."""
    ahead = (velocity / _length(velocity)[:, None])[:, None]
    along = (vectors * ahead).sum(axis=-1)
    left = vectors[..., 1] * ahead[..., 0] - vectors[..., 0] * ahead[..., 1]
    return np.stack((along, left), axis=-1)


def _out_of(velocity: Floats, vectors: Floats) -> Floats:
    """Return vectors (K, 2) of that frame, east and north."""
    ahead = velocity / _length(velocity)[:, None]
    left = np.stack((-ahead[:, 1], ahead[:, 0]), axis=-1)
    return vectors[:, :1] * ahead + vectors[:, 1:] * left
