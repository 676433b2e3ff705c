"""A person: what distinguishes people, and the shapes of their bodies.

Lengths are those of a person of 1.80 m, from the usual proportions of limbs (Drillis and Contini,
1966: hip at 0.53 of the height, thigh and shank 0.245 each, ankle at 0.039); a person is scaled.
"""

from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

from eyas.mesh.shell import DETAILS, Shape, Shell
from eyas.state.mesh import Material, Surface
from eyas.targets.jointed.outlines import limb, matt, stack
from eyas.targets.kind import Colour

__all__ = ["Garment", "Hair", "Person", "PersonShapes", "shapes_of_person"]

HIP = 0.95
"""Height of the hips [m]."""
SHOULDER = (0.0, 0.205, 0.43)
"""Left shoulder above the hips [m]."""
THIGH, SHANK, ANKLE = 0.44, 0.435, 0.085
UPPER_ARM, FOREARM = 0.30, 0.25
HEEL, TOES = 0.07, 0.19
"""Length of a shoe behind and ahead of the ankle [m]."""

_CLOTH = Material(texture="cloth", surface=Surface.PAINT)
"""The colour of the instance, without gloss."""

_BLACK = matt(0.13, 0.11, 0.10)
"""Eyes and zips."""


class Garment(Enum):
    """What a person wears above the trousers, in the colour of the instance."""

    SHIRT = "shirt"
    T_SHIRT = "T-shirt"
    COAT = "coat"
    JACKET = "jacket"
    DRESS = "dress"


class Hair(Enum):
    """What is on a person's head."""

    SHORT = "short"
    LONG = "long"
    BUN = "bun"
    CAP = "cap"
    HAT = "hat"


@dataclass(frozen=True, slots=True)
class Person:
    """A person."""

    name: str
    height: float
    """[m]"""
    girth: float
    """Factor on widths and depths."""
    garment: Garment
    hair: Hair
    skin: Colour
    hair_colour: Colour
    """Of the hair, or of what covers it."""
    trousers: Colour
    shoes: Colour
    length: float = 0.4
    """From front to back at a height of 1.80 m [m]; the original's is 0.4."""
    bag: Colour | None = None
    """Colour of a backpack; None: none."""

    @property
    def scale(self) -> float:
        """Height as a factor on the original's."""
        return self.height / 1.8

    @property
    def size(self) -> tuple[float, float, float]:
        """Length, width and height [m]."""
        return self.length * self.scale, 0.6 * self.girth * self.scale, self.height


@dataclass(frozen=True, slots=True)
class PersonShapes:
    """The shapes of a person's parts; left and right are alike."""

    torso: Shape
    """Hips, chest and head; its origin is between the hips."""
    upper_arm: Shape
    forearm: Shape
    thigh: Shape
    shank: Shape
    shoe: Shape


def shapes_of_person(person: Person) -> PersonShapes:
    """Return the shapes of a person's parts."""
    s, g = person.scale, person.girth * person.scale
    skin, trousers = matt(*person.skin), matt(*person.trousers)
    bare_arm = person.garment in (Garment.T_SHIRT, Garment.DRESS)
    leg = skin if person.garment is Garment.DRESS else trousers

    def torso(shell: Shell, detail: int) -> None:
        _torso(shell, person, detail)
        _head(shell, person, detail)

    def upper_arm(shell: Shell, detail: int) -> None:
        sides = (3, 5, 8)[detail]
        radii = (0.062 * g, 0.052 * g, 0.045 * g) if detail else (0.06 * g, 0.048 * g)
        limb(shell, UPPER_ARM * s, radii, _CLOTH, sides)

    def forearm(shell: Shell, detail: int) -> None:
        sides = (3, 5, 8)[detail]
        limb(shell, FOREARM * s, (0.046 * g, 0.036 * g), skin if bare_arm else _CLOTH, sides)
        if detail:
            centre = (0.012 * s, 0.0, -(FOREARM + 0.075) * s)
            size = (0.042 * s, 0.024 * s, 0.09 * s)
            shell.ball(centre, size, skin, rows=2 + detail, sides=3 + 2 * detail)
        else:
            shell.tube(
                [(0.0, 0.0, -FOREARM * s), (0.01, 0.0, -(FOREARM + 0.16) * s)],
                (0.04 * s, 0.03 * s), skin, sides=3,
            )  # fmt: skip

    def thigh(shell: Shell, detail: int) -> None:
        sides = (4, 6, 9)[detail]
        radii = (0.098 * g, 0.09 * g, 0.068 * g) if detail else (0.092 * g, 0.068 * g)
        limb(shell, THIGH * s, radii, leg, sides)
        if _is_long(person.garment):
            # What the leg pushes out of the skirt or coat is cloth.
            hem = [(0.0, 0.0, 0.0), (0.0, 0.0, -0.27 * s)]
            shell.tube(hem, (0.105 * g, 0.1 * g), _CLOTH, sides=sides)

    def shank(shell: Shell, detail: int) -> None:
        flare = 0.06 if leg is trousers else 0.042
        radii = (0.066 * g, 0.066 * g, flare * g) if detail else (0.066 * g, flare * g)
        limb(shell, (SHANK + 0.02) * s, radii, leg, (4, 6, 9)[detail])

    def shoe(shell: Shell, detail: int) -> None:
        _shoe(shell, matt(*person.shoes), s, detail)

    return PersonShapes(torso, upper_arm, forearm, thigh, shank, shoe)


