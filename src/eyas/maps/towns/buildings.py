"""Heights, roofs and walls of buildings of which only some is known; the rest is guessed."""

import zlib
from dataclasses import dataclass

import numpy as np
import shapely

from eyas.engine.state.mesh import Material
from eyas.engine.world.build.materials import material
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings.looks import roof_cover, wall_tint
from eyas.maps.buildings.roof_shapes import fullness
from eyas.maps.buildings.skyline import FLOOR
from eyas.maps.osm.features import House, Roof
from eyas.maps.plan.plan import Building, BuildingPart

Tint = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class _Guess:
    """What a kind of building is like."""

    levels: tuple[int, int]  # Least and largest usual number of storeys
    facades: tuple[str, ...]
    sloping: float = 0.0  # Share of sloping roofs
    shops: float = 0.0  # Share with shop windows or a lobby at street level
    storey: float = FLOOR  # Height of a storey [m]


_HOUSE = _Guess((1, 2), ("facade_plaster", "facade_brick", "facade_old"), sloping=0.95)
_TOWN = _Guess((3, 6), ("facade_plaster", "facade_old", "facade_brick", "facade_stone",
                        "facade_red_white"), sloping=0.35, shops=0.6)  # fmt: skip
_FLATS = _Guess((4, 7), ("facade_plaster", "facade_highrise", "facade_bands", "facade_old",
                         "facade_brick", "facade_concrete"), sloping=0.2, shops=0.3)  # fmt: skip
_OFFICE = _Guess((5, 10), ("facade_office", "facade_glass", "facade_stone", "facade_concrete",
                           "facade_bands"), shops=1.0)  # fmt: skip
_SHOP = _Guess((1, 3), ("facade_bands", "facade_concrete", "facade_plaster"), shops=1.0)
_HALL = _Guess((2, 3), ("facade_concrete", "facade_bands"), sloping=0.1)
_SHED = _Guess((1, 1), ("facade_plaster", "facade_concrete"), sloping=0.3)
_PUBLIC = _Guess((2, 4), ("facade_stone", "facade_concrete", "facade_brick"), sloping=0.2)
_CHURCH = _Guess((3, 4), ("facade_stone", "facade_old"), sloping=1.0, storey=4.0)

_KINDS: dict[str, _Guess] = {
    **dict.fromkeys(("house", "detached", "semidetached_house", "bungalow", "terrace", "farm",
                     "cabin", "static_caravan"), _HOUSE),
    **dict.fromkeys(("apartments", "dormitory"), _FLATS),
    **dict.fromkeys(("residential", "mixed"), _TOWN),
    **dict.fromkeys(("office", "commercial", "hotel", "bank"), _OFFICE),
    **dict.fromkeys(("retail", "supermarket", "kiosk", "shop"), _SHOP),
    **dict.fromkeys(("industrial", "warehouse", "hangar", "manufacture", "barn"), _HALL),
    **dict.fromkeys(("garage", "garages", "shed", "hut", "carport", "service", "greenhouse",
                     "farm_auxiliary", "roof", "toilets"), _SHED),
    **dict.fromkeys(("school", "university", "hospital", "public", "civic", "government",
                     "train_station", "kindergarten", "college", "museum"), _PUBLIC),
    **dict.fromkeys(("church", "cathedral", "chapel", "mosque", "temple", "synagogue"), _CHURCH),
}  # fmt: skip
_SIZES = ((40.0, _SHED), (170.0, _HOUSE), (700.0, _TOWN), (2500.0, _FLATS))
"""Buildings of no named kind are judged by their ground area, up to these [m^2]."""

_SLOPES: tuple[Roof, ...] = ("gabled", "gabled", "hipped")
_PITCH = {"gabled": 0.42, "hipped": 0.36, "pyramidal": 0.5, "skillion": 0.12, "dome": 0.5}
"""Height of a roof as a share of the width of the building."""
_NO_PARAPET, _NO_EQUIPMENT = 60.0, 250.0
"""Smaller flat roofs have no parapet, and carry nothing [m^2]."""
_SEEN_BELOW = 2.0  # Height of the foot from which one may see a building from below [m]
_SLAB = 0.5  # Thickness of a roof on posts [m]
_OPEN = ("roof", "carport")
_LEVEL = ("roof_gravel", "roof_gravel", "roof_membrane", "bitumen", "bitumen", "roof_terrace")
_AGES: tuple[Tint, ...] = (
    (1.0, 1.0, 1.0), (0.97, 0.94, 0.88), (0.82, 0.83, 0.85), (0.90, 0.86, 0.80), (0.70, 0.71, 0.73),
)  # fmt: skip
_RED = 1.15  # A colour whose red is stronger than its blue by this factor suits tiles


