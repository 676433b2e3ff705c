"""Textures of people: clothes with folds, faces and hair, see
`art.jointed.people.clothing`.
"""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from art.cars.regions import BASE
from art.jointed.people.clothing import CLOTHES, FACE, HAIR, HIPS, LEG, NECK, SLEEVE, TORSO
from art.textures.brush import Sheet, sheet_of, texture_of
from eyas.engine.render.textures.fields import SIZE, Field, blurred, fractal, source
from eyas.lanes import exact

Texture = NDArray[np.uint8]

_SEAM = 0.35 * BASE
_AROUND, _HIGH = 1.1, 0.7  # Size of the painted torso [m]
_FRONT, _RIGHT, _LEFT = 0.55, 0.275, 0.825  # Places around it [m]


def clothes(cut: str) -> Texture:
    """Return one of `CLOTHES`."""
    tones = np.full((SIZE, SIZE), BASE)
    torso, hips = sheet_of(tones, TORSO, (_AROUND, _HIGH)), sheet_of(tones, HIPS, (1.0, 0.2))
    sleeve, leg = sheet_of(tones, SLEEVE, (0.32, 0.55)), sheet_of(tones, LEG, (0.5, 0.88))
    _PATTERNS.get(cut, _no_pattern)(torso, sleeve)
    rng = source(f"clothes {cut}")
    # Long soft folds hang from shoulders and hips; short ones cross them.
    hanging = blurred(fractal(rng, 1.2, longest=40.0, stretch=(5.0, 1.0)), 0.8)
    crossing = blurred(fractal(rng, 1.2, longest=28.0, stretch=(1.0, 2.0)), 0.8)
    tones *= np.clip(1.0 + 0.075 * hanging + 0.05 * crossing, 0.6, 1.22)
    _torso_folds(torso)
    _CUTS[cut](torso)
    _sleeve_folds(sleeve)
    _leg_folds(leg)
    _seat(hips)
    picture = texture_of(tones)
    picture[..., 3] = 0  # no gloss
    return picture


def _bump(field: Field, middle: float, width: float) -> Field:
    """Return a smooth bump of height 1."""
    share = np.clip(1.0 - np.abs(field - middle) / width, 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share), np.float64)


def _fold(sheet: Sheet, points: list[tuple[float, float]], width: float, deep: float) -> None:
    """Draw a crease with a lit edge above it."""
    sheet.line([(x, y + 0.8 * width) for x, y in points], width, 1.12 * BASE, 0.6 * deep)
    sheet.line(points, width, 0.45 * BASE, deep)


def _torso_folds(sheet: Sheet) -> None:
    # Arms hang beside it and hide the sky from its sides.
    for side in (_RIGHT, _LEFT):
        shade = _bump(sheet.x, side, 0.15) * np.clip((0.56 - sheet.y) / 0.1, 0.0, 1.0)
        sheet.scale(1.0 - 0.42 * shade)
    sheet.scale(1.0 - 0.12 * _bump(sheet.y, 0.2, 0.1))  # the waist
    sheet.scale(1.0 + 0.1 * _bump(sheet.y, 0.62, 0.12))  # shoulders face the sky
    for middle in (_FRONT, 0.0, _AROUND):
        for sign in (-1.0, 1.0):
            armpit = middle + 0.215 * sign
            _fold(sheet, [(armpit, 0.5), (middle + 0.1 * sign, 0.43)], 0.016, 0.5)
            _fold(sheet, [(armpit, 0.46), (middle + 0.12 * sign, 0.33)], 0.02, 0.4)
            _fold(sheet, [(middle + 0.2 * sign, 0.27), (middle + 0.03 * sign, 0.21)], 0.016, 0.5)
            _fold(sheet, [(middle + 0.19 * sign, 0.2), (middle + 0.07 * sign, 0.16)], 0.014, 0.4)
    sheet.line([(0.0, 0.03), (_AROUND, 0.03)], 0.008, _SEAM, 0.7)
    sheet.scale(1.0 - 0.3 * np.clip(1.0 - sheet.y / 0.02, 0.0, 1.0))


def _seams_of_shoulders(sheet: Sheet) -> None:
    for side in (_RIGHT, _LEFT):
        for away in (-0.085, 0.085):
            sheet.line([(side + away, 0.46), (side + 0.6 * away, 0.6)], 0.008, _SEAM, 0.6)


