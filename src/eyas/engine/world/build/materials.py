"""Materials of the maps: the names of their textures and the size of one repeat in metres."""

from dataclasses import replace

from eyas.engine.state.mesh import Material, Surface

_VEHICLES = (
    *("bodywork_saloon", "bodywork_saloon_sunroof", "bodywork_saloon_worn"),
    *("bodywork_hatch", "bodywork_hatch_sunroof", "bodywork_hatch_worn"),
    *("bodywork_van", "bodywork_van_worn", "bodywork_bus", "freight", "panes"),
)
_PEOPLE = (
    *("clothes_plain", "clothes_striped", "clothes_checked"),
    *("clothes_jacket", "clothes_quilted", "clothes_coat", "heads"),
)
FACADES = (
    "facade_concrete",
    "facade_brick",
    "facade_plaster",
    "facade_stone",
    "facade_office",
    "facade_glass",
    "facade_highrise",
    "facade_old",
    "facade_bands",
    "facade_red_white",
)
"""Walls with windows: one repeat shows four storeys and four bays, each 3 m high and wide."""

GROUND_FLOORS = ("ground_shop", "ground_lobby")
"""Street-level fronts on the same grid: each of the four rows of a repeat is one ground floor."""

TEXTURES: dict[str, float] = {
    "plain": 1.0,
    "cloth": 1.0,
    "asphalt": 8.0,
    "asphalt_light": 8.0,
    "paving": 4.0,
    "lawn": 12.0,
    "lawn_mown": 12.0,
    "soil": 8.0,
    "sand": 6.0,
    "crops": 12.0,
    "crops_ripe": 12.0,
    "crops_green": 12.0,
    "crops_yellow": 12.0,
    "crops_lilac": 12.0,
    "crops_tan": 12.0,
    "dry_leaves": 4.0,
    "snow": 8.0,
    "clinker": 4.0,
    "water": 9.0,
    "paint": 4.0,
    "asphalt_paint": 8.0,
    "asphalt_patch": 8.0,
    "asphalt_lane": 6.4,
    "asphalt_oil": 4.0,
    "manhole": 0.8,
    "concrete": 6.0,
    "bark": 2.0,
    "leaves": 3.0,
    "foliage": 3.0,
    "pale_leaves": 3.0,
    "pale_foliage": 3.0,
    "roof_tiles": 4.0,
    "roof_terrace": 8.0,
    "roof_gravel": 8.0,
    "roof_membrane": 8.0,
    "bitumen": 8.0,
    "brick": 4.0,
    "stone": 4.0,
    **dict.fromkeys(FACADES + GROUND_FLOORS, 12.0),
    **dict.fromkeys(_VEHICLES, 4.6),
    **dict.fromkeys(_PEOPLE, 1.1),
}
"""Size of one repeat of each texture [m]."""


def material(texture: str, tint: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Material:
    """Return a matt material with a texture."""
    return Material(texture=texture, tint=tint)


def without_snow(base: Material) -> Material:
    """Return a matt material on which no snow stays: a signal's, which gives no light here."""
    return replace(base, surface=Surface.SIGNAL, emission=0.0)


def facade(kind: str, tint: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Material:
    """Return a wall with windows; `kind` is one of `FACADES` or `GROUND_FLOORS`."""
    return Material(texture=kind, tint=tint, surface=Surface.FACADE)
