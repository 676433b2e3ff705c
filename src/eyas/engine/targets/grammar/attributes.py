"""What a phrase says as numbers, for policies without a language model."""

from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.targets.colour_names import COLOUR_NAMES
from eyas.engine.targets.grammar.claims import Bearing, Claim, Doing, PicturePlace
from eyas.engine.targets.grammar.in_view import BodyWord

Vector = NDArray[np.float32]
Word = TypeVar("Word", BodyWord, Doing, PicturePlace, Bearing)

_COLOUR = ("said", "red", "green", "blue")

ATTRIBUTES: Final[tuple[str, ...]] = (
    *(f"colour_{part}" for part in _COLOUR),
    *(f"body_{word}" for word in BodyWord),
    *(f"doing_{doing}" for doing in Doing),
    *(f"place_{place}" for place in PicturePlace),
    *(f"bearing_{bearing}" for bearing in Bearing),
    *(f"other_colour_{part}" for part in _COLOUR),
    *(f"other_body_{word}" for word in BodyWord),
)
"""What each number of the vector means. `colour_said` is 1 where a colour is named, whose sRGB
values, 0 to 1, are the next three; all others are 1 where that is said, else 0. `other` is the
reference of a bearing. Without words all are 0."""

_INDEX = {name: index for index, name in enumerate(ATTRIBUTES)}


def attributes_of(claim: Claim | None) -> Vector:
    """Return a claim as numbers, see `ATTRIBUTES`; None: nothing is said."""
    vector = np.zeros(len(ATTRIBUTES), np.float32)
    if claim is None:
        return vector
    _colour_into(vector, "colour", claim.colour)
    _colour_into(vector, "other_colour", claim.other_colour)
    said = {
        "body": claim.body,
        "doing": claim.doing,
        "place": claim.place,
        "bearing": claim.bearing,
        "other_body": claim.other_body,
    }
    for group, value in said.items():
        if value is not None:
            vector[_INDEX[f"{group}_{value}"]] = 1.0
    return vector


def claim_of(vector: NDArray[np.floating]) -> Claim | None:
    """Return the claim that numbers say; None if they say nothing."""
    body = _said(vector, "body", BodyWord)
    if body is None:
        return None
    return Claim(
        body,
        _colour_in(vector, "colour"),
        _said(vector, "doing", Doing),
        _said(vector, "place", PicturePlace),
        _said(vector, "bearing", Bearing),
        _said(vector, "other_body", BodyWord),
        _colour_in(vector, "other_colour"),
    )


def _colour_into(vector: Vector, group: str, name: str | None) -> None:
    if name is not None:
        first = _INDEX[f"{group}_said"]
        vector[first : first + 4] = 1.0, *COLOUR_NAMES[name]


def _colour_in(vector: NDArray[np.floating], group: str) -> str | None:
    first = _INDEX[f"{group}_said"]
    if not vector[first] > 0.5:
        return None
    said = vector[first + 1 : first + 4].astype(np.float64)
    return min(
        COLOUR_NAMES, key=lambda name: float(np.abs(said - np.array(COLOUR_NAMES[name])).sum())
    )


def _said(vector: NDArray[np.floating], group: str, words: type[Word]) -> Word | None:
    for word in words:
        if vector[_INDEX[f"{group}_{word}"]] > 0.5:
            return word
    return None
