"""The lanes of a map and the turns between them as pieces of one line each, on which cars drive."""

from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.lanes import exact

LEFT, STRAIGHT, RIGHT = range(3)
"""Ways on at the end of a lane; columns of `Ways.onward`."""

_SPACING: Final = 1.0  # Distance of neighbouring points of a piece, roughly [m]
_TURN: Final = 0.6  # Least change of heading of a turn, by which it is no way straight on [rad]
_BACK: Final = 2.6  # The same of one that leads back [rad]
_SIDEWAYS: Final = 5.5
"""Acceleration with which curves are driven, as netconvert limits the speed of turns [m/s^2]."""
_SLOWEST: Final = 3.0  # Speed below which no curve is limited [m/s]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class Ways(NamedTuple):
    """L lanes, and behind them the turns from lane to lane: P pieces with Q points."""

    first: Integers  # Start of each piece in the points, shape (P + 1,)
    length: Floats  # [m], shape (P,)
    spacing: Floats  # Distance of the points of each piece [m], shape (P,)
    place: Floats  # East and north of the points [m], shape (Q, 2)
    heading: Floats  # Of the piece at each point, without jumps within it [rad], shape (Q,)
    fastest: Floats  # Highest speed at each point: of its curve [m/s], shape (Q,)
    limit: Floats  # Speed limit of each piece [m/s], shape (P,)
    onward: Integers  # Turns that leave each lane: left, straight, right, or -1, shape (P, 3)
    after: Integers  # Lane that each turn leads to; of a lane, -1, shape (P,)
    beside: Integers  # Lanes of the same road on the left and on the right, or -1, shape (P, 2)
    owner: Integers  # Piece of each point, shape (Q,)

    def at(self, piece: Integers, along: Floats) -> "OnWay":
        """Return places on pieces, at distances along them [m]; shapes (M,)."""
        step = np.clip(along, 0.0, self.length[piece]) / self.spacing[piece]
        last = self.first[piece + 1] - self.first[piece] - 2
        whole = np.minimum(step.astype(np.int64), last)
        share, row = step - whole, self.first[piece] + whole
        place = self.place[row] + share[..., None] * (self.place[row + 1] - self.place[row])
        heading = self.heading[row] + share * (self.heading[row + 1] - self.heading[row])
        return OnWay(place, heading, np.minimum(self.fastest[row], self.fastest[row + 1]))

    def nearest(self, place: Floats, heading: Floats) -> tuple[Integers, Floats, Floats]:
        """Return the pieces on which cars are: those near them that lead where they head.

        Args:
            place: East and north [m], shape (M, 2).
            heading: Of the cars [rad], shape (M,).

        Returns:
            The pieces, distances along them and to the left of them [m], shapes (M,).
        """
        found = np.zeros(len(place), np.int64)
        for row, (at, yaw) in enumerate(zip(place, heading.tolist(), strict=True)):
            away = self.place - at
            turned = np.abs(wrapped(self.heading - yaw))
            found[row] = np.argmin((away * away).sum(axis=1) + 25.0 * turned * turned)
        piece = self.owner[found]
        away, ahead = place - self.place[found], self.heading[found]
        cosine, sine = exact.cos(ahead), exact.sin(ahead)
        along = (found - self.first[piece]) * self.spacing[piece]
        along += cosine * away[:, 0] + sine * away[:, 1]
        left = cosine * away[:, 1] - sine * away[:, 0]
        return piece, np.clip(along, 0.0, self.length[piece]), left


class OnWay(NamedTuple):
    """Places on pieces."""

    place: Floats  # East and north [m], shape (..., 2)
    heading: Floats  # [rad], shape (...,)
    fastest: Floats  # [m/s], shape (...,)


def wrapped(angle: Floats) -> Floats:
    """Return angles from -pi to pi [rad]."""
    return np.asarray(angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi)))


