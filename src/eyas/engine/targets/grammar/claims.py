"""What a phrase says, and which of the objects in view it fits.

Each statement is judged twice. `holds` is strict: it is what may be said of a target. `fits` is
generous: what nearly fits counts as fitting. A claim tells a target apart if it holds for it and
fits nothing else, so that no reader has to decide a close call.
"""

from enum import StrEnum
from functools import cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.targets.catalogue import kind_of
from eyas.engine.targets.colour_names import COLOUR_NAMES, colour_distances
from eyas.engine.targets.grammar.in_view import CAN_BE_CALLED, BodyWord, InView, body_of
from eyas.lanes import exact

Mask = NDArray[np.bool_]
Floats = NDArray[np.float64]


class Doing(StrEnum):
    """What something does in the first picture."""

    STANDING = "standing"
    MOVING = "moving"
    STRAIGHT = "straight"  # It moves straight on
    LEFT_TURN = "left_turn"
    RIGHT_TURN = "right_turn"


class PicturePlace(StrEnum):
    """Where something is in the first picture: in a part of it, or the outermost of those that
    fit all else that is said.
    """

    LEFT = "left"
    RIGHT = "right"
    TOP = "top"
    BOTTOM = "bottom"
    LEFTMOST = "leftmost"
    RIGHTMOST = "rightmost"
    TOPMOST = "topmost"
    BOTTOMMOST = "bottommost"


class Bearing(StrEnum):
    """Where something is from another, as that one heads."""

    BEHIND = "behind"
    AHEAD = "ahead"
    BESIDE = "beside"


class Claim(NamedTuple):
    """What a phrase says. Something that has only a body is "the car"."""

    body: BodyWord
    colour: str | None = None  # A name in `COLOUR_NAMES`
    doing: Doing | None = None
    place: PicturePlace | None = None
    bearing: Bearing | None = None  # Only with a reference
    other_body: BodyWord | None = None  # The reference, of which there is one only in view
    other_colour: str | None = None

    @property
    def other(self) -> "Claim | None":
        """What is said of the reference; None: there is none."""
        return None if self.other_body is None else Claim(self.other_body, self.other_colour)


def tells_apart(claim: Claim, view: InView, row: int) -> bool:
    """Return whether a claim is true of one of those in view, and nothing else nearly fits it."""
    alike = fits(claim, view)
    alike[row] = False
    return bool(holds(claim, view)[row]) and not alike.any()


def holds(claim: Claim, view: InView) -> Mask:
    """Return for which of those in view a claim is clearly true, shape (A,)."""
    true = _is_called(claim.body, view, strict=True)
    if claim.colour is not None:
        true &= _is_coloured(claim.colour, view, strict=True)
    if claim.doing is not None:
        true &= _does(claim.doing, view, strict=True)
    if claim.other is not None:
        true &= _bears(claim, view, strict=True)
    if claim.place is not None:
        true &= _is_placed(claim.place, view, fits(claim._replace(place=None), view), strict=True)
    return true


def fits(claim: Claim, view: InView) -> Mask:
    """Return which of those in view a claim fits, or nearly does, shape (A,)."""
    near = _is_called(claim.body, view, strict=False)
    if claim.colour is not None:
        near &= _is_coloured(claim.colour, view, strict=False)
    if claim.doing is not None:
        near &= _does(claim.doing, view, strict=False)
    if claim.other is not None:
        near &= _bears(claim, view, strict=False)
    if claim.place is not None:
        near &= _is_placed(claim.place, view, near, strict=False)
    return near


_GENERAL = {
    BodyWord.VEHICLE: CAN_BE_CALLED[BodyWord.VEHICLE],
    BodyWord.CAR: CAN_BE_CALLED[BodyWord.CAR] - {BodyWord.VAN},
}


def _is_called(body: BodyWord, view: InView, *, strict: bool) -> Mask:
    allowed = _GENERAL.get(body, frozenset({body})) if strict else CAN_BE_CALLED[body]
    return np.array([body_of(model) in allowed for model in view.model.tolist()], bool)


_NEAR_COLOUR: Final = 1.6
"""A colour nearly has a name that is at most so many times as far away as the nearest one."""
_CLEAR_COLOUR: Final = 1.8
"""A colour clearly has a name if the next one is so many times as far away."""

_NAMES = tuple(COLOUR_NAMES)


def _is_coloured(name: str, view: InView, *, strict: bool) -> Mask:
    distances = np.sqrt(colour_distances(view.colour)) + 1e-3  # that of an exact name is 0
    own = distances[:, _NAMES.index(name)]
    painted = np.array([is_painted(model) for model in view.model.tolist()], bool)
    if strict:
        others = np.delete(distances, _NAMES.index(name), axis=1).min(axis=1)
        clear: Mask = painted & (others >= _CLEAR_COLOUR * own)
        return clear
    # Robots always look the same, in several colours: any may be meant.
    near: Mask = ~painted | (own <= _NEAR_COLOUR * distances.min(axis=1))
    return near


