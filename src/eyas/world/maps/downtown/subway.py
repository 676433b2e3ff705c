"""Entrances of the subway on the pavements of avenues: stairs down between green railings."""

from itertools import pairwise

import numpy as np
import shapely

from eyas.core import exact
from eyas.mesh.assembly import concatenate, transformed
from eyas.mesh.flat import quads
from eyas.mesh.solids import box, sphere, tube
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.world.build.materials import material
from eyas.world.build.millimetres import rounded, unit
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.roads.areas import joints, streets

__all__ = ["add_entrances"]

_SHARE = 0.3
"""Share of the ends of wide roads with an entrance."""
_LONG, _WIDE = 4.6, 1.8
"""Size of the opening, along the kerb and across [m]."""
_FROM_END, _BEYOND = 9.0, 2.3
"""From the end of the road, and from the kerb, to the middle [m]."""
_GREEN = material("plain", (0.10, 0.27, 0.20))
_PIT = material("plain", (0.05, 0.05, 0.06))
_STEP = material("concrete", (0.62, 0.62, 0.60))
_GLOBE = Material(tint=(0.45, 0.85, 0.55), surface=Surface.LAMP, emission=3.0)


def add_entrances(
    builder: SceneBuilder,
    network: RoadNetwork,
    keep_free: shapely.Geometry,
    rng: np.random.Generator,
) -> shapely.Geometry:
    """Add entrances beside the ends of wide roads; return the area that they take [m].

    Args:
        builder: The builder to add to.
        network: The roads.
        keep_free: Area where something else stands or drives [m].
        rng: Random numbers of the street furniture.
    """
    kind = builder.prototype("subway entrance", lambda: (_entrance(), _far_entrance()))
    meeting = joints(network)
    taken = []
    for street in streets(network):
        end = street.right[-1]
        onwards = unit(end - street.right[-2])
        leftwards = np.array([-onwards[1], onwards[0]])
        place = rounded(end - _FROM_END * onwards - _BEYOND * leftwards)
        area = shapely.Point(place).buffer(0.5 * _LONG + 0.3)
        wide = len(street.dividers) > 0 and meeting[street.end] >= 3
        if (
            wide
            and rng.random() < _SHARE
            and not shapely.intersects(keep_free, shapely.Point(place).buffer(0.5 * _WIDE + 0.4))
        ):
            turn = float(exact.atan2(onwards[1], onwards[0]))
            spot = (float(place[0]), float(place[1]), KERB_HEIGHT)
            owner = builder.add_copy(ObjectClass.STRUCTURE, kind, spot, turn, 1.0)
            half = 0.5 * np.array([_LONG, _WIDE])
            corners = place + np.stack(
                [half[0] * a * onwards + half[1] * b * leftwards
                 for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            )  # fmt: skip
            builder.add_prism(rounded(corners), FLOOR_HEIGHT, KERB_HEIGHT + 1.1, owner)
            taken.append(area)
    return shapely.union_all(taken)


def _entrance() -> Mesh:
    """Return railings around three sides, stairs in a dark pit, two globes at the open end."""
    x, y = _LONG / 2, _WIDE / 2
    posts = [
        box((0.05, 0.05, 1.05), (at, side, 0.52), _GREEN, 1.0)
        for at in np.linspace(-x, x, 8).tolist()
        for side in (-y, y)
    ]
    rails = [
        box((_LONG, 0.07, 0.07), (0.0, side, z), _GREEN, 1.0)
        for side in (-y, y)
        for z in (0.55, 1.06)
    ]
    back = [box((0.07, _WIDE, 0.07), (-x, 0.0, z), _GREEN, 1.0) for z in (0.55, 1.06)]
    return concatenate([*posts, *rails, *back, _pit(), *_globes(6, 1)])


def _far_entrance() -> Mesh:
    x, y = _LONG / 2, _WIDE / 2
    rails = [box((_LONG, 0.07, 0.3), (0.0, side, 0.95), _GREEN, 1.0) for side in (-y, y)]
    back = box((0.07, _WIDE, 0.3), (-x, 0.0, 0.95), _GREEN, 1.0)
    return concatenate([*rails, back, _pit()])


def _pit() -> Mesh:
    """Return treads that darken with their depth, painted just above the pavement."""
    x, y, made = _LONG / 2, _WIDE / 2 - 0.08, []
    edges = np.linspace(x - 0.1, -x + 0.5, 9)
    for k, (high, low) in enumerate(pairwise(edges)):
        dark = max(0.9 - 0.12 * k, 0.08)
        tread = Material(_STEP.texture, (0.62 * dark, 0.62 * dark, 0.60 * dark))
        corners = [(low, -y, 0.02), (high, -y, 0.02), (high, y, 0.02), (low, y, 0.02)]
        made.append(quads([corners], np.zeros((1, 4, 2)), tread))
    rest = [(-x, -y, 0.02), (-x + 0.5, -y, 0.02), (-x + 0.5, y, 0.02), (-x, y, 0.02)]
    return concatenate([*made, quads([rest], np.zeros((1, 4, 2)), _PIT)])


def _globes(sides: int, subdivisions: int) -> list[Mesh]:
    x, y = _LONG / 2, _WIDE / 2
    ball = sphere(subdivisions, _GLOBE)
    made = []
    for side in (-y, y):
        pole = np.array([[x, side, 0.0], [x, side, 2.3]])
        made.append(tube(pole, [0.06, 0.05], sides, _GREEN))
        pose = np.array([[0.2, 0, 0, x], [0, 0.2, 0, side], [0, 0, 0.2, 2.45]])
        made.append(transformed(ball, pose))
    return made
