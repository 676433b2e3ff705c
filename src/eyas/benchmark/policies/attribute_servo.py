"""A servo that knows what it is told: it looks for the colour, the size, the place, the motion or
the neighbour that the attributes name, and flies to it. Its twin takes the colourful thing of a
car's shape that is nearest to the middle.
"""

from collections.abc import Mapping
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.blobs import Blobs, blobs_in, coloured, painted, salient
from eyas.engine.policies.policy import Decision, PolicyInput, Start, env_config
from eyas.engine.policies.steering import ground_offset, ground_width, towards
from eyas.engine.targets.grammar.attributes import claim_of
from eyas.engine.targets.grammar.claims import Bearing, Claim, MotionWord, PicturePlace
from eyas.engine.targets.grammar.in_view import BodyWord
from eyas.lanes import exact

Floats = NDArray[np.float64]
Picture = NDArray[np.uint8]

_SIZE: Final = (126, 168)  # Height and width of its pictures [pixels]: a car is 20 pixels long

_SHAPES: Final = {
    BodyWord.VEHICLE: (4.2, 1.4),
    BodyWord.CAR: (4.2, 1.4),
    BodyWord.SEDAN: (4.4, 1.4),
    BodyWord.SUV: (4.2, 1.5),
    BodyWord.HATCHBACK: (4.0, 1.4),
    BodyWord.SMALL_CAR: (3.1, 1.2),
    BodyWord.VAN: (6.6, 1.8),
    BodyWord.BUS: (9.5, 2.4),
    BodyWord.TRUCK: (3.0, 2.5),
    BodyWord.MOTORCYCLE: (1.6, 0.6),
    BodyWord.BICYCLE: (1.6, 0.5),
}
"""Length and width of what is painted, as blobs are measured [m]: of a truck, the cab."""

_CAR_LIKE: Final = 0.9
"""Largest difference of a blob's shape from a car's, as of `_unlike`: a van is one, a roof not."""

_WATCHED: Final = 1.0  # How long it watches what moves, if the words are about that [s]
_GATE: Final = 3.0  # Farthest from where it is expected that the target is looked for, at first [m]
_WIDER: Final = 4.0  # How much farther, for each second in which it is not seen [m/s]
_SPEEDS: Final = (0.8, 1.5)  # Below the first something stands, above the second it moves [m/s]

_TURN: Final = 0.12
"""Change of its direction while it is watched from which on something turns [rad]."""


class _Track(NamedTuple):
    """Something that is followed, ahead and left of the drone's first place."""

    place: Floats  # [m], shape (2,)
    velocity: Floats  # [m/s], shape (2,)
    unseen: float  # Time since it was seen [s]


class _Drone:
    """What the servo remembers of one drone."""

    def __init__(self, claim: Claim | None) -> None:
        self.claim = claim
        self.colour: Floats | None = None  # Colour that is followed without words [0 to 255]
        self.own = np.zeros(2)  # Distance flown so far, ahead and left [m]
        self.time = 0.0
        self.watched: list[tuple[float, Floats]] = []
        """Times and places of all candidates while it watches."""
        self.track: _Track | None = None