@cache
def is_painted(model: int) -> bool:
    """Return whether a model has a colour that a phrase can name; robots have several."""
    return body_of(model) is not BodyWord.ROBOT


_TURNING: Final = 0.2
"""Yaw rate from which on something clearly turns [rad/s]; from a third of it on it nearly does."""


def _does(doing: Doing, view: InView, *, strict: bool) -> Mask:
    slowest = np.array([kind_of(model).slowest for model in view.model.tolist()], np.float64)
    low, high = 0.3 * slowest, 3.0 * slowest
    moves = view.speed >= (high if strict else low)
    turn = _TURNING if strict else _TURNING / 3.0
    match doing:
        case Doing.STANDING:
            return view.speed < (low if strict else high)
        case Doing.MOVING:
            return moves
        case Doing.STRAIGHT:
            return moves & (np.abs(view.yaw_rate) < (_TURNING / 3.0 if strict else _TURNING))
        case Doing.LEFT_TURN:
            return moves & (view.yaw_rate >= turn)
        case Doing.RIGHT_TURN:
            return moves & (-view.yaw_rate >= turn)


_ASIDE: Final = 0.06  # Distance in the picture that decides a place [its width or height]

_SIDES = {
    PicturePlace.LEFT: (0, 1.0),
    PicturePlace.RIGHT: (0, -1.0),
    PicturePlace.TOP: (1, 1.0),
    PicturePlace.BOTTOM: (1, -1.0),
}
_ENDS = {
    PicturePlace.LEFTMOST: (0, 1.0),
    PicturePlace.RIGHTMOST: (0, -1.0),
    PicturePlace.TOPMOST: (1, 1.0),
    PicturePlace.BOTTOMMOST: (1, -1.0),
}
"""Axis of the picture, and in which direction of it a place is the first."""


def _is_placed(place: PicturePlace, view: InView, among: Mask, *, strict: bool) -> Mask:
    """Return which of those in view are at a place; `among`: all those that fit all else."""
    margin = _ASIDE if strict else -_ASIDE
    axis, sign = (_SIDES | _ENDS)[place]
    where = sign * (view.place[:, axis] - 0.5)
    shown = ((view.place > 0.0) & (view.place < 1.0)).all(axis=1) | ~np.bool_(strict)
    if place in _SIDES:
        return shown & (where < -margin)
    first = np.array(
        [np.min(where[among & (np.arange(len(where)) != k)], initial=np.inf)
         for k in range(len(where))]
    )  # fmt: skip
    return shown & (where < first - margin)


_GAP: Final = 10.0  # Longest free road between something and what it is behind or ahead of [m]


def _bears(claim: Claim, view: InView, *, strict: bool) -> Mask:
    """Return which of those in view are where a claim says from its reference."""
    assert claim.other is not None
    assert claim.bearing is not None
    references = np.flatnonzero(fits(claim.other, view)).tolist()
    if strict and (len(references) != 1 or not holds(claim.other, view)[references[0]]):
        return np.zeros(len(view.model), bool)
    near = np.zeros(len(view.model), bool)
    for reference in references:
        near |= _from(reference, claim.bearing, view, strict=strict)
    return near


def _from(reference: int, bearing: Bearing, view: InView, *, strict: bool) -> Mask:
    """Return which of those in view are behind, ahead of or beside one of them.

    As that one heads; generously also as a reader of the picture may mean it: behind is higher up,
    in front of is lower down.
    """
    away = view.middle - view.middle[reference]
    cosine, sine = (f(view.heading[reference : reference + 1]) for f in (exact.cos, exact.sin))
    ahead, left = cosine * away[:, 0] + sine * away[:, 1], cosine * away[:, 1] - sine * away[:, 0]
    length = 0.5 * (view.size[:, 0] + view.size[reference, 0])
    width = 0.5 * (view.size[:, 1] + view.size[reference, 1])
    here: Mask
    if bearing is Bearing.BESIDE:
        near, far, along = (0.2, 3.0, 0.6 * length) if strict else (-np.inf, 7.0, length + 2.0)
        here = (np.abs(left) > width + near) & (np.abs(left) < width + far)
        here &= np.abs(ahead) < along
    else:
        way, up = (-ahead, -1.0) if bearing is Bearing.BEHIND else (ahead, 1.0)
        if strict:
            here = (way > length) & (way < length + _GAP) & (np.abs(left) < 1.2)
        else:
            in_line = (way > 0.0) & (way < length + 2.0 * _GAP) & (np.abs(left) < width + 1.5)
            shift = view.place - view.place[reference]
            here = in_line | ((up * shift[:, 1] > 0.02) & (np.abs(shift[:, 0]) < 0.08))
    here[reference] = False
    return here
