"""Solid shapes of a scene, as outlines."""

from collections.abc import Iterator

import shapely

from eyas.state.scene import Colliders

__all__ = ["is_inside", "solids"]


def solids(colliders: Colliders) -> Iterator[tuple[shapely.Polygon, float, float]]:
    """Yield outline, bottom and top of each solid prism [m]."""
    first = colliders.prism_first
    for index, bottom in enumerate(colliders.prism_bottom):
        corners = colliders.prism_points[first[index] : first[index + 1]]
        yield shapely.Polygon(corners), float(bottom), float(colliders.prism_top[index])


def is_inside(colliders: Colliders, position: tuple[float, float, float]) -> bool:
    """Return whether a position is inside a solid."""
    x, y, z = position
    return any(
        bottom <= z <= top and bool(shapely.contains_xy(outline, x, y))
        for outline, bottom, top in solids(colliders)
    )
