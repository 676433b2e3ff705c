"""Words that tell a target from the others in view: "a red SUV", "a pedestrian in a blue coat".

The shortest phrase of its model (`Model.words`) that no other shares is enough: "a red SUV". If
even the longest is shared, the target is told by what it does, "a red SUV, turning left", or else
by where it is in the picture: "a red SUV, the left one of two".
"""

from collections.abc import Sequence
from functools import cache
from typing import Final, NamedTuple

from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import MODELS, kind_of
from eyas.engine.targets.colour_names import colour_name, with_article

_TURNING: Final = 0.15  # Yaw rate from which on something turns [rad/s]

_ASIDE: Final = 0.04  # Distance in the picture from which on left and right are seen [its width]

_NUMBERS: Final = ("", "", "two", "three", "four", "five", "six", "seven", "eight", "nine")

_ORDINALS: Final = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh")


class _Row(NamedTuple):
    """Words for places in a row."""

    of_two: tuple[str, str]
    ends: tuple[str, str]
    between: str


_ACROSS: Final = _Row(("left", "right"), ("leftmost", "rightmost"), "{} from the left")
_AWAY: Final = _Row(("nearer", "farther"), ("nearest", "farthest"), "{} nearest")


class ObjectInView(NamedTuple):
    """What a camera sees of a moving object."""

    model: int  # Index into `MODELS`
    colour: Sequence[float]  # sRGB 0 to 1
    speed: float  # [m/s]
    yaw_rate: float  # Counter-clockwise [rad/s]
    column: float  # From the left edge of the picture [its width]
    distance: float  # From the camera, along its axis [m]


def phrases(
    model: int,  # Index into `MODELS`
    colour: Sequence[float],  # Its colour, sRGB 0 to 1
) -> tuple[str, ...]:
    """Return descriptions of a target, from short to long."""
    return _phrases(model, colour_name(colour))


@cache
def _phrases(model: int, seen: str) -> tuple[str, ...]:
    return tuple(
        phrase.replace("a {}", with_article(seen)).replace("{}", seen)
        for phrase in MODELS[model].words
    )


def words_of(model: int, colour: Sequence[float]) -> str:
    """Return the shortest description of a target."""
    return phrases(model, colour)[0]


def colour_words(model: int) -> tuple[str, ...]:
    """Return the names of the colours that a model may have, in the order of its kind's.

    For what always looks the same, such as a robot: what it looks like.
    """
    shortest = MODELS[model].words[0]
    if "{}" not in shortest:
        return (shortest,)
    return tuple(dict.fromkeys(colour_name(colour) for colour in kind_of(model).colours))


def distinguishing_phrase(target: ObjectInView, others: Sequence[ObjectInView]) -> str:
    """Return the shortest description of a target that none of the others in view shares."""
    rivals: dict[str, list[ObjectInView]] = {
        own: [] for own in phrases(target.model, target.colour)
    }
    for other in others:
        for phrase in phrases(other.model, other.colour):
            if phrase in rivals:
                rivals[phrase].append(other)
    phrase = min(rivals, key=lambda own: len(rivals[own]))  # the first of the best
    alike = rivals[phrase]
    if not alike:
        return phrase
    doing = _doing(target)
    if doing not in {_doing(other) for other in alike}:
        return f"{phrase}, {doing}"
    return f"{phrase}, {_place(target, alike)}"


def _doing(seen: ObjectInView) -> str:
    kind = kind_of(seen.model).object_class
    if seen.speed < kind_of(seen.model).slowest:
        alive = kind in (ObjectClass.PERSON, ObjectClass.ROBOT)
        spins = alive and abs(seen.yaw_rate) >= _TURNING
        return "turning on the spot" if spins else "standing still"
    if kind is ObjectClass.PERSON:
        return "walking"
    if kind is ObjectClass.ROBOT:
        return "moving"
    if abs(seen.yaw_rate) < _TURNING:
        return "driving straight on"
    return "turning left" if seen.yaw_rate > 0.0 else "turning right"


def _place(target: ObjectInView, alike: Sequence[ObjectInView]) -> str:
    """Return which of those that look the same it is."""
    beside = min(abs(other.column - target.column) for other in alike)
    if beside >= _ASIDE:
        rank = sum(other.column < target.column for other in alike)
        return _ranked(rank, len(alike) + 1, _ACROSS)
    rank = sum(other.distance < target.distance for other in alike)
    return _ranked(rank, len(alike) + 1, _AWAY)


def _ranked(rank: int, count: int, words: _Row) -> str:
    """Return words for a place in a row, counted from its beginning."""
    if count == 2:
        return f"the {words.of_two[rank]} one of two"
    if rank in (0, count - 1):
        place = words.ends[rank > 0]
    else:
        ordinal = _ORDINALS[rank] if rank < len(_ORDINALS) else f"{rank + 1}th"
        place = words.between.format(ordinal)
    return f"the {place} of {_NUMBERS[count] if count < len(_NUMBERS) else count}"