def _plain_cut(sheet: Sheet) -> None:
    sheet.line([(0.0, 0.675), (_AROUND, 0.675)], 0.016, 0.6 * BASE, 0.7)  # the rib of the neck
    _seams_of_shoulders(sheet)


def _buttons(sheet: Sheet, low: float) -> None:
    sheet.line([(_FRONT + 0.015, low), (_FRONT + 0.015, 0.68)], 0.009, _SEAM, 0.75)
    sheet.line([(_FRONT - 0.015, low), (_FRONT - 0.015, 0.68)], 0.01, 1.1 * BASE, 0.5)
    for y in np.arange(low + 0.04, 0.66, 0.085):
        sheet.box((_FRONT - 0.007, y - 0.007), (_FRONT + 0.007, y + 0.007), 0.3 * BASE)


def _shirt_cut(sheet: Sheet) -> None:
    _buttons(sheet, 0.0)
    _seams_of_shoulders(sheet)
    sheet.box((_FRONT + 0.06, 0.4), (_FRONT + 0.15, 0.49), _SEAM, 0.45)
    sheet.box((_FRONT + 0.067, 0.407), (_FRONT + 0.143, 0.476), BASE, 0.7)
    sheet.line([(0.0, 0.55), (0.2, 0.55)], 0.008, _SEAM, 0.6)  # the yoke
    sheet.line([(_AROUND - 0.2, 0.55), (_AROUND, 0.55)], 0.008, _SEAM, 0.6)


def _jacket_cut(sheet: Sheet) -> None:
    sheet.line([(_FRONT, 0.0), (_FRONT, 0.7)], 0.024, 0.18 * BASE)
    sheet.line([(_FRONT, 0.0), (_FRONT, 0.7)], 0.007, 0.9 * BASE, 0.8)
    for sign in (-1.0, 1.0):
        pocket = [(_FRONT + 0.17 * sign, 0.07), (_FRONT + 0.11 * sign, 0.19)]
        sheet.line(pocket, 0.018, 0.3 * BASE, 0.9)
    sheet.scale(np.where(sheet.y < 0.055, 0.72, 1.0))  # the rib of the hem
    _seams_of_shoulders(sheet)
    sheet.line([(0.0, 0.56), (0.22, 0.56)], 0.009, _SEAM, 0.6)
    sheet.line([(_AROUND - 0.22, 0.56), (_AROUND, 0.56)], 0.009, _SEAM, 0.6)


def _quilted_cut(sheet: Sheet) -> None:
    sheet.line([(_FRONT, 0.0), (_FRONT, 0.7)], 0.02, 0.25 * BASE)
    for y in np.arange(0.05, 0.68, 0.082):
        sheet.scale(1.0 + 0.16 * _bump(sheet.y, float(y) + 0.05, 0.045))
        sheet.line([(0.0, float(y)), (_AROUND, float(y))], 0.013, 0.42 * BASE, 0.85)


def _coat_cut(sheet: Sheet) -> None:
    sheet.line([(_FRONT + 0.05, 0.0), (_FRONT + 0.05, 0.42)], 0.01, _SEAM, 0.85)
    for sign in (-1.0, 1.0):
        lapel = [(_FRONT, 0.43), (_FRONT + 0.09 * sign, 0.54), (_FRONT + 0.05 * sign, 0.68)]
        sheet.line(lapel, 0.013, _SEAM, 0.9)
        pocket = (_FRONT + 0.13 * sign, 0.19)
        sheet.box((pocket[0] - 0.06, 0.18), (pocket[0] + 0.06, 0.205), _SEAM, 0.8)
        sheet.box((_FRONT + 0.035 * sign - 0.01, 0.36), (_FRONT + 0.035 * sign + 0.01, 0.38),
                  0.25 * BASE)  # fmt: skip
        sheet.box((_FRONT + 0.035 * sign - 0.01, 0.27), (_FRONT + 0.035 * sign + 0.01, 0.29),
                  0.25 * BASE)  # fmt: skip
    for x in (0.0, _AROUND):  # the vent and the seam of the back
        sheet.line([(x, 0.0), (x, 0.66)], 0.012, _SEAM, 0.75)
    for middle in (0.0, _AROUND):
        sheet.box((middle - 0.16, 0.235), (middle + 0.16, 0.265), 0.75 * BASE, 0.8)
    _seams_of_shoulders(sheet)


