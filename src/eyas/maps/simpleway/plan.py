"""The plan of the simple maps: roads, and the ground of a skin."""

from dataclasses import replace
from functools import reduce

import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ObjectClass
from eyas.maps.land.ground import blob, rectangle
from eyas.maps.plan.plan import Chance, Far, Flat, GroundCover, Layer, MapPlan, Paint, Roadway
from eyas.maps.simpleway.layout import FLOOR, loop_lines, paved, sand_bars
from eyas.maps.simpleway.roads import road_lines
from eyas.maps.simpleway.scenery import SKINS, Skin

_BANK = 2.5  # Bare ground between a road and a strip, at least [m]
_BAR_HEIGHT = 0.03  # z of the bars of sand [m]
_SPOTS = 320
_SPOT = (8.0, 40.0)  # Number and mean radius of the patches of another tint [m]
_DRIFTS = ((0.975, 0.98, 0.985), (0.985, 0.985, 0.98))
"""Their tints in snow: no grass shows through it."""


def make_plan(skin_name: str, network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of a simple map.

    Args:
        skin_name: One of `SKINS`.
    """
    skin, roads = SKINS[skin_name], paved(network)
    layers: list[Layer] = [
        Roadway(
            area=roads,
            paint=Paint(crossings=0, lines=tuple(loop_lines(network))),
            wear=Chance(stream="simpleway road wear"),
            apart=5.0,
        )
    ]
    if skin.bars:
        bars = sand_bars(road_lines(seed), roads, stream(seed, "simpleway bars"))
        flat = (Flat(area=bar, z=_BAR_HEIGHT, cover=skin.ground, cells="whole") for bar in bars)
        layers.append(GroundCover(pieces=tuple(flat)))
    rest, banks = shapely.difference(rectangle(*FLOOR), roads), shapely.buffer(roads, _BANK)
    white: list[Flat] = []
    for patch in skin.patches(road_lines(seed), stream(seed, "simpleway strips")):
        area = shapely.difference(patch.area, banks)
        piece = Flat(area=area, cover=patch.cover, cells="wide")
        if patch.in_winter:
            white.append(piece)
            continue
        water = patch.cover.surface == Surface.WATER
        kind = ObjectClass.WATER if water else ObjectClass.GROUND
        layers.append(GroundCover(kind=kind, pieces=(piece,)))
        rest = shapely.difference(rest, area)
    snow = None if skin.bars else skin.winter  # sand stays bare
    far = Far(rule="plain", covers=(skin.ground,), winter=(snow,) if snow else ())
    bare: tuple[Flat | Far, ...] = (*_spotted(rest, skin, snow, seed), far)
    layers.append(GroundCover(season="summer" if white else None, pieces=bare))
    if white:
        layers += [GroundCover(season="winter", pieces=(piece,)) for piece in white]
        rest = reduce(shapely.difference, (piece.area for piece in white), rest)
        bare = (*_spotted(rest, skin, snow, seed), far)
        layers.append(GroundCover(season="winter", pieces=bare))
    return MapPlan(
        name="simpleway", seed=seed, size=FLOOR, layers=tuple(layers), horizon=skin.horizon
    )


def _spotted(area: shapely.Geometry, skin: Skin, snow: Material | None, seed: int) -> list[Flat]:
    """Return the ground, with patches of other tints along the roads."""
    rng = stream(seed, "simpleway spots")
    count = len(skin.tints)
    spots: list[list[shapely.Polygon]] = [[] for _ in range(count)]
    lines = road_lines(seed)
    for index in range(_SPOTS):
        south, north = lines[int(rng.integers(len(lines)))]
        middle = south + rng.random() * (north - south) + rng.uniform(-60.0, 60.0, 2)
        spots[index % count].append(blob(middle, float(rng.uniform(*_SPOT)), rng))
    made, rest = [], area
    for tint, drift, shapes in zip(skin.tints, _DRIFTS, spots, strict=True):
        some = shapely.union_all(shapes)
        made.append(
            Flat(
                area=shapely.intersection(rest, some),
                cover=_tinted(skin.ground, tint),
                winter=snow and _tinted(snow, drift),
                cells="wide",
            )
        )
        rest = shapely.difference(rest, some)
    return [*made, Flat(area=rest, cover=skin.ground, winter=snow, cells="wide")]


def _tinted(cover: Material, tint: tuple[float, float, float]) -> Material:
    red, green, blue = (a * b for a, b in zip(cover.tint, tint, strict=True))
    return replace(cover, tint=(red, green, blue))
