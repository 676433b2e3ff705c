"""Arms, legs and shoes of people; each part is shared by all who wear the same."""

from enum import Enum
from functools import cache

from art.jointed.people.clothing import LEG, SKIN, SLEEVE, cloth, skin
from art.jointed.people.person import (
    ANKLE,
    FOREARM,
    HEEL,
    SHANK,
    THIGH,
    TOES,
    UPPER_ARM,
    Build,
    Garment,
    Lower,
    Shoes,
)
from art.jointed.people.surfaces import Row, wrapped
from art.parts import DETAILS, Shape
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material
from eyas.engine.targets.kind import Colour

THICKNESS = {Build.MAN: 1.02, Build.STOUT: 1.02, Build.WOMAN: 0.87, Build.CHILD: 0.87}
"""Factor on the thickness of limbs; two of them, so that there are few parts."""


class Sleeve(Enum):
    """Forms of sleeves; the value is how far they stand off the arm [m]."""

    NONE = 0.004
    SHORT = 0.008
    THIN = 0.006
    THICK = 0.015
    QUILTED = 0.026


SLEEVES = {
    Garment.T_SHIRT: Sleeve.SHORT, Garment.SHIRT: Sleeve.THIN, Garment.HOODIE: Sleeve.THICK,
    Garment.JACKET: Sleeve.THICK, Garment.OPEN_JACKET: Sleeve.THICK,
    Garment.DOWN_JACKET: Sleeve.QUILTED, Garment.COAT: Sleeve.THICK, Garment.DRESS: Sleeve.NONE,
}  # fmt: skip
"""Sleeves of garments."""


def _round(z: float, radius: float, *, back: float = 0.0) -> Row:
    return z, radius - back, radius + back, radius


def _grown(rows: list[tuple[float, float]], thick: float, ease: float) -> list[Row]:
    """Return round outlines, from the bottom up."""
    return [_round(z, thick * radius + ease) for z, radius in rows]


class Holds(Enum):
    """What a hand does."""

    NOTHING = "nothing"
    PHONE = "a phone"
    POCKET = "is in a pocket"


@cache
def upper_arm(sleeve: Sleeve, thick: float, cut: str, tone: Colour) -> Shape:
    """Return an upper arm; a short sleeve leaves its lower half bare."""

    def shape(shell: Shell, detail: int) -> None:
        sides = (3, 4, 6)[detail]
        ease = sleeve.value
        top = [(-0.10, 0.052), (-0.03, 0.056), (0.02, 0.050), (0.045, 0.024)]
        if sleeve not in (Sleeve.NONE, Sleeve.SHORT):
            rows = [(-UPPER_ARM - 0.02, 0.042), (-0.22, 0.045), *top]
            ups: tuple[float, ...] = (0.45, 0.62, 0.8, 0.9, 0.95, 1.0)
            wrapped(shell, _grown(rows, thick, ease), ups, SLEEVE, cloth(cut), sides=sides)
            return
        short = [(-0.19, 0.053), *top] if sleeve is Sleeve.SHORT else [(-0.09, 0.053), *top[1:]]
        end = short[0][0]
        ups = tuple(0.2 + 0.8 * k / (len(short) - 1) for k in range(len(short)))
        wrapped(shell, _grown(short, thick, ease), ups, SLEEVE, cloth(cut), sides=sides)
        bare = [(-UPPER_ARM - 0.02, 0.038), (-0.2, 0.042), (end + 0.03, 0.045)]
        wrapped(shell, _grown(bare, thick, 0.0), (0.1, 0.5, 0.9), SKIN, skin(tone), sides=sides)

    return shape


@cache
def forearm(sleeve: Sleeve, thick: float, cut: str, tone: Colour, holds: Holds) -> Shape:
    """Return a forearm with a hand; if it is bare, skin has the colour of the instance."""

    def shape(shell: Shell, detail: int) -> None:
        sides = (3, 4, 6)[detail]
        ease = sleeve.value
        bare = sleeve in (Sleeve.NONE, Sleeve.SHORT)
        rows = [(-FOREARM, 0.028), (-0.17, 0.036), (-0.07, 0.043), (0.0, 0.042), (0.03, 0.026)]
        if bare:
            ups, material, region = (0.0, 0.3, 0.6, 0.9, 1.0), skin(None), SKIN
        else:
            ups, material, region = (0.0, 0.18, 0.33, 0.46, 0.5), cloth(cut), SLEEVE
        wrapped(shell, _grown(rows, thick, 0.0 if bare else ease), ups, region, material,
                sides=sides)  # fmt: skip
        if holds is not Holds.POCKET:
            _hand(shell, skin(None if bare else tone), detail)
        if holds is Holds.PHONE and detail:
            shell.box((0.05, -0.036, -FOREARM - 0.17), (0.061, 0.036, -FOREARM - 0.02),
                      cloth(tint=(0.08, 0.08, 0.1)))  # fmt: skip

    return shape