def is_small(house: House) -> bool:
    """Return whether a building is a house with a garden, or smaller."""
    return _guess(house) in (_HOUSE, _SHED)


def building_of(house: House, seed: int) -> Building:
    """Return a building with all that is known and guessed, whatever else is on the map."""
    corners = np.rint(1000.0 * shapely.get_coordinates(house.shape)).astype("<i8")
    chance = zlib.crc32(corners.tobytes(), seed)
    rng = np.random.Generator(np.random.PCG64(chance))
    guess = _guess(house)
    levels = int(rng.integers(guess.levels[0], guess.levels[1] + 1))
    bottom, eaves, roof, rise = _profile(house, guess, levels, rng)
    facade, tint = _walls(house, guess, rng)
    area, flat = house.shape.area, roof == "flat"
    shell = BuildingPart(
        outline=house.shape,
        bottom=FLOOR_HEIGHT + bottom,
        height=max(eaves - bottom, 0.0),
        facade=facade,
        tint=tint,
        shops=bool(bottom < 0.5 and eaves > 2 * FLOOR and rng.random() < guess.shops),
        roof=roof,
        rise=rise,
        across=house.across,
        cover=_cover(house, eaves, rng, sloping=not flat),
        parapet=area > _NO_PARAPET,
        underside=bottom > _SEEN_BELOW,
    )
    equipped = flat and area > _NO_EQUIPMENT and not house.shape.interiors
    return Building(parts=(shell,), fittings=("roof units",) if equipped else ())


def _guess(house: House) -> _Guess:
    known = _KINDS.get(house.kind)
    if known is not None:
        return known
    area = float(house.shape.area)
    return next((guess for size, guess in _SIZES if area < size), _PUBLIC)


def _profile(
    house: House, guess: _Guess, levels: int, rng: np.random.Generator
) -> tuple[float, float, Roof, float]:
    """Return foot, eaves [m], shape and height [m] of the roof; heights above the ground."""
    roof: Roof = house.roof or "flat"
    if not house.roof:
        full = fullness(house.shape)
        may = full > 0.7 and house.shape.area < 1200 and not house.shape.interiors
        sloping = may and bool(rng.random() < guess.sloping)
        roof = _SLOPES[int(rng.integers(len(_SLOPES)))] if sloping else "flat"
    rise = 0.0 if roof == "flat" else house.roof_height or _usual_rise(house.shape, roof)
    if house.levels is not None:
        levels = round(house.levels)
    if house.height is not None:
        # Of what is told of a sloping roof's top, at most half is roof.
        rise = min(rise, 0.5 * (house.height - house.bottom)) if house.roof_height is None else rise
        rise = min(rise, house.height - house.bottom - 0.1)
        eaves = house.height - rise
    else:
        eaves = max(levels, 0) * guess.storey + 0.3
        if house.levels is None:
            eaves += house.bottom
        eaves = max(eaves, house.bottom + (0.1 if rise else 2.5))
    bottom = house.bottom
    if house.kind in _OPEN and bottom < eaves - _SLAB:
        bottom = eaves - _SLAB
    return bottom, round(eaves, 3), roof, round(max(rise, 0.0), 3)


def _usual_rise(shape: shapely.Polygon, roof: str) -> float:
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(shape))
    sides = exact.hypot(*np.diff(corners[:3], axis=0).T)
    return round(float(np.clip(_PITCH[roof] * sides.min(), 0.6, 9.0)), 2)


def _walls(house: House, guess: _Guess, rng: np.random.Generator) -> tuple[str, Tint]:
    facade = guess.facades[int(rng.integers(len(guess.facades)))]
    if house.wall is None:
        return facade, wall_tint(rng)
    red, green, blue = (min(1.0, 0.12 + channel) for channel in house.wall)
    return "facade_plaster", (red, green, blue)


def _cover(house: House, eaves: float, rng: np.random.Generator, *, sloping: bool) -> Material:
    usual = roof_cover(eaves, rng, pyramid=True) if sloping else _flat_cover(rng)
    if house.cover is None:
        return usual
    red, _, blue = house.cover
    if sloping and red > _RED * blue:
        return usual
    return material("concrete", house.cover)


def _flat_cover(rng: np.random.Generator) -> Material:
    """Return gravel, felt or sheets, from pale to dark: few flat roofs are tiled."""
    name = _LEVEL[int(rng.integers(len(_LEVEL)))]
    red, green, blue = _AGES[int(rng.integers(len(_AGES)))]
    age = float(rng.uniform(0.9, 1.0))
    return material(name, (red * age, green * age, blue * age))