def _sleeve_folds(sheet: Sheet) -> None:
    sheet.scale(1.0 - 0.38 * _bump(sheet.x, 0.08, 0.11))  # towards the body
    for y, deep in ((0.24, 0.6), (0.28, 0.7), (0.31, 0.5), (0.2, 0.35), (0.1, 0.35), (0.46, 0.35)):
        _fold(sheet, [(0.03, y), (0.13, y + 0.015), (0.22, y - 0.01)], 0.014, deep)
    for y in (0.07, 0.05):
        _fold(sheet, [(0.0, y), (0.32, y)], 0.012, 0.3)
    sheet.line([(0.0, 0.015), (0.32, 0.015)], 0.012, _SEAM, 0.6)


def _leg_folds(sheet: Sheet) -> None:
    sheet.scale(1.0 - 0.5 * _bump(sheet.x, 0.125, 0.13) * np.clip(sheet.y / 0.5, 0.25, 1.0))
    sheet.scale(1.0 + 0.1 * _bump(sheet.x, 0.25, 0.1) * _bump(sheet.y, 0.64, 0.25))
    sheet.line([(0.375, 0.0), (0.375, 0.88)], 0.008, _SEAM, 0.5)  # the seam outside
    for y, deep in ((0.44, 0.5), (0.41, 0.55), (0.48, 0.4)):  # behind the knee, and in front
        _fold(sheet, [(0.0, y), (0.08, y + 0.02)], 0.016, deep)
        _fold(sheet, [(0.42, y + 0.02), (0.5, y)], 0.016, deep)
        _fold(sheet, [(0.18, y), (0.3, y + 0.015)], 0.014, 0.6 * deep)
    for y, deep in ((0.06, 0.5), (0.1, 0.4), (0.14, 0.25)):
        _fold(sheet, [(0.02, y), (0.24, y + 0.015), (0.48, y - 0.01)], 0.016, deep)
    _fold(sheet, [(0.2, 0.84), (0.33, 0.76)], 0.016, 0.4)
    sheet.line([(0.0, 0.01), (0.5, 0.01)], 0.02, _SEAM, 0.5)


def _seat(sheet: Sheet) -> None:
    sheet.scale(1.0 - 0.35 * np.clip(1.0 - sheet.y / 0.05, 0.0, 1.0))
    sheet.line([(0.0, 0.185), (1.0, 0.185)], 0.03, 0.22 * BASE)  # the belt
    sheet.box((0.485, 0.172), (0.515, 0.198), 1.0)
    for x in (0.12, 0.88):
        sheet.box((x - 0.06, 0.04), (x + 0.06, 0.14), _SEAM, 0.6)
        sheet.box((x - 0.052, 0.05), (x + 0.052, 0.134), BASE, 0.8)
    for sign in (-1.0, 1.0):
        sheet.line([(0.5 + 0.2 * sign, 0.1), (0.5 + 0.13 * sign, 0.17)], 0.01, _SEAM, 0.6)
    for x in (0.0, 0.5, 1.0):
        sheet.line([(x, 0.0), (x, 0.17)], 0.012, _SEAM, 0.6)


def _no_pattern(torso: Sheet, sleeve: Sheet) -> None:
    """Leave both as they are."""


def _stripes(torso: Sheet, sleeve: Sheet) -> None:
    for sheet in (torso, sleeve):
        for y in np.arange(0.03, 0.66, 0.075):
            sheet.line([(0.0, float(y)), (_AROUND, float(y))], 0.026, 0.28 * BASE)


def _checks(torso: Sheet, sleeve: Sheet) -> None:
    for sheet in (torso, sleeve):
        for y in np.arange(0.02, 0.72, 0.085):
            sheet.line([(0.0, float(y)), (_AROUND, float(y))], 0.03, 0.35 * BASE, 0.55)
        for x in np.arange(0.0, 1.12, 0.085):
            sheet.line([(float(x), 0.0), (float(x), 0.7)], 0.03, 0.35 * BASE, 0.55)


_PATTERNS = {"striped": _stripes, "checked": _checks}
_CUTS = {
    "plain": _plain_cut,
    "striped": _plain_cut,
    "checked": _shirt_cut,
    "jacket": _jacket_cut,
    "quilted": _quilted_cut,
    "coat": _coat_cut,
}

_HEAD = (0.54, 0.235)  # Size of the painted head [m]