class AttributeServo:
    """Flies to what the attributes say, from pictures alone.

    Args:
        listens: Whether it uses attributes; False: it does the same with any words.
    """

    sampled = False

    def __init__(self, changes: Mapping[str, Any], *, listens: bool) -> None:
        self.told = frozenset({"attributes"} if listens else ())
        image = {"height": _SIZE[0], "width": _SIZE[1], "colours": "rgb", "layout": "hwc"}
        own = {"observation": image, "actions": "discrete", "action_repeat": 8}
        self.env = env_config(own, {**changes, "observation": image, "actions": "discrete"})
        self._listens = listens
        self._scale = ground_width() / _SIZE[1]

    def begin(self, start: Start) -> None:
        """Remember what each is told."""
        told = start.told
        claims = [
            None if told is None else claim_of(told.attributes[row])
            for row in range(len(start.seeds))
        ]
        self._drones = [_Drone(claim if self._listens else None) for claim in claims]
        self._moved = np.zeros((len(claims), 2))

    def act(self, sight: PolicyInput) -> Decision:
        """Look for the targets, and steer."""
        pictures: Any = sight.observation
        period = 0.008 * self.env.action_repeat
        offset = np.zeros((len(self._drones), 2))
        for row in np.flatnonzero(sight.deciding).tolist():
            drone = self._drones[row]
            drone.own += self._moved[row]
            self._look(drone, pictures[row], period)
            drone.time += period
            if drone.track is not None:
                track = drone.track
                offset[row] = track.place + period * track.velocity - drone.own
        actions = towards(offset, self.env)
        speed = self.env.speeds
        steps = np.zeros((7, 2))
        steps[0, 0], steps[1, 0] = speed.forward_speed, speed.backward_speed
        steps[2, 1], steps[3, 1] = speed.left_speed, speed.right_speed
        self._moved = period * steps[actions]
        return Decision(actions)

    def _look(self, drone: _Drone, picture: Picture, period: float) -> None:
        """Find the target in a picture, or choose it."""
        if drone.track is not None:
            _follow(drone, self._blobs(drone, picture), period)
        elif not self._listens:
            blobs = self._painted(None, picture)
            cars = np.flatnonzero(_unlike(blobs, BodyWord.CAR) < _CAR_LIKE)
            if len(cars):
                places = self._places(blobs)
                best = cars[int(_lengths(places[cars]).argmin())]
                column, row = blobs.place[best].astype(int)
                near = picture[max(row - 6, 0) : row + 7, max(column - 6, 0) : column + 7]
                drone.colour = near[salient(near)].mean(axis=0)
                drone.track = _Track(places[best], np.zeros(2), 0.0)
        elif drone.claim is not None:
            blobs = self._blobs(drone, picture)
            if len(blobs.length):
                self._choose(drone, drone.claim, blobs, picture)

    def _blobs(self, drone: _Drone, picture: Picture) -> Blobs:
        if drone.colour is not None:
            return blobs_in(coloured(picture, drone.colour), self._scale)
        claim = drone.claim
        assert claim is not None
        told = (claim.doing, claim.place, claim.bearing)
        alike = any(each is not None for each in told)  # all that fit have one body
        each = _SHAPES[claim.body][0] if alike and claim.body in _SHAPES else None
        return self._painted(claim.colour, picture, each)

    def _painted(self, name: str | None, picture: Picture, each: float | None = None) -> Blobs:
        """Return the blobs of a colour; None: of all that is colourful."""
        mask = salient(picture) if name is None else painted(picture, name)
        return blobs_in(mask, self._scale, each, apart=each is None)

    def _places(self, blobs: Blobs) -> Floats:
        """Return where blobs are from the point in the middle of the picture: ahead, left [m]."""
        return ground_offset(blobs.place[:, 0], blobs.place[:, 1], _SIZE)

    def _choose(self, drone: _Drone, claim: Claim, blobs: Blobs, picture: Picture) -> None:
        """Begin to follow the blob that fits a claim best."""
        places = self._places(blobs) + drone.own
        error = _unlike(blobs, claim.body)
        velocity = np.zeros_like(places)
        if claim.place is not None:
            near = error < error.min() + 0.5
            error = np.where(near, _rank(claim.place, blobs.place), np.inf)
        elif claim.bearing is not None:
            error = error + self._misfit(claim, blobs, picture)
        elif claim.doing is not None:
            drone.watched.append((drone.time, places))
            if drone.time < _WATCHED:
                return
            ways = _ways(drone.watched)
            error = error + np.array([_misdoing(claim.doing, way) for way in ways])
            velocity = np.array([(way[-1] - way[0]) / drone.time for way in ways])
        best = int(error.argmin())
        drone.track = _Track(places[best], velocity[best], 0.0)

    def _misfit(self, claim: Claim, blobs: Blobs, picture: Picture) -> Floats:
        """Return how badly each blob is where a claim says from its reference."""
        others, places = self._painted(claim.other_colour, picture), self._places(blobs)
        if not len(others.length):
            return np.zeros(len(places))
        alike = _unlike(others, claim.other_body or BodyWord.CAR)
        best = np.full(len(places), np.inf)
        for middle, axis, length, unlike in zip(
            self._places(others), others.axis, others.length, alike.tolist(), strict=True
        ):
            away = places - middle
            line = np.array([-axis[1], -axis[0]])  # of columns and rows, ahead and left
            along = np.abs(away[:, 0] * line[0] + away[:, 1] * line[1])
            across = np.abs(away[:, 1] * line[0] - away[:, 0] * line[1])
            gap = 0.5 * (length + blobs.length)
            if claim.bearing is Bearing.BESIDE:
                off = np.maximum(along - 0.4 * gap, 0.0) + np.abs(across - 3.3)
            else:
                off = np.maximum(along - gap - 8.0, 0.0) + np.maximum(gap - along, 0.0) + across
            same = _lengths(away) < 1.0
            best = np.minimum(best, np.where(same, np.inf, 0.4 * off + unlike))
        return np.where(np.isinf(best), 10.0, best)


