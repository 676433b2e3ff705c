"""The English of claims: two sets of wordings, one to learn from, one to be tested in.

Names of colours and bodies are common to both, for nobody could know others. All else differs:
no sentence, and no expression for an action, a place or a bearing, is in both sets, so that a
policy that has learned sentences by heart is found out.
"""

from collections.abc import Mapping
from enum import StrEnum
from typing import Final, NamedTuple

import numpy as np

from eyas.engine.targets.grammar.claims import Bearing, Claim, MotionWord, PicturePlace
from eyas.engine.targets.grammar.in_view import BodyWord

CHARACTERS: Final = "abcdefghijklmnopqrstuvwxyz ,'"  # All characters of phrases

LONGEST: Final = 192  # No phrase is longer [characters]

_NOUNS: Mapping[BodyWord, tuple[str, ...]] = {
    BodyWord.VEHICLE: ("vehicle",),
    BodyWord.CAR: ("car",),
    BodyWord.SEDAN: ("sedan",),
    BodyWord.SUV: ("suv",),
    BodyWord.HATCHBACK: ("hatchback",),
    BodyWord.SMALL_CAR: ("small car", "compact car"),
    BodyWord.VAN: ("van",),
    BodyWord.BUS: ("bus",),
    BodyWord.TRUCK: ("truck", "lorry"),
    BodyWord.MOTORCYCLE: ("motorcycle", "motorbike"),
    BodyWord.BICYCLE: ("cyclist", "bicycle"),
    BodyWord.PERSON: ("pedestrian", "person"),
    BodyWord.ROBOT: ("robot",),
}


class Wording(StrEnum):
    """Sets of wordings."""

    TRAINING = "training"
    TEST = "test"


class WordingSet(NamedTuple):
    """Expressions, each of which one is sampled from; `{}` is replaced."""

    sentences: tuple[str, ...]  # Around "the red car"
    doing: Mapping[MotionWord, tuple[str, ...]]
    """After the noun; `{}` is "driving", "walking" or "moving"."""
    place: Mapping[PicturePlace, tuple[str, ...]]  # After that
    bearing: Mapping[Bearing, tuple[str, ...]]  # `{}` is the reference: "the bus"


WORDINGS: Mapping[Wording, WordingSet] = {
    Wording.TRAINING: WordingSet(
        sentences=("{}", "follow {}", "track {}", "keep your eye on {}", "the target is {}"),
        doing={
            MotionWord.STANDING: ("standing still", "that stands still"),
            MotionWord.MOVING: ("on the move", "that is {}"),
            MotionWord.STRAIGHT: ("{} straight on", "that is {} straight on"),
            MotionWord.LEFT_TURN: ("turning left", "that turns left"),
            MotionWord.RIGHT_TURN: ("turning right", "that turns right"),
        },
        place={
            PicturePlace.LEFT: ("on the left", "in the left half"),
            PicturePlace.RIGHT: ("on the right", "in the right half"),
            PicturePlace.TOP: ("at the top", "in the upper half"),
            PicturePlace.BOTTOM: ("at the bottom", "in the lower half"),
            PicturePlace.LEFTMOST: ("farthest to the left", "that is leftmost"),
            PicturePlace.RIGHTMOST: ("farthest to the right", "that is rightmost"),
            PicturePlace.TOPMOST: ("nearest to the upper edge", "that is topmost"),
            PicturePlace.BOTTOMMOST: ("nearest to the lower edge", "that is lowest"),
        },
        bearing={
            Bearing.BEHIND: ("behind {}", "that is behind {}"),
            Bearing.AHEAD: ("in front of {}", "that is in front of {}"),
            Bearing.BESIDE: ("beside {}", "that is beside {}"),
        },
    ),
    Wording.TEST: WordingSet(
        sentences=("stay with {}", "do not lose {}", "fly after {}", "watch only {}", "we want {}"),
        doing={
            MotionWord.STANDING: ("which has stopped", "waiting in its place"),
            MotionWord.MOVING: ("which keeps {}", "under way"),
            MotionWord.STRAIGHT: ("which keeps {} ahead without a turn", "going straight"),
            MotionWord.LEFT_TURN: ("which bends to the left", "taking a left"),
            MotionWord.RIGHT_TURN: ("which bends to the right", "taking a right"),
        },
        place={
            PicturePlace.LEFT: ("left of the middle", "over on the left hand side"),
            PicturePlace.RIGHT: ("right of the middle", "over on the right hand side"),
            PicturePlace.TOP: ("above the middle", "up in the picture"),
            PicturePlace.BOTTOM: ("below the middle", "down in the picture"),
            PicturePlace.LEFTMOST: ("with none left of it", "closest to the left edge"),
            PicturePlace.RIGHTMOST: ("with none right of it", "closest to the right edge"),
            PicturePlace.TOPMOST: ("with none above it", "closest to the top edge"),
            PicturePlace.BOTTOMMOST: ("with none below it", "closest to the bottom edge"),
        },
        bearing={
            Bearing.BEHIND: ("which follows {}", "with {} before it"),
            Bearing.AHEAD: ("which leads {}", "with {} after it"),
            Bearing.BESIDE: ("next to {}", "which has {} at its side"),
        },
    ),
}
"""The two sets."""


def in_words(claim: Claim, wording: Wording, rng: np.random.Generator) -> str:
    """Return a sentence that says what a claim says, small letters only."""
    said = WORDINGS[wording]
    words = _noun_phrase(claim, rng)
    if claim.doing is not None:
        words += " " + _one_of(said.doing[claim.doing], rng).format(_going(claim.body))
    if claim.place is not None:
        words += " " + _one_of(said.place[claim.place], rng)
    if claim.bearing is not None and claim.other is not None:
        other = _noun_phrase(claim.other, rng)
        words += " " + _one_of(said.bearing[claim.bearing], rng).format(other)
    return _one_of(said.sentences, rng).format(words)


def _noun_phrase(claim: Claim, rng: np.random.Generator) -> str:
    noun = _one_of(_NOUNS[claim.body], rng)
    if claim.colour is None:
        return f"the {noun}"
    if claim.body is BodyWord.PERSON:
        return f"the {noun} in {claim.colour}"
    return f"the {claim.colour} {noun}"


def _going(body: BodyWord) -> str:
    return {BodyWord.PERSON: "walking", BodyWord.ROBOT: "moving"}.get(body, "driving")


def _one_of(choices: tuple[str, ...], rng: np.random.Generator) -> str:
    return choices[int(rng.integers(len(choices)))]