def _torso(shell: Shell, person: Person, detail: int) -> None:
    s, g = person.scale, person.girth * person.scale
    sides = (5, 8, 12)[detail]
    trousers = matt(*person.trousers)

    def rows(*of: tuple[float, float, float, float]) -> list[tuple[float, float, float, float]]:
        return [(z * s, x * g, y * g, ahead * s) for z, x, y, ahead in of]

    hem = {Garment.COAT: -0.24, Garment.DRESS: -0.28, Garment.JACKET: -0.10}.get(
        person.garment, -0.05
    )
    flare = 0.03 if _is_long(person.garment) else 0.007
    low = (hem, 0.145 + 2.8 * flare, 0.205 + 0.7 * flare, 0.01)
    if not _is_long(person.garment):
        bottom = (-0.12, 0.09, 0.15, 0.0)
        stack(shell, rows(bottom, (0.0, 0.125, 0.18, 0.0)), trousers, sides, box=0.25)
    chest = [low, (0.10, 0.12, 0.18, 0.0), (0.32, 0.135, 0.195, 0.0), (0.43, 0.115, 0.20, -0.01)]
    shoulder = [(0.48, 0.095, 0.18, -0.012), (0.51, 0.08, 0.12, -0.015), (0.53, 0.06, 0.07, -0.01)]
    stack(shell, rows(*(chest if detail else chest[::2]), *shoulder), _CLOTH, sides, box=0.25)
    if detail == DETAILS[0] and person.garment in (Garment.COAT, Garment.JACKET):
        _zip(shell, rows(*chest, shoulder[0]), s)
    if person.bag is not None:
        low_corner, high = (-0.27 * s, -0.14 * s, 0.05 * s), (-0.10 * s, 0.14 * s, 0.47 * s)
        shell.box(low_corner, high, matt(*person.bag), taper=0.03)


def _zip(shell: Shell, rows: list[tuple[float, float, float, float]], s: float) -> None:
    """Add a dark strip down the front of a body of ovals, see `stack`."""
    half, off = 0.011 * s, 0.004 * s
    front = [(ahead + x + off, z) for z, x, _, ahead in rows]
    for (x, z), (higher_x, higher_z) in pairwise(front):
        corners = [(x, -half, z), (x, half, z), (higher_x, half, higher_z),
                   (higher_x, -half, higher_z)]  # fmt: skip
        shell.quads(corners, _BLACK)


def _head(shell: Shell, person: Person, detail: int) -> None:
    s = person.scale
    skin, hair = matt(*person.skin), matt(*person.hair_colour)
    sides, rows = (5, 8, 12)[detail], (3, 5, 8)[detail]
    middle = 0.725
    if detail:
        neck = [(0.0, 0.0, 0.50 * s), (0.01 * s, 0.0, 0.64 * s)]
        shell.tube(neck, (0.055 * s, 0.052 * s), skin, sides=sides - 2)
    shell.ball((0.02 * s, 0.0, middle * s), (0.098 * s, 0.078 * s, 0.122 * s), skin, rows=rows,
               sides=sides)  # fmt: skip
    if detail == DETAILS[0]:
        _face(shell, skin, s)
    if person.hair is Hair.HAT:
        brim = [(0.775, 0.155, 0.14, 0.015), (0.785, 0.155, 0.14, 0.015)]
        crown = [(0.78, 0.108, 0.092, 0.01), (0.88, 0.09, 0.075, 0.01)]
        for part in (brim, crown):
            stack(shell, [(z * s, x * s, y * s, a * s) for z, x, y, a in part], hair, sides)
        return
    back = -0.022 if person.hair is not Hair.CAP else 0.0
    shell.ball((back * s, 0.0, (middle + 0.028) * s), (0.098 * s, 0.088 * s, 0.112 * s), hair,
               rows=rows, sides=sides)  # fmt: skip
    if person.hair is Hair.CAP and detail:
        peak = [(0.765, 0.09, 0.06, 0.1), (0.778, 0.085, 0.055, 0.1)]
        stack(shell, [(z * s, x * s, y * s, a * s) for z, x, y, a in peak], hair, sides)
    if person.hair is Hair.BUN:
        centre = (-0.115 * s, 0.0, (middle + 0.07) * s)
        shell.ball(centre, (0.05 * s, 0.05 * s, 0.05 * s), hair, rows=3, sides=sides - 1)
    if person.hair is Hair.LONG:
        fall = [(0.42, 0.03, 0.075, -0.10), (0.56, 0.055, 0.10, -0.075), (0.74, 0.07, 0.088, -0.05)]
        stack(shell, [(z * s, x * s, y * s, a * s) for z, x, y, a in fall], hair, sides)


def _face(shell: Shell, skin: Material, s: float) -> None:
    """Add eyes and a nose, which are seen from near only."""
    for side in (-1.0, 1.0):
        shell.ball((0.107 * s, 0.03 * side * s, 0.74 * s), (0.01 * s, 0.014 * s, 0.009 * s), _BLACK,
                   rows=2, sides=4)  # fmt: skip
    shell.prism([(0.105 * s, 0.688 * s), (0.138 * s, 0.694 * s), (0.108 * s, 0.745 * s)],
                (-0.014 * s, 0.014 * s), skin)  # fmt: skip


def _is_long(garment: Garment) -> bool:
    """Return whether it reaches down to the thighs."""
    return garment in (Garment.COAT, Garment.DRESS)


def _shoe(shell: Shell, material: Material, s: float, detail: int) -> None:
    """Add a shoe; its frame is level, with the origin at the ankle."""
    low, toe, heel = -ANKLE * s, TOES * s, -HEEL * s
    profile = [(heel, low), (toe - 0.01 * s, low), (toe, low + 0.03 * s), (0.05 * s, 0.0),
               (heel, 0.01 * s)]  # fmt: skip
    if detail == 0:
        profile = [(heel, low), (toe, low), (0.05 * s, 0.0), (heel, 0.0)]
    shell.prism(profile, (-0.045 * s, 0.045 * s), material)