def _lengths(vectors: Floats) -> Floats:
    lengths: Floats = exact.hypot(vectors[:, 0], vectors[:, 1])
    return lengths


def _unlike(blobs: Blobs, body: BodyWord) -> Floats:
    """Return how much the shapes of blobs differ from that of a body, shape (B,)."""
    length, width = _SHAPES.get(body, _SHAPES[BodyWord.CAR])
    long, wide = np.abs(exact.log(blobs.length / length)), np.abs(exact.log(blobs.width / width))
    unlike: Floats = long + 0.5 * wide
    return unlike


def _follow(drone: _Drone, blobs: Blobs, period: float) -> None:
    """Move a track to the blob that is nearest to where the target is expected."""
    assert drone.track is not None
    place, velocity, unseen = drone.track
    expected = place + period * velocity
    places = ground_offset(blobs.place[:, 0], blobs.place[:, 1], _SIZE) + drone.own
    away = _lengths(places - expected) if len(places) else np.full(1, np.inf)
    best = int(away.argmin())
    if away[best] > _GATE + _WIDER * unseen:
        drone.track = _Track(expected, velocity, unseen + period)
        return
    error = places[best] - expected
    drone.track = _Track(expected + 0.7 * error, velocity + 0.15 * error / period, 0.0)


def _rank(place: PicturePlace, places: Floats) -> Floats:
    """Return what is least for the blob at a place."""
    axis = 0 if place.value.startswith(("left", "right")) else 1
    first = place.value.startswith(("left", "top"))
    return places[:, axis] if first else -places[:, axis]


def _ways(watched: list[tuple[float, Floats]]) -> list[Floats]:
    """Return where each of the last candidates was at the first, middle and last of the times that
    it was watched, each shape (3, 2): from one picture to the next it is the nearest one.
    """
    ways = []
    for place in watched[-1][1]:
        way = [place]
        for _, places in reversed(watched[:-1]):
            if not len(places):
                continue
            away = _lengths(places - way[-1])
            way.append(places[int(away.argmin())] if away.min() < 2.5 else way[-1])
        way.reverse()
        ways.append(np.array([way[0], way[len(way) // 2], way[-1]]))
    return ways


def _misdoing(doing: MotionWord, way: Floats) -> float:
    """Return how badly a way of one second is what a claim says."""
    first, second = way[1] - way[0], way[2] - way[1]
    speed = exact.hypot(*(way[2] - way[0])) / _WATCHED
    turn = exact.atan2(first[0] * second[1] - first[1] * second[0], exact.dot(first, second))
    stands, moves = speed < _SPEEDS[0], speed > _SPEEDS[1]
    wrong = {
        MotionWord.STANDING: not stands,
        MotionWord.MOVING: not moves,
        MotionWord.STRAIGHT: not moves or abs(turn) > _TURN,
        MotionWord.LEFT_TURN: not moves or turn < _TURN,
        MotionWord.RIGHT_TURN: not moves or turn > -_TURN,
    }[doing]
    return 5.0 if wrong else 0.0


attribute_servo = partial(AttributeServo, listens=True)
salient_servo = partial(AttributeServo, listens=False)
