"""Bare layouts: the roads of a map on plain ground, without scenery or anything that hides."""

from typing import Literal

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.lighting import Horizon
from eyas.engine.state.mesh import Material
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.roads.areas import road_area
from eyas.maps.land.ground import blob, rectangle
from eyas.maps.plan.plan import Chance, Far, Flat, GroundCover, MapPlan, Paint, Roadway

_PATCHES = 70
_PATCH = (8.0, 34.0)  # Number and mean radius of the patches of another tint [m]
_PALER, _DARKER = 1.06, 0.93  # Factors on the ground's colour in them


def make_plan(
    name: str,
    network: RoadNetwork,
    seed: int,
    floor: tuple[float, float],  # Extent of the floor [m]
    cover: Material,
    horizon: Horizon,  # Hills beyond the map
    # The line between the two directions of a road
    centre: Literal["white", "double yellow"] = "white",
) -> MapPlan:
    """Return roads on plain ground."""
    roads = road_area(network)
    bare = shapely.difference(rectangle(*floor), roads)
    ground = _patchy(bare, floor, cover, stream(seed, f"{name} ground"))
    return MapPlan(
        name=name,
        seed=seed,
        size=floor,
        layers=(
            Roadway(
                area=roads,
                paint=Paint(centre=centre, crossings=0),
                wear=Chance(stream=f"{name} road wear"),
            ),
            GroundCover(pieces=(*ground, Far(rule="plain", covers=(cover,)))),
        ),
        horizon=horizon,
    )


def _patchy(
    area: shapely.Geometry, floor: tuple[float, float], cover: Material, rng: np.random.Generator
) -> list[Flat]:
    """Return ground with paler and darker patches, so that a camera sees that it moves."""
    made: list[Flat] = []
    half = 0.5 * np.array(floor)
    for shade in (_PALER, _DARKER):
        middles = rng.uniform(-half, half, (_PATCHES, 2))
        spots = shapely.union_all([blob(at, float(rng.uniform(*_PATCH)), rng) for at in middles])
        red, green, blue = (min(1.0, shade * channel) for channel in cover.tint)
        tinted = Material(cover.texture, (red, green, blue), cover.surface)
        made.append(Flat(area=shapely.intersection(area, spots), cover=tinted))
        area = shapely.difference(area, spots)
    return [*made, Flat(area=area, cover=cover)]
