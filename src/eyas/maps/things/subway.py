"""Entrances of the subway on the pavements of avenues: stairs down between green railings."""

from itertools import pairwise

import numpy as np

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import box, sphere, tube
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels

LONG, WIDE = 4.6, 1.8  # Size of the opening, along the kerb and across [m]
_GREEN = material("plain", (0.10, 0.27, 0.20))
_PIT = material("plain", (0.05, 0.05, 0.06))
_STEP = material("concrete", (0.62, 0.62, 0.60))
_GLOBE = Material(tint=(0.45, 0.85, 0.55), surface=Surface.LAMP, emission=3.0)


def entrance_levels() -> Levels:
    """Return an entrance, open towards x, the finest level of detail first."""
    return _entrance(), _far_entrance()


def _entrance() -> Mesh:
    """Return railings around three sides, stairs in a dark pit, two globes at the open end."""
    x, y = LONG / 2, WIDE / 2
    posts = [
        box((0.05, 0.05, 1.05), (at, side, 0.52), _GREEN, 1.0)
        for at in np.linspace(-x, x, 8).tolist()
        for side in (-y, y)
    ]
    rails = [
        box((LONG, 0.07, 0.07), (0.0, side, z), _GREEN, 1.0)
        for side in (-y, y)
        for z in (0.55, 1.06)
    ]
    back = [box((0.07, WIDE, 0.07), (-x, 0.0, z), _GREEN, 1.0) for z in (0.55, 1.06)]
    return concatenate([*posts, *rails, *back, _pit(), *_globes(6, 1)])


def _far_entrance() -> Mesh:
    x, y = LONG / 2, WIDE / 2
    rails = [box((LONG, 0.07, 0.3), (0.0, side, 0.95), _GREEN, 1.0) for side in (-y, y)]
    back = box((0.07, WIDE, 0.3), (-x, 0.0, 0.95), _GREEN, 1.0)
    return concatenate([*rails, back, _pit()])


def _pit() -> Mesh:
    """Return treads that darken with their depth, painted just above the pavement."""
    x, y, made = LONG / 2, WIDE / 2 - 0.08, []
    edges = np.linspace(x - 0.1, -x + 0.5, 9)
    for k, (high, low) in enumerate(pairwise(edges)):
        dark = max(0.9 - 0.12 * k, 0.08)
        tread = Material(_STEP.texture, (0.62 * dark, 0.62 * dark, 0.60 * dark))
        corners = [(low, -y, 0.02), (high, -y, 0.02), (high, y, 0.02), (low, y, 0.02)]
        made.append(quads([corners], np.zeros((1, 4, 2)), tread))
    rest = [(-x, -y, 0.02), (-x + 0.5, -y, 0.02), (-x + 0.5, y, 0.02), (-x, y, 0.02)]
    return concatenate([*made, quads([rest], np.zeros((1, 4, 2)), _PIT)])


def _globes(sides: int, subdivisions: int) -> list[Mesh]:
    x, y = LONG / 2, WIDE / 2
    ball = sphere(subdivisions, _GLOBE)
    made = []
    for side in (-y, y):
        pole = np.array([[x, side, 0.0], [x, side, 2.3]])
        made.append(tube(pole, [0.06, 0.05], sides, _GREEN))
        pose = np.array([[0.2, 0, 0, x], [0, 0.2, 0, side], [0, 0, 0.2, 2.45]])
        made.append(transformed(ball, pose))
    return made
