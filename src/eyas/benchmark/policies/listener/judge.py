"""Which of the vehicles in view does a claim mean? As likely as what is known of each makes it."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.listener.candidates import TrackedVehicles
from eyas.benchmark.policies.listener.detector import BODIES, NAMES, body_sizes
from eyas.engine.targets.grammar.claims import Bearing, Claim, MotionWord, PicturePlace
from eyas.engine.targets.grammar.in_view import CAN_BE_CALLED, BodyWord
from eyas.lanes import exact

Floats = NDArray[np.float64]

_LEAST: Final = 1e-4  # Least probability of anything

_LATE: Final = 0.3
"""Time after the first look from which on a vehicle that appears is hardly meant [s]."""

_HARDLY: Final = 0.2  # How probable it is then, against one that was there
_EDGE: Final = 0.02  # Softness of places in the picture [its width, its height]
_STANDS: Final = 0.6, 0.15  # Speed between standing and moving, and the softness of that [m/s]

_TURNS: Final = 0.12, 0.04
"""Yaw rate between straight on and a turn, and the softness of that [rad/s]."""

_GAP: Final = 10.0  # Longest free road between two, one behind the other [m]
_SOFT: Final = 0.6  # Softness of distances between vehicles [m]
_ROLLS: Final = 1.0  # Speed from which on a vehicle heads where it moves [m/s]

_WEIGHT: Final = 4.0
"""Weight of the axis' yaw rate against that of the way, whose weight is speed^2 [(m/s)^2]."""


class _Lying(NamedTuple):
    """How K vehicles lie."""

    heading: Floats  # Counter-clockwise from east [rad], shape (K,)
    front: Floats  # Probability that this is not their back, shape (K,)
    size: Floats  # Length and width [m], shape (K, 2)


def judged(claim: Claim, seen: TrackedVehicles, place: Floats) -> Floats:
    """Return the logarithms of how probably each is meant, not normalised, shape (K,).

    Args:
        place: Where each was in the first picture, from the left and the upper edge [its width, its
            height], shape (K, 2).
    """
    looks = _called(claim.body, claim.colour, seen)
    chance = looks * np.where(seen.first > _LATE, _HARDLY, 1.0)
    if claim.place is not None:
        chance = chance * _placed(claim.place, place, looks)
    if claim.doing is not None:
        chance = chance * np.array([_does(claim.doing, way) for way in seen.ways])
    if claim.bearing is not None and claim.other is not None:
        other = _called(claim.other.body, claim.other.colour, seen)
        chance = chance * _bears(claim.bearing, seen, other)
    judged: Floats = exact.log(np.maximum(chance, _LEAST * _LEAST))
    return judged


def _called(body: BodyWord, colour: str | None, seen: TrackedVehicles) -> Floats:
    """Return the probability that each is called so, shape (K,)."""
    words = CAN_BE_CALLED[body] if body in (BodyWord.VEHICLE, BodyWord.CAR) else {body}
    fits = np.array([word in words for word in BODIES], np.float64)
    called = (exact.exp(seen.body) * fits).sum(axis=1)
    if colour is not None:
        called = called * exact.exp(seen.colour[:, NAMES.index(colour)])
    least: Floats = np.maximum(called, _LEAST)
    return least


def _step(value: Floats, softness: float) -> Floats:
    """Return a soft step from 0 to 1."""
    step: Floats = 1.0 / (1.0 + exact.exp(-np.clip(value / softness, -30.0, 30.0)))
    return step


def _placed(place: PicturePlace, where: Floats, looks: Floats) -> Floats:
    """Return the probability that each is at a place, shape (K,)."""
    said = place.value
    axis = 0 if said.startswith(("left", "right")) else 1
    sign = 1.0 if said.startswith(("left", "top")) else -1.0
    along = sign * (where[:, axis] - 0.5)
    if not said.endswith("most"):
        return _step(-along, _EDGE)
    # The first is whom none precedes that looks as said, either.
    rival = looks / max(float(looks.max(initial=_LEAST)), _LEAST)
    before = _step(along[:, None] - along[None], _EDGE) * rival[None]
    before[np.diag_indices(len(along))] = 0.0
    first: Floats = (1.0 - 0.999 * before).prod(axis=1)
    return first


