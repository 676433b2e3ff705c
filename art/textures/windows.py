"""Painting of windows into walls: a grid of four storeys and four bays, 64 pixels each.

Rows grow downwards; row 0 of a storey is its top.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from art.textures.fields import Picture
from eyas.engine.render.textures.fields import SIZE, Field, fractal, white
from eyas.lanes import exact

BAY = 64  # Pixels in a bay and in a storey: 3 m

Colour = tuple[float, float, float]

_CURTAINS: tuple[Colour, ...] = (
    (206.0, 198.0, 182.0),
    (188.0, 184.0, 178.0),
    (196.0, 176.0, 148.0),
    (150.0, 158.0, 168.0),
    (214.0, 210.0, 202.0),
    (120.0, 84.0, 70.0),
    (96.0, 112.0, 104.0),
    (228.0, 224.0, 214.0),
)

_SKY: Colour = (142.0, 164.0, 190.0)
_TONES, _SHARES = (0.45, 0.75, 1.0, 1.35), (0.3, 0.3, 0.25, 0.15)


@dataclass(frozen=True, slots=True)
class Opening:
    """A window or door in a bay, in pixels from the bay's upper left corner."""

    left: int
    top: int
    right: int
    bottom: int
    frame: Colour = (226.0, 224.0, 218.0)  # Colour of frame and bars
    thick: int = 2  # Width of the frame
    upright: int = 1  # Number of vertical bars
    level: int = 0  # Number of horizontal bars
    glass: Colour = (46.0, 56.0, 66.0)  # Colour of a dark room behind it
    curtained: float = 0.45  # Share of windows with a blind or curtains


class Wall:
    """A wall that is being painted: its colours, and the areas of glass."""

    def __init__(self, surface: Picture, rng: np.random.Generator) -> None:
        self.picture = surface.copy()
        self.glass = np.zeros((SIZE, SIZE), np.bool_)
        self._rng = rng
        self._grain = 1 + 0.02 * white(rng)

    def rect(self, left: int, top: int, right: int, bottom: int, colour: Colour) -> None:
        """Paint an opaque rectangle; parts beyond one edge reappear at the opposite edge."""
        rows = np.arange(top, bottom) % SIZE
        columns = np.arange(left, right) % SIZE
        box = np.ix_(rows, columns)
        self.picture[box] = np.array(colour) * self._grain[box][..., None]
        self.glass[box] = False

    def shade(self, left: int, top: int, right: int, bottom: int, factor: float) -> None:
        """Darken or lighten a rectangle."""
        self.picture[np.ix_(np.arange(top, bottom) % SIZE, np.arange(left, right) % SIZE)] *= factor

    def everywhere(self) -> list[tuple[int, int]]:
        """Return the upper left corners of all bays."""
        return [(x, y) for y in range(0, SIZE, BAY) for x in range(0, SIZE, BAY)]

    def window(self, x: int, y: int, opening: Opening) -> None:
        """Paint a window into the bay at (x, y)."""
        left, top, right, bottom = (
            x + opening.left,
            y + opening.top,
            x + opening.right,
            y + opening.bottom,
        )
        self.rect(left, top, right, bottom, opening.frame)
        self.shade(left, bottom - 1, right, bottom, 0.75)
        t = opening.thick
        self._room(left + t, top + t, right - t, bottom - t, opening)
        for k in range(1, opening.upright + 1):
            at = left + round(k * (right - left) / (opening.upright + 1))
            self.rect(at - 1, top + t, at + 1, bottom - t, opening.frame)
        for k in range(1, opening.level + 1):
            at = top + round(k * (bottom - top) / (opening.level + 1))
            self.rect(left + t, at - 1, right - t, at + 1, opening.frame)
        # The wall's own depth casts a shadow on the window's top and one side.
        self.shade(left, top, right, top + 3, 0.55)
        self.shade(left, top + 3, left + 2, bottom, 0.75)

    def _room(self, left: int, top: int, right: int, bottom: int, opening: Opening) -> None:
        """Paint the view through a pane: a dark room, and perhaps a blind or curtains."""
        rng, height, width = self._rng, bottom - top, right - left
        # Rooms are deep and dark, or bright; some panes hang askew and mirror more of the sky.
        tone = np.array(opening.glass) * rng.choice(
            (0.45, 0.75, 1.0, 1.35), p=(0.3, 0.3, 0.25, 0.15)
        )
        if rng.random() < 0.16:
            tone = np.array(_SKY) * rng.uniform(0.55, 1.0)
        fade = np.linspace(1.3, 0.7, height)[:, None, None]
        pane = np.broadcast_to(tone * fade, (height, width, 3)).copy()
        if rng.random() < opening.curtained:
            cloth = np.array(_CURTAINS[int(rng.integers(len(_CURTAINS)))]) * rng.uniform(0.45, 1.0)
            if rng.random() < 0.6:
                drop = round(height * rng.uniform(0.2, 1.0))
                slats = 1 - 0.12 * (np.arange(drop) % 3 == 0)
                pane[:drop] = cloth * slats[:, None, None]
            else:
                side = max(2, round(width * rng.uniform(0.15, 0.34)))
                folds = 0.88 + 0.12 * exact.cos(np.arange(side) * 1.9)
                pane[:, :side] = cloth * folds[None, :, None]
                pane[:, width - side :] = cloth * folds[None, ::-1, None]
        box = np.ix_(np.arange(top, bottom) % SIZE, np.arange(left, right) % SIZE)
        self.picture[box] = pane
        self.glass[box] = True

    def sill(self, x: int, y: int, opening: Opening, colour: Colour, *, deep: int = 3) -> None:
        """Paint a sill under a window, its shadow, and the dirt that runs down beside it."""
        left, right, bottom = x + opening.left - 2, x + opening.right + 2, y + opening.bottom
        self.rect(left, bottom, right, bottom + deep, colour)
        self.shade(left, bottom + deep, right, bottom + deep + 2, 0.72)
        for edge in (left, right - 3):
            self.shade(edge, bottom + deep + 2, edge + 3, min(bottom + deep + 12, y + BAY), 0.93)

    def band(self, y: int, tall: int, colour: Colour, *, shadow: int = 2) -> None:
        """Paint a band across all bays with a shadow below it."""
        self.rect(0, y, SIZE, y + tall, colour)
        self.shade(0, y, SIZE, y + 1, 1.08)
        self.shade(0, y + tall, SIZE, y + tall + shadow, 0.72)

    def balcony(self, x: int, y: int, left: int, right: int, slab: Colour, rail: Colour) -> None:
        """Paint a balcony over the lower part of a bay: slab, shadow, rail with bars."""
        foot = y + BAY - 4
        self.shade(x + left, foot - 30, x + right, foot, 0.8)
        self.rect(x + left, foot, x + right, foot + 4, slab)
        self.shade(x + left + 2, foot + 4, x + right + 2, foot + 10, 0.6)
        for bar in range(x + left, x + right, 4):
            self.rect(bar, foot - 21, bar + 1, foot, rail)
        self.rect(x + left, foot - 23, x + right, foot - 21, rail)

    def finished(self) -> NDArray[np.uint8]:
        """Return the texture; alpha is 0 on glass."""
        weather = 1 + 0.045 * fractal(self._rng, 1.1, longest=150.0, stretch=(3.5, 1.0))
        weathered: Field = np.where(self.glass, 1.0, weather)
        colour = np.clip(np.round(self.picture * weathered[..., None]), 0, 255)
        alpha = np.where(self.glass, 0.0, 255.0)[..., None]
        return np.concatenate([colour, alpha], axis=2).astype(np.uint8)
