"""The scene of an imported town."""

from functools import partial

import numpy as np
import shapely

from eyas.core.rng import stream
from eyas.state.roads import RoadNetwork
from eyas.state.scene import Lamps, ObjectClass, Scene
from eyas.state.terrain import Terrain
from eyas.world.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.buildings import rooftops
from eyas.world.maps.imported.building import building_mesh, solids_of
from eyas.world.maps.imported.crosswalks import footways, kept_free
from eyas.world.maps.imported.greenery import add_greenery, add_parked
from eyas.world.maps.imported.ground import add_ground
from eyas.world.maps.imported.lamps import add_lamps_at, usual_lamps
from eyas.world.maps.imported.looks import Look
from eyas.world.maps.imported.plan import Plan, make_plan
from eyas.world.osm.features import Features
from eyas.world.plants import trees
from eyas.world.plants.shrubs import plant_makers
from eyas.world.roads.areas import streets
from eyas.world.street import signals
from eyas.world.street.furnishing import add_furniture
from eyas.world.street.parked_cars import VARIANTS, parked_car

__all__ = ["build_scene"]

_WIDE = 3.5
"""Width of pavements from which things may stand anywhere on them [m]."""
_AT_KERB = 1.3
"""On narrower ones they stand nearer to the kerb [m]."""
_NO_EQUIPMENT = 250.0
"""Smaller flat roofs carry nothing [m^2]."""


def build_scene(
    name: str, size: tuple[float, float], network: RoadNetwork, features: Features, seed: int
) -> Scene:
    """Return an imported town.

    Args:
        name: Name of the map.
        size: Extent of the floor [m].
        network: The streets.
        features: What the map tells besides.
        seed: Seed of what it does not tell.
    """
    plan = make_plan(network, features, size, seed)
    builder = SceneBuilder(name, seed, size, Terrain.flat(FLOOR_HEIGHT))
    trunks, beds = stream(seed, "imported trees"), stream(seed, "imported gardens")
    kinds = [
        builder.prototype(f"street tree {k}", partial(trees.street_tree_levels, trunks, k), trees=1)
        for k in range(trees.VARIANTS)
    ]
    # The largest occluders come first: they are drawn first, so less is drawn twice.
    for look in sorted(plan.buildings, key=lambda look: -look.top * look.shape.length):
        _add_building(builder, look)
    cars = [builder.prototype(f"parked car {k}", partial(parked_car, k)) for k in range(VARIANTS)]
    bays = add_parked(builder, plan, cars, stream(seed, "imported parked cars"))
    add_ground(builder, plan, network, features, bays, stream(seed, "imported ground"))
    poles = _add_signals(builder, network, plan, features)
    ends = kept_free(plan.crosswalks)
    taken = shapely.union_all([plan.roads, plan.built, plan.ground["water"], poles, ends])
    lights = _lights(builder, network, features, taken, seed)
    feet = shapely.buffer(shapely.points(lights.position[:, :2].astype(float)), 4.0)
    taken = shapely.union_all([taken, *feet])
    rng = stream(seed, "imported furniture")
    add_furniture(builder, network, _room_to_furnish(plan), taken, KERB_HEIGHT, rng)
    plants = {name: builder.prototype(name, make) for name, make in plant_makers(beds).items()}
    add_greenery(builder, plan, features, kinds, plants, stream(seed, "imported plants"))
    scene = builder.build(network, lights)
    scene.footways = footways(plan.roads, plan.crosswalks)
    return scene


def _add_building(builder: SceneBuilder, look: Look) -> None:
    owner = builder.add(ObjectClass.BUILDING, building_mesh(look))
    for outline, bottom, top in solids_of(look):
        builder.add_prism(outline, bottom, top, owner)
    if look.roof == "flat" and look.shape.area > _NO_EQUIPMENT and not look.shape.interiors:
        rng = np.random.Generator(np.random.PCG64(look.chance + 1))
        outline = shapely.get_coordinates(look.shape.exterior)[:-1]
        rooftops.add_rooftop(builder, outline, look.eaves, owner, shapely.Polygon(), rng)


def _add_signals(
    builder: SceneBuilder, network: RoadNetwork, plan: Plan, features: Features
) -> shapely.Geometry:
    """Add a traffic light at the end of each street that has one; return where they stand [m]."""
    prototype = builder.prototype("traffic light", partial(signals.signal_levels, amber=False))
    lit, feet = set(features.signals), []
    for name, street in zip(network.edges, streets(network), strict=True):
        if name not in lit or len(street.right) < 2:
            continue
        foot, turn = signals.pole_at(street)
        if shapely.distance(plan.roads, shapely.Point(foot)) <= signals.POLE_RADIUS:
            continue
        owner = builder.add_copy(ObjectClass.POLE, prototype, (*foot, 0.0), turn, 1.0)
        radius, top = signals.POLE_RADIUS, signals.POLE_HEIGHT
        builder.add_cylinder(foot, radius, FLOOR_HEIGHT, top, owner)
        feet.append(shapely.Point(foot).buffer(1.0))
    return shapely.union_all(feet)


def _room_to_furnish(plan: Plan) -> shapely.Geometry:
    """Return the pavements [m], of narrow ones only the side at the kerb, so that one can pass."""
    inside = shapely.buffer(plan.pavement, -_WIDE / 2, join_style="mitre")
    wide = shapely.buffer(inside, _WIDE / 2, join_style="mitre")
    at_kerb = shapely.buffer(plan.roads, _AT_KERB, quad_segs=3)
    return shapely.union(
        shapely.intersection(plan.pavement, wide), shapely.intersection(plan.pavement, at_kerb)
    )


def _lights(
    builder: SceneBuilder,
    network: RoadNetwork,
    features: Features,
    taken: shapely.Geometry,
    seed: int,
) -> Lamps:
    """Add the lamps that the map names; if it names none, as many as streets usually have."""
    if features.lamps:
        return add_lamps_at(builder, network, features.lamps, taken)
    places = usual_lamps(network, taken, stream(seed, "imported lamps"))
    return add_lamps_at(builder, network, places, taken)
