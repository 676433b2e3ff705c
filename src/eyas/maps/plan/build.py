"""The scene of a plan: every layer as triangles, copies, and solids, in its order."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
import shapely

from eyas.engine.mesh.assembly import concatenate, mirrored
from eyas.engine.mesh.flat import flat_polygons, quads
from eyas.engine.mesh.solids import box
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import Footways, Lamps, ObjectClass, Scene
from eyas.engine.state.terrain import Terrain
from eyas.engine.world.build.materials import TEXTURES
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.build.scene_builder import Levels, Prototype, SceneBuilder
from eyas.engine.world.roads.areas import kerbstones, polygons_of, skirt, surface
from eyas.engine.world.weather import Season
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings import facades, parts, rooftops
from eyas.maps.land import ground, outskirts
from eyas.maps.land.ground import asphalt
from eyas.maps.land.relief import kinds_of, relief_of, snow_over, surface_of, terrain_of
from eyas.maps.plan import plan as p
from eyas.maps.roads import markings, overpass, painting, tunnels
from eyas.maps.roads.wear import road_wear, worn_lanes
from eyas.maps.things import fronts, railway, skyways
from eyas.maps.things.fields import field_mesh, slope
from eyas.maps.things.kinds import SOLIDS, THINGS

_NEAR = 80.0  # Reach of the ground that is cut into small squares beside streets [m]
_SLOPE = 1.4  # Width of the slope around a heap [m]
_SNOW_FRINGE = 12.0
"""Depth below the line where snow begins down to which there are patches of it [m]."""
_SUNK = 0.015
"""How far the sides of a slab stand back from its edge, clear of those of others beside it [m]."""
_HIGHEST_UNITS = 170.0
"""Roofs above this height on which something else stands carry nothing: no camera sees it [m]."""
_LAMP_HEIGHTS = (6.75, 6.6)  # z of the lamps in a tunnel, and of their lights [m]


def build_scene(
    plan: p.MapPlan,  # A complete plan, without what `eyas.maps.plan.file.problems` tells
    network: RoadNetwork,  # What SUMO has made of its roads
    season: Season = Season.SUMMER,  # Season of trees, crops and hills
) -> Scene:
    """Return the scene of a plan."""
    work = _Work(plan, network, season)
    for layer in plan.layers:
        _MAKERS[type(layer)](work, layer)
    return work.scene()


@dataclass
class _Work:
    """A scene under construction."""

    plan: p.MapPlan
    network: RoadNetwork
    season: Season
    builder: SceneBuilder = field(init=False)
    lights: list[tuple[Any, Any]] = field(default_factory=list)  # Position and axis of each lamp

    def __post_init__(self) -> None:
        plan = self.plan
        rising = [layer for layer in plan.layers if isinstance(layer, p.Hills)]
        ground = Terrain.flat(FLOOR_HEIGHT)
        if rising:
            ground = terrain_of(relief_of(rising[0], plan.seed), FLOOR_HEIGHT, rising[0].half[1])
        self.builder = SceneBuilder(plan.name, plan.seed, plan.size, ground)
        self._chances = {name: chance.generator(plan.seed) for name, chance in plan.chances.items()}
        self.library = {kind.name: kind for kind in plan.library}

    @cached_property
    def pavement(self) -> shapely.Geometry:
        """All raised pavements [m]."""
        areas = [layer.area for layer in self.plan.layers if isinstance(layer, p.Paved)]
        joined = shapely.union_all(areas)
        shapely.prepare(joined)
        return joined

    @cached_property
    def near(self) -> shapely.Geometry:
        """Where ground is cut into small squares [m]."""
        if self.plan.near is not None:
            return self.plan.near
        areas = [layer.area for layer in self.plan.layers if isinstance(layer, p.Roadway)]
        streets = areas[0] if len(areas) == 1 else shapely.union_all(areas)
        return shapely.buffer(streets, _NEAR, join_style="mitre")

    def prototype(self, kind: p.ThingKind) -> Prototype:
        """Return what the copies of a kind are made of."""
        thing = THINGS[kind.make or kind.name]
        rng = self._chances.get(kind.chance)
        if rng is None:
            rng = p.Chance(stream=f"kind {kind.name}").generator(self.plan.seed)
        make = partial(thing.levels, kind, rng, self.season)
        if thing.handed and self.network.left_hand:
            make = partial(_mirrored, make)
        return self.builder.prototype(kind.name, make, trees=thing.trees)

    def light(self, pose: Placed, reach: float, height: float) -> None:
        """Add the light of a street lamp."""
        lean = np.array(self.plan.lamps.axis) / exact.length(np.array(self.plan.lamps.axis))
        along = np.array([exact.cos(pose.turn), exact.sin(pose.turn)])
        place = np.array(pose[1:3]) + reach * along
        self.lights.append(([*place, height + pose.z], [*(lean[0] * along), lean[2]]))

    def look(self, piece: p.Flat | p.Field) -> Material:
        """Return the cover of a piece in this season."""
        return (piece.winter or piece.cover) if self.season is Season.WINTER else piece.cover

    def scene(self) -> Scene:
        """Return what has been built."""
        places, axes = zip(*self.lights, strict=True) if self.lights else ((), ())
        lamps = Lamps(
            np.array(places, np.float32).reshape(-1, 3),
            np.array(axes, np.float32).reshape(-1, 3),
            self.plan.lamps.intensity,
            self.plan.lamps.cut_off,
        )
        scene = self.builder.build(self.network, lamps, self.plan.horizon)
        scene.footways = _footways(self.plan, self.network)
        return scene


def _mirrored(make: Callable[[], Levels]) -> Levels:
    return tuple(map(mirrored, make()))


def _footways(plan: p.MapPlan, network: RoadNetwork) -> Footways:
    """Return where people walk: along the asphalt of streets, and over crossings."""
    roads = [layer for layer in plan.layers if isinstance(layer, p.Roadway)]
    if plan.walkways is None:
        painted = [markings.crossings_of(network, layer.paint) for layer in roads]
        lines = np.concatenate([np.zeros((0, 2, 2)), *painted])
        return Footways(np.zeros((0, 2)), np.zeros(1, np.int32), lines, ("",) * len(lines))
    areas = [
        layer.area if layer.bays is None else shapely.union(layer.area, _grown(layer.bays))
        for layer in roads
    ]
    solid = [shapely.geometry.polygon.orient(part) for area in areas for part in polygons_of(area)]
    rings = (ring for part in solid for ring in (part.exterior, *part.interiors))
    kerbs = [shapely.get_coordinates(ring) for ring in rings]
    walks = plan.walkways
    return Footways(
        kerb_points=np.concatenate([np.zeros((0, 2)), *kerbs]),
        kerb_first=np.cumsum([0, *map(len, kerbs)]).astype(np.int32),
        crossings=np.array(walks.lines, np.float64).reshape(-1, 2, 2),
        lights=walks.lights or ("",) * len(walks.lines),
    )


def _grown(bays: shapely.Geometry) -> shapely.Geometry:
    """Return bays [m] that overlap the asphalt beside them, beyond the rounding of both."""
    return shapely.buffer(bays, 0.01, join_style="mitre")


def _buildings(work: _Work, layer: p.Buildings) -> None:
    for one in layer.items:
        owner = work.builder.add(ObjectClass.BUILDING, *map(facades.mesh_of, one.parts))
        if "fronts" in one.fittings:
            rng = facades.chance_of(one.parts[0])
            fronts.add_fronts(work.builder, one.parts[0], owner, work.pavement, rng)
        above = [part.outline for part in one.parts[1:]] + [one.keep_free or shapely.Polygon()]
        for part, taken in zip(one.parts, above, strict=True):
            for outline, bottom, top in facades.prisms_of(part):
                work.builder.add_prism(outline, bottom, top, owner)
            if part.roof == "flat" and (part.top <= _HIGHEST_UNITS or taken.is_empty):
                _on_roof(work.builder, one, part, taken, owner)


def _on_roof(
    builder: SceneBuilder,
    one: p.Building,
    part: p.BuildingPart,
    taken: shapely.Geometry,
    owner: int,
) -> None:
    """Add what stands on a flat roof beside what is taken of it."""
    rng = facades.chance_of(part)
    if "tank" in one.fittings:
        inside = shapely.buffer(part.outline, -0.8, join_style="mitre")
        roof = shapely.difference(inside, shapely.buffer(taken, 0.5))
        free = fronts.add_water_tank(builder, part, owner, roof, rng)
        taken = shapely.union(taken, shapely.difference(roof, free))
    if "roof units" in one.fittings:
        rooftops.add_rooftop(builder, part.footprint, part.top, owner, taken, rng)


def _backdrop(work: _Work, layer: p.Backdrop) -> None:
    made = []
    rows = zip(
        layer.outlines, layer.tops.tolist(), layer.walls, layer.roofs, layer.bays, strict=True
    )
    for outline, top, wall, cover, bays in rows:
        made.append(parts.window_wall(outline, FLOOR_HEIGHT, top, wall, bays))
        corners = np.column_stack([outline, np.full(len(outline), top)])
        made.append(quads([corners], [outline / TEXTURES[cover.texture]], cover))
    owner = work.builder.add(ObjectClass.BUILDING, concatenate(made))
    for outline, top in zip(layer.outlines, layer.tops.tolist(), strict=True):
        work.builder.add_prism(outline, FLOOR_HEIGHT, top, owner)


def _things(work: _Work, layer: p.Things) -> None:
    kinds = [work.library[name] for name in layer.kinds]
    prototypes = [work.prototype(kind) for kind in kinds]
    for index, row in zip(layer.kind.tolist(), layer.pose.tolist(), strict=True):
        kind = kinds[index]
        pose = Placed(kind.name, *row)
        thing = THINGS[kind.make or kind.name]
        owner = work.builder.add_copy(
            thing.kind, prototypes[index], pose[1:4], pose.turn, pose.scale
        )
        SOLIDS[layer.solid or thing.solid](work.builder, kind, pose, owner)
        if thing.light is not None:
            work.light(pose, *thing.light)


def _streets(work: _Work, layer: p.Roadway) -> None:
    paint = markings.paint_of(work.network, layer.paint)
    shapes = painting.painted(layer.paint.shapes, painting.WHITE)
    work.builder.add(ObjectClass.MARKING, painting.mesh_of(paint), shapes)
    worn = worn_lanes(work.network, layer.worn_from) if layer.worn_from else work.network
    wear = road_wear(worn, layer.wear.generator(work.plan.seed), layer.apart)
    smooth = [_flat(work, asphalt(layer.area))]
    if layer.bays is not None:
        smooth.append(_flat(work, asphalt(layer.bays, light=True)))
    work.builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, *smooth)


def _paved(work: _Work, layer: p.Paved) -> None:
    kerb = shapely.intersection(layer.area, shapely.buffer(layer.beside, layer.kerb_width))
    slabs = shapely.difference(layer.area, kerb)
    tile, stone = TEXTURES[layer.slabs.texture], TEXTURES[layer.kerb.texture]
    work.builder.add(
        ObjectClass.PAVEMENT,
        kerbstones(kerb, layer.z, layer.beside, layer.kerb, stone),
        surface(slabs, layer.z, layer.slabs, tile, layer.turn),
        skirt(layer.area, FLOOR_HEIGHT, layer.z, layer.kerb, stone),
    )


def _ground(work: _Work, layer: p.GroundCover) -> None:
    season = Season.WINTER if work.season is Season.WINTER else Season.SUMMER
    if layer.season not in (None, season.value):
        return
    work.builder.add(layer.kind, *(_PIECES[type(piece)](work, piece) for piece in layer.pieces))


def _flat(work: _Work, piece: p.Flat) -> Mesh:
    cover = work.look(piece)
    tile = TEXTURES[cover.texture]
    if cover.surface > Surface.DESERT:
        top = ground.edged(piece.area, piece.beside, cover, piece.z)
    elif piece.cells == "wide":
        top = ground.plain(piece.area, work.near, cover, piece.z)
    elif piece.cells == "whole":
        top = flat_polygons([piece.area], piece.z, cover, tile, piece.turn)
    else:
        top = surface(piece.area, piece.z, cover, tile, piece.turn)
    if piece.sides is None:
        return top
    side = TEXTURES[piece.sides.texture]
    sunk = shapely.buffer(piece.area, -_SUNK, join_style="mitre")
    return concatenate([top, skirt(sunk, piece.foot, piece.z, piece.sides, side)])


def _heap(work: _Work, piece: p.Heap) -> Mesh:
    top = flat_polygons([piece.area], piece.z, piece.cover, TEXTURES[piece.cover.texture])
    return concatenate([slope(piece.area, piece.z, _SLOPE, piece.cover), top])


def _field(work: _Work, piece: p.Field) -> Mesh:
    return field_mesh(piece, work.look(piece), work.season)


def _far(work: _Work, piece: p.Far) -> Mesh:
    beyond = piece.beyond or work.plan.size
    winter = piece.winter if work.season is Season.WINTER else ()
    covers = winter or piece.covers
    if piece.rule == "plain" or piece.chance is None:
        return ground.far_plain(beyond, covers[0])
    rng = piece.chance.generator(work.plan.seed)
    if piece.rule == "city":
        return outskirts.city_land(beyond, rng, covers, piece.shares)
    return outskirts.fields(beyond, FLOOR_HEIGHT, rng, list(zip(covers, piece.shares, strict=True)))


def _deck(work: _Work, layer: p.Deck) -> None:
    builder, floor = work.builder, FLOOR_HEIGHT
    legs = [overpass.pillar_mesh(leg, floor) for leg in layer.legs]
    parts = (layer.middle, layer.descent)
    sides = [overpass.sides_mesh(part, floor) for part in parts]
    owner = builder.add(ObjectClass.STRUCTURE, *sides, *legs)
    builder.add(ObjectClass.ROAD, *map(overpass.carriageway_mesh, parts))
    for outline, bottom, top in overpass.deck_prisms(layer.middle, floor):
        builder.add_prism(outline, bottom, top, owner)
    for pillar in layer.pillars:
        owner = builder.add(ObjectClass.STRUCTURE, overpass.pillar_mesh(pillar, floor))
        base = shapely.get_coordinates(pillar.base)[:-1]
        builder.add_prism(base, floor, floor + overpass.BASE_HEIGHT, owner)
        for column in pillar.columns:
            builder.add_cylinder(column, overpass.COLUMN_RADIUS, floor, pillar.top, owner)


def _tunnels(work: _Work, layer: p.Tunnels) -> None:
    builder, rng = work.builder, layer.chance.generator(work.plan.seed)
    glow = Material(tint=(1.0, 0.92, 0.78), surface=Surface.LAMP, emission=5.0)
    case = builder.prototype("tunnel lamp", lambda: (box((1.4, 0.5, 0.12), (0, 0, 0), glow, 1.0),))
    for tunnel in layer.items:
        mesh = tunnels.tunnel_mesh(tunnel, FLOOR_HEIGHT, layer.outside, layer.inside, rng)
        owner = builder.add(ObjectClass.STRUCTURE, mesh)
        for outline, bottom, top in tunnels.tunnel_prisms(tunnel, FLOOR_HEIGHT):
            builder.add_prism(outline, bottom, top, owner)
        turn = float(exact.atan2(tunnel.along[1], tunnel.along[0]))
        for at in (-11.0, 11.0):
            spot = tunnel.placed(np.array([at, 0.0])).tolist()
            z, light = _LAMP_HEIGHTS
            builder.add_copy(ObjectClass.STRUCTURE, case, (*spot, z), turn, 1.0, owner)
            work.lights.append(([*spot, light], [0.0, 0.0, -1.0]))


def _relief(work: _Work, layer: p.Hills) -> None:
    seed, ground = work.plan.seed, relief_of(layer, work.plan.seed)
    kinds, over = np.zeros(len(ground.triangles), np.intp), None
    if layer.shades is not None:
        kinds = kinds_of(ground, len(layer.covers), layer.shades.generator(seed))
    elif layer.white and work.season is Season.WINTER:
        over = snow_over(ground, layer.mounds, set(layer.white))
        kinds = (over[ground.triangles].max(axis=1) > -_SNOW_FRINGE).astype(np.intp)
        over = 32.0 + np.clip(over, -_SNOW_FRINGE, 24.0)
    mesh = surface_of(ground, FLOOR_HEIGHT, layer.covers, kinds, smooth=layer.smooth, along=over)
    work.builder.add(ObjectClass.GROUND, mesh)


def _skyways(work: _Work, layer: p.Skyways) -> None:
    for skyway in layer.items:
        skyways.add_skyway(work.builder, skyway)


_PIECES: dict[type, Callable[[_Work, Any], Mesh]] = {
    p.Flat: _flat, p.Heap: _heap, p.Field: _field, p.Far: _far,
}  # fmt: skip

_MAKERS: dict[type, Callable[[_Work, Any], None]] = {
    p.Buildings: _buildings,
    p.Backdrop: _backdrop,
    p.Things: _things,
    p.Roadway: _streets,
    p.Paved: _paved,
    p.GroundCover: _ground,
    p.Deck: _deck,
    p.Tunnels: _tunnels,
    p.Hills: _relief,
    p.Skyways: _skyways,
    p.Railway: lambda work, layer: railway.add_railway(work.builder, layer.line),
}
