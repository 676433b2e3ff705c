"""The kinds of things that stand on maps: their shapes, classes, solids and lights."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from eyas.engine.state.mesh import Mesh
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.build.scene_builder import Levels, SceneBuilder
from eyas.engine.world.street import signals
from eyas.engine.world.weather import Season
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.buildings import cottages
from eyas.maps.buildings.skyline import FLOOR
from eyas.maps.land import stones
from eyas.maps.plants import forest, trees
from eyas.maps.plants.foliage import in_autumn
from eyas.maps.plants.shrubs import DECIDUOUS, PLANTS
from eyas.maps.plants.wild import WILD
from eyas.maps.street import clutter, furniture, gantries, lamps, parked_cars
from eyas.maps.things import jetties, subway

if TYPE_CHECKING:
    from eyas.maps.plan.plan import ThingKind

Solid = Callable[[SceneBuilder, "ThingKind", Placed, int], None]
"""Adds what is solid of a copy of a kind: its pose, and its object."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Thing:
    """A kind of thing."""

    levels: Callable[["ThingKind", np.random.Generator, Season], Levels]
    """Returns its shape, the finest level of detail first; the origin is its foot."""
    kind: ObjectClass  # Its class: what a detector would name it, if it has such a name
    solid: str = "nothing"  # What of it is solid, a row of `SOLIDS`
    trees: int = 0  # Number of trees in it; shrubs do not count
    handed: bool = False  # Whether y and -y of it are exchanged where traffic keeps left
    light: tuple[float, float] | None = None
    """Distance along its arm and height of its light [m]; None: it gives none."""


def _upright(radius: float, top: float, *, by_size: bool = False, from_foot: bool = False) -> Solid:
    """Return the rule of a trunk or a pole, which stands on the floor unless it is `from_foot`."""

    def add(builder: SceneBuilder, kind: "ThingKind", pose: Placed, owner: int) -> None:
        size = pose.scale if by_size else 1.0
        foot = pose.z if by_size else FLOOR_HEIGHT
        high = top * size + (pose.z if from_foot else 0.0)
        builder.add_cylinder((pose.x, pose.y), radius * size, foot, high, owner)

    return add


def _car(builder: SceneBuilder, kind: "ThingKind", pose: Placed, owner: int) -> None:
    length, width, height = (pose.scale * side for side in parked_cars.solid_size(kind.variant))
    x, y = length / 2, width / 2
    outline = rounded(pose.at_corners([(-x, -y), (x, -y), (x, y), (-x, y)]))
    builder.add_prism(outline, pose.z, pose.z + height, owner)


def _cottage(builder: SceneBuilder, kind: "ThingKind", pose: Placed, owner: int) -> None:
    outline = cottages.outline_at(np.array((pose.x, pose.y)), pose.turn)
    top = FLOOR_HEIGHT + kind.storeys * FLOOR + cottages.ROOF
    builder.add_prism(outline, FLOOR_HEIGHT, top, owner)


def _gantry(builder: SceneBuilder, kind: "ThingKind", pose: Placed, owner: int) -> None:
    half = gantries.SPAN / 2
    for foot in pose.at_corners([(0.0, -half), (0.0, half)]):
        builder.add_cylinder(foot, gantries.POST_RADIUS, FLOOR_HEIGHT, gantries.POST_TOP, owner)
    outline = pose.at_corners([(-0.3, -half), (0.3, -half), (0.3, half), (-0.3, half)])
    builder.add_prism(outline, *gantries.boards_of(kind.variant), owner)


def _entrance(builder: SceneBuilder, kind: "ThingKind", pose: Placed, owner: int) -> None:
    x, y = subway.LONG / 2, subway.WIDE / 2
    outline = rounded(pose.at_corners([(-x, -y), (x, -y), (x, y), (-x, y)]))
    builder.add_prism(outline, FLOOR_HEIGHT, KERB_HEIGHT + 1.1, owner)


def _bale(builder: SceneBuilder, kind: "ThingKind", pose: Placed, owner: int) -> None:
    builder.add_cylinder(
        (pose.x, pose.y), furniture.BALE_RADIUS, pose.z, pose.z + 2 * furniture.BALE_RADIUS, owner
    )


SOLIDS: dict[str, Solid] = {
    "nothing": lambda builder, kind, pose, owner: None,
    "trunk": _upright(0.022, 0.3, by_size=True, from_foot=True),
    "street trunk": _upright(0.022, 0.3, by_size=True),
    "cone trunk": _upright(0.03, 0.5, by_size=True),
    "signal": _upright(signals.POLE_RADIUS, signals.POLE_HEIGHT),
    "lamp": _upright(lamps.POLE_RADIUS, lamps.POLE_HEIGHT),
    "car": _car,
    "cottage": _cottage,
    "gantry": _gantry,
    "entrance": _entrance,
    "bale": _bale,
}
"""Rules of what is solid of a copy."""


