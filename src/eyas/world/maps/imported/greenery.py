"""Trees of imported towns: those the map names, and those that usually stand where it is silent."""

from collections.abc import Mapping, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core import exact
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.scene_builder import Prototype, SceneBuilder
from eyas.world.maps.imported.plan import Plan
from eyas.world.osm.features import Features
from eyas.world.plants import gardens
from eyas.world.roads.areas import polygons_of
from eyas.world.street.bays import bays_in
from eyas.world.street.parked_cars import add_car

__all__ = ["add_greenery", "add_parked"]

_USUAL = (6.5, 12.5)
"""Heights of trees of which the map tells none [m]."""
_TRUNK = 1.0
"""Room around a trunk [m]."""
_GUESSED: dict[str, tuple[tuple[float, float], float, float]] = {
    "forest": ((8.0, 15.0), 6.5, 0.03),
    "park": ((6.0, 13.0), 12.0, 0.0022),
    "scrub": ((2.0, 4.0), 6.0, 0.01),
    "residential": ((4.0, 8.5), 13.0, 0.0014),
    "grass": ((4.0, 9.0), 18.0, 0.0007),
}
"""Heights, least distance [m] and attempts on a square metre, by the kind of ground."""
_MOST = 6000
"""Largest number of trees that are guessed."""
_KNOWN = 1 / 900.0
"""Ground with more trees of the map than this on a square metre gets no others."""
_OCCUPIED = 0.6
"""Share of the bays with a car."""


def add_greenery(
    builder: SceneBuilder,
    plan: Plan,
    features: Features,
    kinds: Sequence[Prototype],
    plants: Mapping[str, Prototype],
    rng: np.random.Generator,
) -> None:
    """Plant trees, and hedges along houses.

    Args:
        builder: The builder to add to.
        plan: The plan of the town.
        features: The trees that the map names.
        kinds: Prototypes of trees 1 m high.
        plants: Other plants, by the names of `plant_makers`.
        rng: Random numbers of the plants.
    """
    solid = shapely.union_all([plan.roads, plan.built, plan.ground["water"], plan.ground["rail"]])
    occupied = shapely.buffer(solid, _TRUNK, quad_segs=2)
    shapely.prepare(occupied)
    known = np.array(features.trees, np.float64).reshape(-1, 3)
    known = known[~shapely.contains_xy(occupied, known[:, 0], known[:, 1])]
    for x, y, told in known.tolist():
        low, high = (told, told) if told else _USUAL
        spot = np.array([[x, y]])
        gardens.add_small_trees(builder, spot, (low, high), FLOOR_HEIGHT, kinds, rng)
    left = _MOST
    for kind, (heights, apart, density) in _GUESSED.items():
        spots = [np.zeros((0, 2))]
        for area in polygons_of(plan.ground[kind]):
            there = int(shapely.contains_xy(area, known[:, 0], known[:, 1]).sum())
            if there < _KNOWN * area.area:
                room = shapely.difference(area, occupied)
                spots.append(gardens.scattered(room, apart, density, rng))
        chosen = np.concatenate(spots)[:left]
        left -= len(chosen)
        gardens.add_small_trees(builder, chosen, heights, FLOOR_HEIGHT, kinds, rng)
    corners = [_outline(shape) for shape in plan.gardens]
    room = shapely.union(plan.ground["residential"], plan.lawn)
    gardens.add_borders(builder, corners, room, FLOOR_HEIGHT, plants, rng)


def add_parked(
    builder: SceneBuilder,
    plan: Plan,
    cars: Sequence[Prototype],
    rng: np.random.Generator,
) -> list[shapely.Polygon]:
    """Fill car parks with rows of bays and cars; return the paint between the bays [m].

    Args:
        builder: The builder to add to.
        plan: The plan of the town.
        cars: Prototypes of cars.
        rng: Random numbers of the cars.
    """
    lines: list[shapely.Polygon] = []
    walls = shapely.buffer(plan.built, 0.8, quad_segs=3)
    for area in polygons_of(plan.ground["parking"]):
        bays, paint = bays_in(shapely.difference(area, walls))
        lines += paint
        for x, y, turn in bays:
            if rng.random() < _OCCUPIED:
                way = turn + np.pi * float(rng.random() < 0.4) + exact.normal(rng, 0, 0.015)
                car = cars[int(rng.integers(len(cars)))]
                spot = (x + exact.normal(rng, 0, 0.06), y + exact.normal(rng, 0, 0.06), 0.0)
                add_car(builder, car, spot, way, float(rng.uniform(0.94, 1.04)))
    return lines


def _outline(shape: shapely.Polygon) -> NDArray[np.float64]:
    ring = shapely.geometry.polygon.orient(shape).exterior
    return np.ascontiguousarray(shapely.get_coordinates(ring)[:-1])