def _hand(shell: Shell, material: Material, detail: int) -> None:
    """Add a hand with its palm towards the body."""
    z = -FOREARM
    rows: list[Row] = [(z - 0.175, 0.022, 0.014, 0.009), (z - 0.13, 0.036, 0.030, 0.013),
            (z - 0.075, 0.042, 0.036, 0.016), (z - 0.02, 0.030, 0.028, 0.020),
            (z + 0.02, 0.026, 0.026, 0.024)]  # fmt: skip
    ups = [0.1 + 0.2 * k for k in range(len(rows))]
    wrapped(shell, rows, ups, SKIN, material, sides=(3, 4, 5)[detail])
    if detail == DETAILS[0]:
        path = [(0.03, 0.0, z - 0.03), (0.058, 0.0, z - 0.075), (0.055, 0.0, z - 0.105)]
        shell.tube(path, (0.013, 0.012, 0.008), material, sides=3)


@cache
def thigh(lower: Lower, thick: float, below: Colour | None, *, left: bool) -> Shape:
    """Return a thigh in the colour of the instance: that of a long garment, or of what it is
    clothed in.

    Args:
        lower: What the leg is clothed in.
        thick: See `THICKNESS`.
        below: Colour of what shows below a long garment or a skirt; None: there is none.
        left: Whether it is the left one: thighs shade each other.
    """

    def shape(shell: Shell, detail: int) -> None:
        sides = (4, 5, 7)[detail]
        rows = [
            (-THIGH - 0.02, 0.055),
            (-0.30, 0.068),
            (-0.15, 0.082),
            (-0.04, 0.086),
            (0.03, 0.060),
        ]
        ups = (0.48, 0.62, 0.78, 0.93, 1.0)
        if below is not None:
            # What the leg pushes out of a skirt or coat is cloth.
            hem = [(-0.31, 0.088), (-0.15, 0.096), (-0.03, 0.096), (0.02, 0.08)]
            wrapped(
                shell, _grown(hem, thick, 0.012), ups[1:], LEG, cloth(), sides=sides, flip=not left
            )
            bare = lower in (Lower.NONE, Lower.SKIRT)
            leg = _grown(rows[:3], thick, 0.0 if bare else 0.01)
            material = skin(below) if bare else cloth(tint=below)
            wrapped(
                shell, leg, ups[:3], SKIN if bare else LEG, material, sides=sides, flip=not left
            )
            return
        ease = {Lower.WIDE: 0.02, Lower.SHORTS: 0.018}.get(lower, 0.008)
        wrapped(shell, _grown(rows, thick, ease), ups, LEG, cloth(), sides=sides, flip=not left)

    return shape


@cache
def shank(lower: Lower, thick: float, shoes: Shoes, *, left: bool) -> Shape:
    """Return a shank in the colour of the instance, bare or clothed."""

    def shape(shell: Shell, detail: int) -> None:
        sides = (4, 5, 7)[detail]
        if lower in (Lower.TROUSERS, Lower.WIDE):
            hem = 0.058 if lower is Lower.TROUSERS else 0.085
            calf = 0.058 if lower is Lower.TROUSERS else 0.075
            tucked = shoes is Shoes.BOOTS and lower is Lower.TROUSERS
            end = (-0.32, 0.040) if tucked else (-SHANK - 0.035, hem)
            rows = [
                end,
                (-0.24 if tucked else -0.33, calf - 0.002),
                (-0.14, calf),
                (0.0, 0.062),
                (0.03, 0.045),
            ]
            wrapped(shell, _grown(rows, thick, 0.004), (0.0, 0.13, 0.3, 0.47, 0.52), LEG, cloth(),
                    sides=sides, flip=not left)  # fmt: skip
            return
        rows = [
            (-SHANK - 0.02, 0.034),
            (-0.33, 0.038),
            (-0.14, 0.054),
            (-0.05, 0.050),
            (0.0, 0.053),
            (0.03, 0.040),
        ]
        calves = [
            (z, r - (0.01 if z < -0.1 else 0.0), r + (0.012 if z < -0.1 else 0.0), r)
            for z, r, _, _ in _grown(rows, thick, 0.0)
        ]
        wrapped(shell, calves, (0.0, 0.2, 0.5, 0.7, 0.9, 1.0), SKIN, skin(None), sides=sides)

    return shape


@cache
def shoe(shoes: Shoes) -> Shape:
    """Return a shoe with its sole; its frame is level, with the origin at the ankle."""
    pale = shoes is Shoes.TRAINERS
    sole = (0.82, 0.81, 0.78) if pale else (0.09, 0.08, 0.08)

    def shape(shell: Shell, detail: int) -> None:
        sides = (4, 6, 8)[detail]
        low = -ANKLE
        edge = low + (0.03 if pale else 0.02)
        if detail:
            base: list[Row] = [(low, TOES, HEEL, 0.045), (edge, TOES, HEEL, 0.047)]
            wrapped(shell, base, (0.6, 0.65), LEG, cloth(tint=sole), sides=sides, box=0.35)
        upper: list[Row] = [
            (edge if detail else low, TOES - 0.006, HEEL - 0.004, 0.043),
            (low + 0.055, 0.150, HEEL - 0.008, 0.040),
            (low + 0.085, 0.075, HEEL - 0.010, 0.037),
            (low + 0.115, 0.045, 0.052, 0.036),
        ]
        if shoes is Shoes.BOOTS:
            upper += [(0.10, 0.060, 0.066, 0.056), (0.15, 0.062, 0.070, 0.060)]
        ups = [0.55 + 0.06 * k for k in range(len(upper))]
        wrapped(shell, upper, ups, LEG, cloth(), sides=sides, box=0.2)

    return shape
