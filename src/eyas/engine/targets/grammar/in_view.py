"""What a camera has in view: the moving objects that a phrase can be about."""

from enum import StrEnum
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import MODELS, kind_of

Floats = NDArray[np.float64]


class BodyWord(StrEnum):
    """Words for what something is."""

    VEHICLE = "vehicle"  # Anything that drives on roads
    CAR = "car"  # A sedan, an SUV, a hatchback or a small car
    SEDAN = "sedan"
    SUV = "suv"
    HATCHBACK = "hatchback"
    SMALL_CAR = "small_car"
    VAN = "van"
    BUS = "bus"
    TRUCK = "truck"
    MOTORCYCLE = "motorcycle"
    BICYCLE = "bicycle"
    PERSON = "person"
    ROBOT = "robot"


_ROAD = (
    BodyWord.SEDAN,
    BodyWord.SUV,
    BodyWord.HATCHBACK,
    BodyWord.SMALL_CAR,
    BodyWord.VAN,
    BodyWord.BUS,
    BodyWord.TRUCK,
    BodyWord.MOTORCYCLE,
    BodyWord.BICYCLE,
)

CAN_BE_CALLED: dict[BodyWord, frozenset[BodyWord]] = {
    **{word: frozenset({word}) for word in BodyWord},
    BodyWord.VEHICLE: frozenset({BodyWord.VEHICLE, BodyWord.CAR, *_ROAD}),
    # From above a van is a large car, and only its length tells a small car from a hatchback.
    BodyWord.CAR: frozenset({BodyWord.CAR, *_ROAD[:5]}),
    BodyWord.HATCHBACK: frozenset({BodyWord.HATCHBACK, BodyWord.SMALL_CAR, BodyWord.CAR}),
    BodyWord.SMALL_CAR: frozenset({BodyWord.SMALL_CAR, BodyWord.HATCHBACK, BodyWord.CAR}),
    BodyWord.SEDAN: frozenset({BodyWord.SEDAN, BodyWord.CAR}),
    BodyWord.SUV: frozenset({BodyWord.SUV, BodyWord.CAR}),
    BodyWord.VAN: frozenset({BodyWord.VAN, BodyWord.SUV, BodyWord.CAR}),
    BodyWord.TRUCK: frozenset({BodyWord.TRUCK, BodyWord.VAN}),
}
"""The bodies that fit a word, or nearly do. Something whose own word is only a general one, such as
a car of a user's own, fits the special ones."""

_NOUNS = {
    "SUV": BodyWord.SUV,
    "sedan": BodyWord.SEDAN,
    "hatchback": BodyWord.HATCHBACK,
    "small": BodyWord.SMALL_CAR,
    "van": BodyWord.VAN,
}
"""Words in the phrases of models of cars."""

_CLASSES = {
    ObjectClass.CAR: BodyWord.CAR,
    ObjectClass.BUS: BodyWord.BUS,
    ObjectClass.TRUCK: BodyWord.TRUCK,
    ObjectClass.MOTORCYCLE: BodyWord.MOTORCYCLE,
    ObjectClass.PERSON: BodyWord.PERSON,
    ObjectClass.BICYCLE: BodyWord.BICYCLE,
}


@cache
def body_of(model: int) -> BodyWord:
    """Return what a model is, given by its index in `MODELS`."""
    kind = kind_of(model).object_class
    if kind is ObjectClass.CAR:
        said = {word for phrase in MODELS[model].words for word in phrase.split()}
        for noun, body in _NOUNS.items():
            if noun in said:
                return body
    return _CLASSES.get(kind, BodyWord.ROBOT)


class InView(NamedTuple):
    """The A moving objects of which a camera has a part in view, hidden or not.

    The phrases of one picture speak of these, and of nothing that does not move by itself.
    """

    actor: NDArray[np.int64]  # Actor of the tracker's world, shape (A,)
    model: NDArray[np.int64]  # Index into `MODELS`, shape (A,)
    colour: Floats  # sRGB 0 to 1, shape (A, 3)
    speed: Floats  # [m/s], shape (A,)
    yaw_rate: Floats  # Counter-clockwise [rad/s], shape (A,)
    heading: Floats  # Counter-clockwise from east [rad], shape (A,)
    middle: Floats  # East and north of its middle [m], shape (A, 2)
    size: Floats  # Length and width [m], shape (A, 2)
    place: Floats
    """Its middle from the left and from the upper edge of the picture [its width, its height],
    shape (A, 2)."""

    def row_of(self, actor: int) -> int:
        """Return the row of an actor that is in view."""
        (row,) = np.flatnonzero(self.actor == actor).tolist()
        return int(row)