def _street_tree(kind: "ThingKind", rng: np.random.Generator, season: Season) -> Levels:
    made = trees.street_tree_levels(rng, kind.variant)
    if season is Season.AUTUMN:
        made = in_autumn(made, kind.variant)
    return made if kind.width == 1.0 else tuple(_widened(level, kind.width) for level in made)


def _widened(mesh: Mesh, width: float) -> Mesh:
    factor = np.array([width, width, 1.0])
    normals = mesh.normals / factor
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return replace(
        mesh,
        positions=(mesh.positions * factor).astype(np.float32),
        normals=normals.astype(np.float32),
    )


def _stand(kind: "ThingKind", rng: np.random.Generator, season: Season) -> Levels:
    """Return a stand of one of `forest.SPECIES`, or of all of them, by the variant."""
    one = forest.SPECIES[kind.variant : kind.variant + 1]
    return forest.stand_levels(one or forest.SPECIES, rng, season)


def _house(kind: "ThingKind", rng: np.random.Generator, season: Season) -> Levels:
    return cottages.cottage_levels(kind.storeys, kind.walls, kind.roof)


def _always(
    make: Callable[[], Levels],
) -> Callable[["ThingKind", np.random.Generator, Season], Levels]:
    return lambda kind, rng, season: make()


def _wild(name: str) -> Callable[["ThingKind", np.random.Generator, Season], Levels]:
    return lambda kind, rng, season: WILD[name](rng)


def _plant(name: str) -> Callable[["ThingKind", np.random.Generator, Season], Levels]:
    def levels(kind: "ThingKind", rng: np.random.Generator, season: Season) -> Levels:
        made = PLANTS[name](rng)
        turns = season is Season.AUTUMN and name in DECIDUOUS
        return in_autumn(made, DECIDUOUS.index(name)) if turns else made

    return levels


_TREE, _POLE, _GROUND = ObjectClass.TREE, ObjectClass.POLE, ObjectClass.GROUND
_STRUCTURE, _CAR = ObjectClass.STRUCTURE, ObjectClass.CAR
_LIGHT = (lamps.LIGHT[0], lamps.LIGHT[2])

THINGS: Mapping[str, Thing] = {
    "street tree": Thing(levels=_street_tree, kind=_TREE, solid="trunk", trees=1),
    "cone tree": Thing(
        levels=lambda kind, rng, season: trees.cone_tree_levels(rng, kind.variant),
        kind=_TREE,
        solid="cone trunk",
        trees=1,
    ),
    "stand": Thing(levels=_stand, kind=_TREE, trees=forest.TREES),
    **{name: Thing(levels=_plant(name), kind=_TREE) for name in PLANTS if name != "island"},
    "island": Thing(levels=_plant("island"), kind=_STRUCTURE),
    **{name: Thing(levels=_wild(name), kind=_GROUND) for name in WILD},
    "stones": Thing(
        levels=lambda kind, rng, season: stones.stone_levels(rng, kind.variant), kind=_GROUND
    ),
    "boulder": Thing(
        levels=lambda kind, rng, season: stones.boulder_levels(rng, kind.variant), kind=_GROUND
    ),
    "jetty": Thing(levels=_always(jetties.jetty_levels), kind=_STRUCTURE),
    "boat": Thing(
        levels=lambda kind, rng, season: jetties.boat_levels(kind.variant), kind=ObjectClass.BOAT
    ),
    "house": Thing(levels=_house, kind=ObjectClass.BUILDING, solid="cottage"),
    **{
        name: Thing(
            levels=_always(partial(signals.signal_levels, amber=name == "traffic light")),
            kind=_POLE,
            solid="signal",
            handed=True,
        )
        for name in ("traffic light", "dark traffic light")
    },
    "street lamp": Thing(levels=_always(lamps.lamp_levels), kind=_POLE, solid="lamp", light=_LIGHT),
    **{
        name: Thing(levels=_always(make), kind=_STRUCTURE)
        for name, make in furniture.FURNITURE.items()
    },
    **{
        name: Thing(
            levels=_always(make), kind=ObjectClass.BICYCLE if name == "bicycle rack" else _STRUCTURE
        )
        for name, make in clutter.CLUTTER.items()
    },
    "gantry": Thing(
        levels=lambda kind, rng, season: gantries.gantry_levels(kind.variant),
        kind=_POLE,
        solid="gantry",
        handed=True,
    ),
    "parked car": Thing(
        levels=lambda kind, rng, season: parked_cars.parked_car(kind.variant),
        kind=_CAR,
        solid="car",
    ),
    "parked taxi": Thing(levels=_always(parked_cars.parked_taxi), kind=_CAR, solid="car"),
    "bale": Thing(levels=_always(furniture.bale_levels), kind=_STRUCTURE, solid="bale"),
    "subway entrance": Thing(
        levels=_always(subway.entrance_levels), kind=_STRUCTURE, solid="entrance"
    ),
    "fountain": Thing(levels=_always(furniture.fountain_levels), kind=_STRUCTURE),
}
"""The kinds by name, each made of a `ThingKind` of a plan, random numbers, and the season."""
