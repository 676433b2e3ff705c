"""When vehicles brake and signal, from how they will have moved on their roads.

A recording holds no lamps, so they follow from its motion: a brake lamp is lit while the vehicle
slows down or stands, indicators blink before a turn at a junction and before a change of lanes, as
drivers look ahead. Live traffic has no future: there SUMO tells what its drivers signal
(`eyas.engine.traffic.sumo.SumoRun.read_lamps`).
"""

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.surface.signalling import BRAKING, LEFT, RIGHT
from eyas.engine.state.motion import Lamp, Motion
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.traffic.interpolation import sample_before
from eyas.engine.traffic.network import crossings
from eyas.engine.traffic.smoothing import runs
from eyas.lanes import exact, kernel

_CELL = 0.5  # Side of a cell [m]

_SHARE = 0.85  # Share of its width for which a lane is painted: its border belongs to none


class LaneMap:
    """The lanes of a network, painted into cells.

    Attributes:
        edge: Edge of each lane, see `RoadNetwork.lane_edge`, shape (L,).
        index: See `RoadNetwork.lane_index`, shape (L,).
        left_hand: See `RoadNetwork`.
    """

    def __init__(self, network: RoadNetwork) -> None:
        self.edge: Final = network.lane_edge
        self.index: Final = network.lane_index
        self.left_hand: Final = network.left_hand
        self._network = network
        self._crossings = crossings(zip(network.edge_start, network.edge_end, strict=True))
        points = network.lane_points
        self._low = points.min(axis=0) - 10.0
        columns, rows = ((points.max(axis=0) + 10.0 - self._low) / _CELL).astype(int) + 1
        self._cells = np.full((int(rows), int(columns)), -1, np.int32)
        for lane in range(len(network.lane_width)):
            span = slice(*network.lane_first[lane : lane + 2].tolist())
            row, column = self._cell(*_strip(points[span], float(network.lane_width[lane])).T)
            self._cells[row, column] = lane

    def at(self, x: NDArray[np.floating], y: NDArray[np.floating]) -> NDArray[np.int32]:
        """Return the lane at places [m], -1 where there is none, as within junctions."""
        row, column = self._cell(x.astype(np.float64), y.astype(np.float64))
        rows, columns = self._cells.shape
        inside = (row >= 0) & (column >= 0) & (row < rows) & (column < columns)
        found: NDArray[np.int32] = self._cells[
            np.where(inside, row, 0), np.where(inside, column, 0)
        ]
        return np.where(inside, found, -1).astype(np.int32)

    def meets(self, lane: int, following: int) -> bool:
        """Return whether there is a choice of ways where one lane leads on to another."""
        edges = self._network
        node = edges.edge_end[self.edge[lane]]
        return node == edges.edge_start[self.edge[following]] and node in self._crossings

    def _cell(
        self, x: NDArray[np.float64], y: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the rows and columns of places [m]."""
        return (
            np.floor((y - self._low[1]) / _CELL).astype(np.int64),
            np.floor((x - self._low[0]) / _CELL).astype(np.int64),
        )


def _strip(line: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Return points all over a strip along a line, shape (K, 2), closer than cells are."""
    along = np.diff(line, axis=0)
    length = exact.hypot(*along.T)
    pieces = np.maximum(np.ceil(length / (0.8 * _CELL)), 1).astype(np.int64)
    which = np.repeat(np.arange(len(along)), pieces)
    part = np.arange(len(which)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    middle = line[which] + along[which] * ((part + 0.5) / pieces[which])[:, None]
    left = np.stack([-along[:, 1], along[:, 0]], axis=-1) / np.maximum(length, 1e-9)[:, None]
    half = 0.5 * _SHARE * width
    aside = np.linspace(-half, half, int(width / (0.8 * _CELL)) + 2)
    spread: NDArray[np.float64] = middle[:, None] + aside[:, None] * left[which][:, None]
    return spread.reshape(-1, 2)


BLINKS: Final = 1.5
"""Blinks of an indicator in a second, lit for half of each: 60 to 120 a minute (UN Regulation 48,
6.5.9)."""

_BEGIN, _END = 1.3, 0.7
"""Decelerations at which brake lamps are lit and go out [m/s²]: must above the one, must not below
the other (UN Regulation 13-H, 5.2.22.4, of braking without a pedal)."""

_SINCE, _UNTIL = 0.3, 0.5
"""Time before and after an instant over which its deceleration is a mean [s]: the foot is on the
pedal before the speed changes."""

_STILL = 0.15  # Speed of what stands [m/s]

_LEAST = 0.6  # Shortest time for which brake lamps are lit, or out [s]: a foot is no faster

_BEFORE_TURN = 30.0  # Distance to a junction at which a driver begins to signal [m]

_LEAD = 3.0  # Time before a turn or a change of lanes at which he has begun, at the latest [s]

_TURN = 0.6  # Change of the heading at a junction beyond which the way is called a turn [rad]

_AFTER = 1.0  # Time after the line between two lanes is crossed for which he signals on [s]

_LOOK = 0.5  # Time from one look at the lane to the next [s]

_BRAKE, _LEFT, _RIGHT = int(Lamp.BRAKE), int(Lamp.LEFT), int(Lamp.RIGHT)

_APART: Final = 0.6180339887498949
"""Share of a blink by which an actor's indicators are ahead of those of the one before: the golden
section, by which no two of them are in step."""


class _Change(NamedTuple):
    """A turn or a change of lanes of one actor, in samples."""

    begin: int
    end: int
    left: bool
    turn: bool


@kernel(inline=True)
def shining(motion: Motion, actor: int, time: float) -> int:
    """Return which lamps of an actor shine at a time [s], see
    `eyas.engine.state.draw.DrawList.lamps`.
    """
    state = int(motion.lamps[sample_before(motion, time), actor])
    lit = BRAKING if state & _BRAKE else 0
    blink = BLINKS * time + _APART * float(actor)
    if blink - float(int(blink)) < 0.5:
        lit |= LEFT if state & _LEFT else 0
        lit |= RIGHT if state & _RIGHT else 0
    return lit


def shining_as(
    motion: Motion,  # Motion of all actors
    actors: NDArray[np.integer],  # The actors, shape (K,)
    like: NDArray[np.integer],  # Those with whose indicators theirs blink, shape (K,)
    time: NDArray[np.float64],  # [s], shape (K,)
) -> NDArray[np.uint8]:
    """Return which lamps of actors shine in the rhythm of others, see `shining`, shape (K,)."""
    last = np.clip((time - motion.first_time) * motion.rate, 0.0, float(motion.samples - 1))
    state = motion.lamps[np.minimum(last.astype(np.int64), motion.samples - 2), actors]
    blink = BLINKS * time + _APART * like.astype(np.float64)
    on = blink - np.trunc(blink) < 0.5
    lit = np.where(state & _BRAKE, BRAKING, 0)
    lit |= np.where(on & ((state & _LEFT) != 0), LEFT, 0)
    lit |= np.where(on & ((state & _RIGHT) != 0), RIGHT, 0)
    return lit.astype(np.uint8)


def lamps_of(
    table: NDArray[np.void],  # Their samples, shape (S, A)
    rate: float,  # Its samples per second [Hz]
    network: RoadNetwork,  # The roads that they drive on
) -> NDArray[np.uint8]:
    """Return `Motion.lamps` of vehicles."""
    lamps = np.zeros(table.shape, np.uint8)
    lanes = LaneMap(network)
    for actor in range(table.shape[1]):
        own = table[:, actor]
        for first, last in runs(own["present"] > 0.0):
            stay, lit = own[first:last], lamps[first:last, actor]
            lit[_brakes(stay, rate)] |= _BRAKE
            for change in _changes(stay, rate, lanes):
                begin = change.begin - round(_LEAD * rate)
                if change.turn:
                    way = stay["travelled"]
                    near = way.searchsorted(way[change.begin] - np.float32(_BEFORE_TURN))
                    begin = min(begin, int(near))
                side = _LEFT if change.left else _RIGHT
                span = slice(max(begin, 0), change.end + 1)
                lit[span] = lit[span] & _BRAKE | side  # the next change counts
    return lamps


def _brakes(stay: NDArray[np.void], rate: float) -> NDArray[np.bool_]:
    """Return whether the brake lamps are lit at the samples of a stay in the world, shape (S,)."""
    speed = exact.hypot(stay["velocity_x"].astype(np.float64), stay["velocity_y"])
    since, until = max(round(_SINCE * rate), 1), max(round(_UNTIL * rate), 1)
    rows = np.arange(len(speed))
    before, after = np.maximum(rows - since, 0), np.minimum(rows + until, len(speed) - 1)
    gained = (speed[after] - speed[before]) * (rate / np.maximum(after - before, 1))
    stands = (speed < _STILL) & (speed[after] < 2.0 * _STILL)
    on = (gained < -_BEGIN) | stands
    off = (gained > -_END) & ~stands
    last_on = np.maximum.accumulate(np.where(on, rows, -1))
    last_off = np.maximum.accumulate(np.where(off, rows, 0))
    lit: NDArray[np.bool_] = last_on > last_off
    least = _LEAST * rate
    for first, last in runs(~lit):
        if last - first < least and first > 0:
            lit[first:last] = True
    for first, last in runs(lit):
        lit[first : first + round(least)] |= last - first < least
    return lit


def _changes(stay: NDArray[np.void], rate: float, lanes: LaneMap) -> Iterator[_Change]:
    """Yield the turns and changes of lanes of a stay in the world, in order."""
    step = max(round(_LOOK * rate), 1)
    rows = np.arange(0, len(stay), step)
    lane = lanes.at(stay["x"][rows], stay["y"][rows])
    rows, lane = rows[lane >= 0], lane[lane >= 0]
    where = np.flatnonzero(lane[1:] != lane[:-1])
    for at in where.tolist():
        begin, end = int(rows[at]), int(rows[at + 1])
        here, there = int(lane[at]), int(lane[at + 1])
        if lanes.edge[here] == lanes.edge[there]:
            aside = int(lanes.index[there] - lanes.index[here])
            if end - begin <= 2 * step:
                yield _Change(
                    begin,
                    end + round(_AFTER * rate),
                    left=(aside > 0) != lanes.left_hand,
                    turn=False,
                )
            continue
        turned = float(stay["yaw"][end]) - float(stay["yaw"][begin])
        if lanes.meets(here, there) and abs(turned) > _TURN:
            yield _Change(begin, end, left=turned > 0.0, turn=True)
