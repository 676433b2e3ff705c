"""Cars whose drivers say how fast they want to go and where to turn: they keep to lanes and curves,
and behind whoever is ahead.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.traffic.ways import LEFT, RIGHT, STRAIGHT, Ways, wrapped
from eyas.lanes import exact

TOP_SHARE: Final = 1.45
"""Highest speed that a driver may want, as a multiple of the limit: a dash of
`eyas.engine.traffic.drivers`."""

# SUMO's passenger car and its driver, with which recorded traffic drives.
_ACCELERATION: Final = 2.6  # [m/s^2]
_BRAKING: Final = 4.5  # Usual deceleration [m/s^2]
_EMERGENCY: Final = 9.0  # Hardest deceleration [m/s^2]
_REACTION: Final = 1.0  # Time headway, Krauss' tau [s]
_GAP: Final = 2.5  # Distance to the car ahead when both stand [m]

_STEP: Final = 2.0  # Distance of the places ahead that a driver looks at [m]
_LOOK: Final = 61.0  # How far a driver looks ahead [m]: more than the way to a stop at 20 m/s
_PIECES: Final = 5  # Pieces of the way ahead within that: a lane, a turn, a lane, a turn, a lane
_WIDTH: Final = 1.9  # Distance to the left or right of the way from which others are beside it [m]
_BESIDE: Final = 8.0  # Least distance along the road to others on the lane that one changes to [m]
_LANE: Final = 3.5  # Width of a lane, roughly [m]
_CHANGES: Final = 20.0  # Least distance to the junction at which one changes lanes [m]
_SETTLED: Final = 0.6  # Distance from the middle of the lane within which a change is over [m]
_APPROACH: Final = 0.7  # Rate at which one goes back to the middle of the lane [1/s]
_SIDEWAYS: Final = 1.5  # Highest speed across the lane [m/s], driven from 5 m/s on
_SWERVE: Final = 2.0  # Highest acceleration across it [m/s^2]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


class Others(NamedTuple):
    """What is in the way of K cars: A actors around each."""

    place: Floats  # East and north [m], shape (K, A, 2)
    velocity: Floats  # East and north [m/s], shape (K, A, 2)
    half_length: Floats  # [m], shape (K, A)
    there: Mask  # Whether each is in the world, and not the car itself, shape (K, A)


class Ahead(NamedTuple):
    """The way ahead of K cars, at S places."""

    distance: Floats  # Along the way [m], shape (S,)
    place: Floats  # East and north [m], shape (K, S, 2)
    heading: Floats  # [rad], shape (K, S)
    fastest: Floats  # Speed of the curve there [m/s], shape (K, S)
    end: Floats  # Where the way ends [m], shape (K,); infinite beyond what is seen
    row: Integers  # Point of `Ways` at each place, shape (K, S)


class Steps(NamedTuple):
    """Where K cars are after a step."""

    place: Floats  # East and north [m], shape (K, 2)
    velocity: Floats  # [m/s], shape (K, 2)
    yaw: Floats  # Without jumps [rad], shape (K,)
    yaw_rate: Floats  # [rad/s], shape (K,)
    driven: Floats  # Way since the step before [m], shape (K,)


class SteeredCars:
    """N cars on the lanes of a map.

    Attributes:
        piece: Lane or turn on which each is, see `Ways`, shape (N,).
        along: How far along it [m], shape (N,).
        left: How far to the left of its middle [m], shape (N,).
        speed: Along it [m/s], shape (N,).
        yaw: Heading, without jumps [rad], shape (N,).
    """

    def __init__(self, ways: Ways, count: int) -> None:
        self.ways = ways
        self.piece = np.zeros(count, np.int64)
        self.along, self.left, self.speed, self.yaw = np.zeros((4, count))
        self._drift = np.zeros(count)  # Speed to the left [m/s]
        self._half = np.full(count, 2.2)  # Half the length [m]

    def begin(
        self, rows: Integers, place: Floats, yaw: Floats, speed: Floats, length: Floats
    ) -> None:
        """Put cars of lengths [m] where they are, with their headings [rad] and speeds [m/s]."""
        self.piece[rows], self.along[rows], self.left[rows] = self.ways.nearest(place, yaw)
        self.speed[rows], self.yaw[rows], self._half[rows] = speed, yaw, 0.5 * length
        self._drift[rows] = 0.0

    def advance(
        self,
        rows: Integers,  # The cars, shape (K,)
        wanted: Floats,  # Speed that each driver wants [m/s], shape (K,)
        turn: Integers,  # Way on at the next junction: `LEFT`, `STRAIGHT` or `RIGHT`, shape (K,)
        others: Others,  # What is around them
        period: float,  # Length of the step [s]
    ) -> Steps:
        """Drive for a step."""
        ways = self.ways
        before = self.place(rows)
        self._change_lanes(rows, turn, others)
        ahead = self.ahead(rows, turn)
        old = self.speed[rows]
        wanted = np.clip(wanted, 0.0, TOP_SHARE * ways.limit[self.piece[rows]])
        gap, pace = self.leader(rows, ahead, others)
        late = _BRAKING * _REACTION
        safe = np.sqrt(late * late + pace * pace + 2.0 * _BRAKING * np.maximum(gap, 0.0)) - late
        curve = np.sqrt(ahead.fastest * ahead.fastest + 2.0 * _BRAKING * ahead.distance).min(axis=1)
        new = np.minimum(np.minimum(wanted, curve), safe)
        new = np.clip(new, old - _EMERGENCY * period, old + _ACCELERATION * period)
        easy = np.maximum(np.minimum(wanted, curve), old - _BRAKING * period)
        new = np.maximum(np.minimum(new, easy), 0.0)
        new = np.where(gap <= 0.0, np.maximum(old - _EMERGENCY * period, 0.0), new)
        self._drive(rows, 0.5 * (old + new) * period, turn)
        self.speed[rows] = new
        self._steer(rows, new, period)
        after, place = self.ways.at(self.piece[rows], self.along[rows]), self.place(rows)
        drift = self._drift[rows]
        cosine, sine = exact.cos(after.heading), exact.sin(after.heading)
        velocity = np.stack([new * cosine - drift * sine, new * sine + drift * cosine], axis=1)
        heading = after.heading + np.where(new > 0.1, exact.atan2(drift, np.maximum(new, 0.1)), 0.0)
        change = wrapped(heading - self.yaw[rows])
        self.yaw[rows] += change
        step = place - before
        driven = np.asarray(exact.hypot(step[:, 0], step[:, 1]))
        return Steps(place, velocity, self.yaw[rows].copy(), change / period, driven)

    def place(self, rows: Integers) -> Floats:
        """Return where cars are, east and north [m], shape (K, 2)."""
        on = self.ways.at(self.piece[rows], self.along[rows])
        across = np.stack([-exact.sin(on.heading), exact.cos(on.heading)], axis=1)
        return np.asarray(on.place + self.left[rows, None] * across)

    def open_ways(self, rows: Integers) -> Mask:
        """Return whether one can go left, straight on and right at the next junction from any lane
        of the road, shape (K, 3).
        """
        ways, lane = self.ways, self._lane(rows)
        found = ways.onward[lane] >= 0
        for side in range(2):
            other = ways.beside[lane, side]
            while (other >= 0).any():
                there = other >= 0
                found |= there[:, None] & (ways.onward[np.maximum(other, 0)] >= 0)
                other = np.where(there, ways.beside[np.maximum(other, 0), side], -1)
        return np.asarray(found)

    def to_junction(self, rows: Integers) -> Floats:
        """Return the way to the next junction [m], shape (K,)."""
        ways, piece, lane = self.ways, self.piece[rows], self._lane(rows)
        left = ways.length[piece] - self.along[rows]
        return np.asarray(left + np.where(lane == piece, 0.0, ways.length[lane]))

    def leader(self, rows: Integers, ahead: Ahead, others: Others) -> tuple[Floats, Floats]:
        """Return the gap to whoever is next on the way [m], and how fast that one drives along it
        [m/s], shapes (K,); where the way ends, somebody stands.
        """
        count = len(rows)
        away = others.place[:, None] - ahead.place[:, :, None]  # K, S, A, 2
        square = away[..., 0] * away[..., 0] + away[..., 1] * away[..., 1]
        nearest = square.argmin(axis=1)  # K, A
        every, actor = np.arange(count)[:, None], np.arange(others.place.shape[1])[None]
        heading = ahead.heading[every, nearest]
        cosine, sine = exact.cos(heading), exact.sin(heading)
        off = away[every, nearest, actor]
        onward = cosine * off[..., 0] + sine * off[..., 1]
        across = cosine * off[..., 1] - sine * off[..., 0]
        distance = ahead.distance[nearest] + onward
        last = nearest == len(ahead.distance) - 1
        on_way = others.there & (np.abs(across) < _WIDTH) & (distance > 0.5)
        on_way &= ~(last & (onward > _STEP))
        gap = distance - others.half_length - self._half[rows, None] - _GAP
        gap = np.where(on_way, gap, np.inf)
        first = gap.argmin(axis=1)
        each = np.arange(count)
        velocity = others.velocity[each, first]
        pace = cosine[each, first] * velocity[:, 0] + sine[each, first] * velocity[:, 1]
        gap, end = gap[each, first], ahead.end - self._half[rows] - 1.0
        ends = end < gap
        return np.where(ends, end, gap), np.where(ends, 0.0, np.maximum(pace, 0.0))

    def ahead(self, rows: Integers, turn: Integers) -> Ahead:
        """Return the way ahead of cars that turn so at the next junction."""
        ways, piece = self.ways, self.piece[rows]
        distance = np.arange(0.0, _LOOK, _STEP)
        at = self.along[rows, None] + distance  # along the piece where it still is
        pieces = np.repeat(piece[:, None], len(distance), axis=1)
        end = np.full(len(rows), np.inf)
        pending = np.ones(len(rows), np.bool_)  # whether the next junction is still to come
        reach = ways.length[piece] - self.along[rows]
        for _ in range(_PIECES):
            follows = self._next(piece, np.where(pending, turn, STRAIGHT))
            pending &= ways.after[piece] >= 0
            beyond = distance > reach[:, None]
            stops = (follows < 0) & np.isinf(end)
            end = np.where(stops, reach, end)
            on = np.maximum(follows, 0)[:, None]
            goes = beyond & (follows >= 0)[:, None]
            pieces = np.where(goes, on, pieces)
            at = np.where(goes, distance - reach[:, None], at)
            piece = np.where(follows >= 0, follows, piece)
            reach = np.where(follows >= 0, reach + ways.length[piece], np.inf)
        at = np.minimum(at, ways.length[pieces])
        on_way = ways.at(pieces, at)
        fastest = np.where(distance > np.minimum(end, 1e9)[:, None], np.inf, on_way.fastest)
        row = ways.first[pieces] + (at / ways.spacing[pieces]).astype(np.int64)
        return Ahead(distance, on_way.place, on_way.heading, fastest, end, row)

    def _lane(self, rows: Integers) -> Integers:
        """Return the lane whose end is the next junction of each car."""
        piece = self.piece[rows]
        after = self.ways.after[piece]
        return np.where(after >= 0, after, piece)

    def _next(self, piece: Integers, turn: Integers) -> Integers:
        """Return the pieces that follow, or -1: the turn that is wanted, or else any."""
        ways = self.ways
        found = ways.after[piece]
        for wish in (turn, *(np.full(len(piece), way) for way in (STRAIGHT, RIGHT, LEFT))):
            found = np.where(found < 0, ways.onward[piece, wish], found)
        return found

    def _change_lanes(self, rows: Integers, turn: Integers, others: Others) -> None:
        """Let those change to the next lane who cannot turn as they want from theirs."""
        ways, piece = self.ways, self.piece[rows]
        cannot = (ways.after[piece] < 0) & (ways.onward[piece, turn] < 0)
        cannot &= np.abs(self.left[rows]) < _SETTLED
        cannot &= ways.length[piece] - self.along[rows] > _CHANGES
        if not cannot.any():
            return
        for side, sign, leads in ((0, 1.0, LEFT), (1, -1.0, RIGHT)):
            other = ways.beside[piece, side]
            towards = turn == leads
            # Straight on, where only another lane leads: whichever lane there is.
            towards |= (turn == STRAIGHT) & (ways.onward[np.maximum(other, 0), STRAIGHT] >= 0)
            fits = cannot & (other >= 0) & towards
            if not fits.any():
                continue
            away = others.place - self.place(rows)[:, None]
            yaw = ways.at(piece, self.along[rows]).heading
            cosine, sine = exact.cos(yaw)[:, None], exact.sin(yaw)[:, None]
            along = cosine * away[..., 0] + sine * away[..., 1]
            across = cosine * away[..., 1] - sine * away[..., 0]
            near = np.abs(along) < _BESIDE + others.half_length
            near &= np.abs(across - sign * _LANE) < 0.5 * _LANE
            fits &= ~(near & others.there).any(axis=1)
            self._change_to(rows[fits], other[fits])
            cannot &= ~fits

    def _change_to(self, rows: Integers, lane: Integers) -> None:
        """Take other lanes of the same road: cars are beside their middle, and go there."""
        here, share = self.place(rows), self.along[rows] / self.ways.length[self.piece[rows]]
        self.piece[rows] = lane
        along = share * self.ways.length[lane]
        on = self.ways.at(lane, along)
        away = here - on.place
        cosine, sine = exact.cos(on.heading), exact.sin(on.heading)
        onward = cosine * away[:, 0] + sine * away[:, 1]
        self.along[rows] = np.clip(along + onward, 0.0, self.ways.length[lane])
        self.left[rows] = cosine * away[:, 1] - sine * away[:, 0]

    def _drive(self, rows: Integers, way: Floats, turn: Integers) -> None:
        """Go along the way, over the ends of pieces."""
        ways = self.ways
        self.along[rows] += way
        for _ in range(_PIECES):
            piece = self.piece[rows]
            over = self.along[rows] - ways.length[piece]
            follows = self._next(piece, turn)
            goes = (over > 0.0) & (follows >= 0)
            if not goes.any():
                break
            self.piece[rows[goes]], self.along[rows[goes]] = follows[goes], over[goes]
        self.along[rows] = np.minimum(self.along[rows], ways.length[self.piece[rows]])

    def _steer(self, rows: Integers, speed: Floats, period: float) -> None:
        """Go back to the middle of the lane."""
        fastest = _SIDEWAYS * np.minimum(speed / 5.0, 1.0)
        wanted = np.clip(-_APPROACH * self.left[rows], -fastest, fastest)
        most = _SWERVE * period
        drift = self._drift[rows] + np.clip(wanted - self._drift[rows], -most, most)
        drift = np.clip(drift, -fastest, fastest)
        self.left[rows] += drift * period
        self._drift[rows] = drift