def ways_of(network: RoadNetwork) -> Ways:
    """Return the lanes of a network with the turns at their ends.

    The lane at the kerb leads to the kerb's side, the innermost to the other one, each straight on.
    Where a road ends, one turns back.
    """
    lanes = [
        network.lane_points[first:last]
        for first, last in zip(network.lane_first[:-1], network.lane_first[1:], strict=True)
    ]
    number = {
        (int(edge), int(index)): lane
        for lane, (edge, index) in enumerate(
            zip(network.lane_edge, network.lane_index, strict=True)
        )
    }
    most = np.zeros(len(network.edges), np.int64)
    np.maximum.at(most, network.lane_edge, network.lane_index)
    leaving: dict[str, list[int]] = {}
    for edge, node in enumerate(network.edge_start):
        leaving.setdefault(node, []).append(edge)
    turns: list[_Turn] = []
    onward = np.full((len(lanes), 3), -1, np.int64)
    for lane, line in enumerate(lanes):
        edge, index = int(network.lane_edge[lane]), int(network.lane_index[lane])
        straight: dict[int, tuple[float, int]] = {}
        back: int | None = None
        for other in leaving.get(network.edge_end[edge], ()):
            angle = _angle(line, lanes[number[other, 0]])
            if network.edge_end[other] == network.edge_start[edge] or abs(angle) > _BACK:
                back = other if back is None else back
                continue
            way = LEFT if angle > _TURN else RIGHT if angle < -_TURN else STRAIGHT
            off = abs(angle) if way == STRAIGHT else abs(abs(angle) - 0.5 * np.pi)
            straight[way] = min(straight.get(way, (np.inf, -1)), (off, other))
        kerb = LEFT if network.left_hand else RIGHT
        for way, (_, other) in straight.items():
            to = min(index, int(most[other]))
            if way == kerb and len(straight) > 1:
                if index > 0:
                    continue
                to = 0
            elif way != STRAIGHT and len(straight) > 1:
                if index < most[edge]:
                    continue
                to = int(most[other])
            onward[lane, way] = len(lanes) + len(turns)
            turns.append(_Turn(lane, number[other, to]))
        if not straight and back is not None:
            onward[lane, STRAIGHT] = len(lanes) + len(turns)
            turns.append(_Turn(lane, number[back, min(index, int(most[back]))]))
    lines = [*lanes, *(_curve(lanes[turn.lane], lanes[turn.to]) for turn in turns)]
    limit = [*network.lane_speed, *(network.lane_speed[turn.lane] for turn in turns)]
    after = [*[-1] * len(lanes), *(turn.to for turn in turns)]
    beside = np.full((len(lines), 2), -1, np.int64)
    inward = 1 if network.left_hand else 0  # which side lanes with higher numbers are on
    for (edge, index), lane in number.items():
        beside[lane, inward] = number.get((edge, index + 1), -1)
        beside[lane, 1 - inward] = number.get((edge, index - 1), -1)
    blank = np.full((len(turns), 3), -1, np.int64)
    return _joined(lines, np.array(limit), np.concatenate([onward, blank]), after, beside)


class _Turn(NamedTuple):
    lane: int  # Where it begins
    to: int  # Lane that it leads to


def _joined(
    lines: list[Floats], limit: Floats, onward: Integers, after: list[int], beside: Integers
) -> Ways:
    """Return ways along lines."""
    spaced = [_spaced(line) for line in lines]
    first = np.cumsum([0, *(len(line) for line, _ in spaced)])
    heading = np.concatenate([_headings(line) for line, _ in spaced])
    count = np.diff(first)
    spacing = np.array([step for _, step in spaced])
    owner = np.repeat(np.arange(len(lines)), count)
    bend = np.zeros(len(heading))
    bend[1:-1] = np.abs(heading[2:] - heading[:-2]) / (2.0 * spacing[owner[1:-1]])
    ends = np.concatenate([first[:-1], first[1:] - 1])
    bend[ends] = 0.0
    curve = np.sqrt(_SIDEWAYS / np.maximum(bend, 1e-6))
    return Ways(
        first=first,
        length=spacing * (count - 1),
        spacing=spacing,
        place=np.concatenate([line for line, _ in spaced]),
        heading=heading,
        fastest=np.maximum(curve, _SLOWEST),
        limit=limit.astype(np.float64),
        onward=onward,
        after=np.array(after, np.int64),
        beside=beside,
        owner=owner,
    )


def _spaced(line: Floats) -> tuple[Floats, float]:
    """Return points at even distances along a line, and that distance [m]."""
    step = np.diff(line, axis=0)
    way = np.concatenate(([0.0], np.cumsum(exact.hypot(step[:, 0], step[:, 1]))))
    count = max(round(float(way[-1]) / _SPACING), 1) + 1
    at = np.linspace(0.0, way[-1], count)
    points = np.stack([np.interp(at, way, line[:, axis]) for axis in (0, 1)], axis=1)
    return points, float(way[-1]) / (count - 1)


def _headings(line: Floats) -> Floats:
    """Return the heading of a line at its points [rad], shape (K,)."""
    step = np.diff(line, axis=0)
    along = np.concatenate([step[:1], step[1:] + step[:-1], step[-1:]])
    return np.unwrap(np.asarray(exact.atan2(along[:, 1], along[:, 0]), np.float64))


def _angle(line: Floats, other: Floats) -> float:
    """Return by how much one turns from the end of a line to the begin of another [rad]."""
    out, on = line[-1] - line[-2], other[1] - other[0]
    turned = np.array([exact.atan2(on[1], on[0]) - exact.atan2(out[1], out[0])])
    return float(wrapped(turned)[0])


def _curve(line: Floats, other: Floats) -> Floats:
    """Return a cubic from the end of a line to the begin of another."""
    out, on = line[-1] - line[-2], other[1] - other[0]
    begin, end = line[-1], other[0]
    away = end - begin
    length = max(float(exact.hypot(away[0], away[1])), 0.5)
    out, on = out / exact.hypot(out[0], out[1]), on / exact.hypot(on[0], on[1])
    # A third of a circle's quarter for a right angle, 4/3 tan(a/4) of its radius.
    reach = 0.39 * length if float(exact.dot(out, on)) < 0.9 else length / 3.0
    if float(exact.dot(out, on)) < -0.8:  # it turns back: wide enough for a car
        reach = max(0.67 * length, 4.0)
    t = np.linspace(0.0, 1.0, 25)[:, None]
    corners = [begin, begin + reach * out, end - reach * on, end]
    while len(corners) > 1:  # de Casteljau's construction
        corners = [(1.0 - t) * a + t * b for a, b in pairwise(corners)]
    return np.asarray(corners[0])