def heads() -> Texture:
    """Return a face with eyes, brows, nose and mouth, skin, and hair, as factors on their colours.

    Channels differ in lips and cheeks only, which are redder than the rest.
    """
    channels = [np.full((SIZE, SIZE), BASE) for _ in range(3)]
    rng = source("heads")
    strands = fractal(rng, 0.9, longest=30.0, stretch=(9.0, 1.0))
    for channel, tones in enumerate(channels):
        _face(sheet_of(tones, FACE, _HEAD), channel)
        neck = sheet_of(tones, NECK, (0.35, 0.1))
        neck.scale(0.55 + 0.3 * np.clip(1.0 - neck.y / 0.08, 0.0, 1.0))
        band = slice(HAIR.bottom - 3, HAIR.top + 3)
        tones[band] *= np.clip(1.0 + 0.3 * strands[band], 0.35, 1.7)
        parting = sheet_of(tones, HAIR, (1.0, 0.3))
        parting.scale(0.7 + 0.45 * np.clip(parting.y / 0.25, 0.0, 1.0))
    red, green, blue = (texture_of(tones) for tones in channels)
    picture = red.copy()
    picture[..., 1], picture[..., 2], picture[..., 3] = green[..., 1], blue[..., 2], 0
    return picture


def _face(sheet: Sheet, channel: int) -> None:
    """Paint a channel of a face."""
    middle = 0.5 * _HEAD[0]
    redder = (1.0, 0.62, 0.6)[channel]
    for sign in (-1.0, 1.0):
        eye = middle + 0.036 * sign
        sheet.box((eye - 0.028, 0.104), (eye + 0.028, 0.146), 0.42 * BASE, 0.8, round_=0.018)
        sheet.box((eye - 0.016, 0.117), (eye + 0.016, 0.131), 0.9, 0.8, round_=0.007)
        sheet.box((eye - 0.009, 0.115), (eye + 0.009, 0.133), 0.02)
        sheet.line([(eye - 0.02, 0.134), (eye + 0.02, 0.134)], 0.006, 0.03)
        brow = [(-0.03, 0.149), (0.004, 0.157), (0.03, 0.149)]
        sheet.line([(eye + sign * x, y) for x, y in brow], 0.012, 0.1 * BASE, 0.85)
        cheek = np.square(sheet.x - eye) + np.square(sheet.y - 0.085)
        blush = np.clip(1.0 - np.sqrt(cheek) / 0.03, 0.0, 1.0)
        sheet.scale(1.0 - 0.35 * (1.0 - redder) * blush)
        sheet.line([(middle + 0.015 * sign, 0.125), (middle + 0.02 * sign, 0.088)], 0.012,
                   0.6 * BASE, 0.6)  # fmt: skip
        sheet.line([(middle + 0.05 * sign, 0.105), (middle + 0.042 * sign, 0.03)], 0.03,
                   0.75 * BASE, 0.35)  # fmt: skip
        sheet.box((middle + 0.135 * sign - 0.014, 0.085), (middle + 0.135 * sign + 0.014, 0.145),
                  0.6 * BASE, 0.8, round_=0.01)  # fmt: skip
    sheet.box((middle - 0.016, 0.072), (middle + 0.016, 0.083), 0.3 * BASE, 0.75, round_=0.005)
    sheet.line([(middle, 0.125), (middle, 0.095)], 0.012, 1.15 * BASE, 0.7)
    sheet.box((middle - 0.028, 0.036), (middle + 0.028, 0.06), 0.5 * redder * BASE, 0.95,
              round_=0.01)  # fmt: skip
    sheet.line([(middle - 0.028, 0.049), (middle + 0.028, 0.049)], 0.006, 0.12 * BASE)
    sheet.line([(middle - 0.02, 0.026), (middle + 0.02, 0.026)], 0.012, 0.55 * BASE, 0.7)
    sheet.scale(1.0 - 0.12 * np.clip((sheet.y - 0.155) / 0.02, 0.0, 1.0))  # below the hair
    sheet.scale(1.0 - 0.3 * np.clip(1.0 - sheet.y / 0.025, 0.0, 1.0))
    turned = np.abs(sheet.x - middle) / middle
    sheet.scale(1.0 - 0.12 * exact.power(np.clip(turned, 1e-6, 1.0), 2.0))


PAINTERS: dict[str, Callable[[], Texture]] = {
    **{f"clothes_{cut}": partial(clothes, cut) for cut in CLOTHES},
    "heads": heads,
}