def _does(doing: MotionWord, way: Floats) -> float:
    """Return the probability that a way is what a claim says."""
    if len(way) < 3:
        return _HARDLY
    speed, rate = _motion(way)
    moves = float(_step(np.array(speed - _STANDS[0]), _STANDS[1]))
    limit, soft = _TURNS
    left, right = (float(_step(np.array(side * rate - limit), soft)) for side in (1.0, -1.0))
    return {
        MotionWord.STANDING: 1.0 - moves,
        MotionWord.MOVING: moves,
        MotionWord.STRAIGHT: moves * (1.0 - left) * (1.0 - right),
        MotionWord.LEFT_TURN: moves * left,
        MotionWord.RIGHT_TURN: moves * right,
    }[doing]


def _motion(way: Floats) -> tuple[float, float]:
    """Return mean speed [m/s] and yaw rate [rad/s] of a way, (L, 4), by least squares."""
    time = way[:, 0] - way[:, 0].mean()
    square = time * time
    bent = square - square.mean()
    velocity = (time[:, None] * way[:, 1:3]).sum(axis=0) / max(float(square.sum()), 1e-9)
    turn = 2.0 * (bent[:, None] * way[:, 1:3]).sum(axis=0) / max(float((bent * bent).sum()), 1e-9)
    speed = float(np.sqrt(np.square(velocity).sum()))
    # The axis may be told the other way round.
    steps = np.diff(way[:, 3])
    steps = steps - np.pi * np.round(steps / np.pi)
    axis = np.concatenate(([0.0], np.cumsum(steps)))
    of_axis = float((time * axis).sum() / max(float(square.sum()), 1e-9))
    across = float(velocity[0] * turn[1] - velocity[1] * turn[0])
    of_way = across / max(speed * speed, 0.01)
    weight = speed * speed
    rate = (_WEIGHT * of_axis + weight * of_way) / (_WEIGHT + weight)
    return speed, rate


def _lying(seen: TrackedVehicles) -> _Lying:
    """Return how they lie: as they move, or else as their axes do."""
    axis = 0.5 * exact.atan2(seen.heading[:, 3], seen.heading[:, 2])
    line = np.stack((exact.cos(axis), exact.sin(axis)), axis=1)
    ahead = (seen.heading[:, :2] * line).sum(axis=1)
    speed = np.sqrt(np.square(seen.velocity).sum(axis=1))
    rolls = speed > _ROLLS
    ahead = np.where(rolls, (seen.velocity * line).sum(axis=1), ahead)
    front = np.where(rolls, 1.0, np.clip(0.5 + 0.5 * np.abs(ahead), 0.5, 1.0))
    heading = axis + np.where(ahead < 0.0, np.pi, 0.0)
    return _Lying(heading, front, exact.product(exact.exp(seen.body), body_sizes()))


def _bears(bearing: Bearing, seen: TrackedVehicles, other: Floats) -> Floats:
    """Return the probability that each is where a claim says from another one, shape (K,).

    Args:
        other: Probability that each is that other one, shape (K,).
    """
    lying = _lying(seen)
    away = seen.begin[:, None] - seen.begin[None]
    cosine, sine = exact.cos(lying.heading), exact.sin(lying.heading)
    ahead = cosine * away[..., 0] + sine * away[..., 1]
    left = cosine * away[..., 1] - sine * away[..., 0]
    length = 0.5 * (lying.size[:, None, 0] + lying.size[None, :, 0])
    width = 0.5 * (lying.size[:, None, 1] + lying.size[None, :, 1])
    if bearing is Bearing.BESIDE:
        aside = np.abs(left) - width
        here = _within(aside, -0.2, 3.3) * _step(0.6 * length - np.abs(ahead), _SOFT)
    else:
        sign = -1.0 if bearing is Bearing.BEHIND else 1.0
        there, back = (_within(way * sign - length, -0.3, _GAP) for way in (ahead, -ahead))
        front = lying.front[None]
        here = (front * there + (1.0 - front) * back) * _step(1.4 - np.abs(left), 0.4)
    here = here * (other / max(float(other.max(initial=_LEAST)), _LEAST))[None]
    here[np.diag_indices(len(other))] = 0.0
    bears: Floats = np.maximum(here.max(axis=1, initial=0.0), _LEAST)
    return bears


def _within(value: Floats, low: float, high: float) -> Floats:
    return _step(value - low, _SOFT) * _step(high - value, _SOFT)
