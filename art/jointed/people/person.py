"""A person: what distinguishes people.

Lengths are those of a person of 1.80 m, from the usual proportions of limbs (Drillis and Contini,
1966: hip at 0.53 of the height, thigh and shank 0.245 each, ankle at 0.039); a person is scaled.
"""

from dataclasses import dataclass
from enum import Enum

from eyas.engine.targets.kind import Colour

HIP = 0.95  # Height of the hips [m]
NECK = 0.53  # Lower end of the neck above the hips [m]
THIGH, SHANK, ANKLE = 0.44, 0.435, 0.085
UPPER_ARM, FOREARM = 0.30, 0.25
HEEL, TOES = 0.07, 0.19  # Length of a shoe behind and ahead of the ankle [m]


class Build(Enum):
    """Form of a body."""

    MAN = "man"
    WOMAN = "woman"
    STOUT = "stout"
    CHILD = "child"

    @property
    def head(self) -> float:
        """Size of the head as a factor: children's are larger beside their bodies."""
        return 1.28 if self is Build.CHILD else 1.0

    @property
    def width(self) -> float:
        """Width while it stands, with arms, at a height of 1.80 m [m]; the original's is 0.6."""
        return {"man": 0.57, "woman": 0.5, "stout": 0.6, "child": 0.51}[self.value]


class Garment(Enum):
    """What a person wears above the trousers, in the colour of the instance."""

    SHIRT = "shirt"
    T_SHIRT = "T-shirt"
    HOODIE = "hoodie"
    JACKET = "jacket"
    OPEN_JACKET = "open jacket"
    DOWN_JACKET = "down jacket"
    COAT = "coat"
    DRESS = "dress"

    @property
    def is_long(self) -> bool:
        """Whether it reaches down to the thighs."""
        return self in (Garment.COAT, Garment.DRESS)

    @property
    def bare_arms(self) -> bool:
        """Whether forearms are bare."""
        return self in (Garment.T_SHIRT, Garment.DRESS)


class Lower(Enum):
    """What legs are clothed in."""

    TROUSERS = "trousers"
    WIDE = "wide trousers"
    SHORTS = "shorts"
    SKIRT = "skirt"
    NONE = "nothing"  # Bare legs, under a dress


class Head(Enum):
    """What is on a person's head."""

    SHORT = "short"
    LONG = "long"
    BUN = "bun"
    TAIL = "ponytail"
    BOB = "bob"
    CAP = "cap"
    HAT = "hat"
    BEANIE = "beanie"
    HOOD = "hood"
    BALD = "bald"


class Shoes(Enum):
    """Forms of shoes."""

    LEATHER = "leather"
    TRAINERS = "trainers"
    BOOTS = "boots"


class Posture(Enum):
    """How a person carries body and arms."""

    FREE = "free"
    POCKETS = "hands in the pockets"
    PHONE = "looks at a phone"
    LADEN = "a bag in the hand"
    STOOPED = "stooped"
    PUSHES = "pushes a pram"


class Carried(Enum):
    """What a person has along."""

    NOTHING = "nothing"
    BACKPACK = "backpack"
    SHOULDER_BAG = "shoulder bag"
    SHOPPING_BAG = "shopping bag"
    PRAM = "pram"


@dataclass(frozen=True, slots=True, kw_only=True)
class Person:
    """A person."""

    name: str
    height: float  # [m]
    build: Build
    garment: Garment
    head: Head
    skin: Colour
    hair_colour: Colour  # Of the hair, or of what covers it
    lower: Lower = Lower.TROUSERS
    lower_colour: Colour  # Of the trousers or the skirt
    shoes: Shoes = Shoes.LEATHER
    shoe_colour: Colour
    cut: str = "plain"  # Texture of the garment, one of `art.jointed.people.clothing.CLOTHES`.
    inner_colour: Colour = (0.84, 0.83, 0.81)  # Of the shirt that shows in a jacket or a coat
    posture: Posture = Posture.FREE
    carried: Carried = Carried.NOTHING
    carried_colour: Colour = (0.15, 0.15, 0.16)

    @property
    def scale(self) -> float:
        """Factor on the lengths of a person of 1.80 m."""
        return self.height / (HIP + NECK + 0.305 * self.build.head)

    @property
    def size(self) -> tuple[float, float, float]:
        """Length, width and height while standing [m]; the first are those of the original."""
        if self.name == "Pedestrian":
            return 0.4, 0.6, 1.8
        ahead, back = 0.235, 0.145
        if self.posture is Posture.PHONE:
            ahead = 0.46
        if self.carried is Carried.PRAM:
            ahead = 1.25
        if self.garment is Garment.HOODIE or self.posture is Posture.STOOPED:
            back = 0.17
        if self.head in (Head.LONG, Head.TAIL, Head.BUN, Head.BOB):
            back = 0.195 if self.head in (Head.TAIL, Head.BUN) else 0.17
        if self.garment is Garment.DOWN_JACKET or self.lower is Lower.SKIRT:
            back = 0.2
        if self.garment.is_long:
            back = 0.22
        if self.carried is Carried.BACKPACK:
            back = 0.30
        return (ahead + back) * self.scale, self.build.width * self.scale, self.height
