"""Everything solid that a ray or a body may hit, in the form that kernels read."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.grid import ObstacleGrid, grid_of
from eyas.engine.sensors.slopes import Slopes, slopes_of
from eyas.engine.state.mesh import Mesh, Surface
from eyas.engine.state.motion import Motion
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.engine.targets.catalogue import MODELS, kind_of, sections_of
from eyas.lanes import exact

Row = NDArray[np.float64]

_SLICES = 5  # Cylinders in the stack

_SHARE = 0.85
"""Radius of a cylinder over that of the leaves at its height: the outermost stand alone."""

_CUTS = 4  # Parts into which each edge of a triangle is cut to find points on it


def crown_slices(
    mesh: Mesh,  # The tree, or a stand of trees
    low: Row,  # Lowest x, y, z of its leaves [m], shape (3,)
    high: Row,  # Highest x, y, z of its leaves [m], shape (3,)
) -> list[tuple[float, float, float]]:
    """Return bottom, top and radius of the cylinders of a crown, in the mesh's frame [m]."""
    middle = 0.5 * (low + high)[:2]
    most = 0.25 * float((high - low)[:2].sum())  # the corners of a square stand are further away
    points = _points_on(mesh)
    away = np.linalg.norm(points[:, :2] - middle, axis=1)
    ends = np.linspace(low[2], high[2], _SLICES + 1)
    slices = []
    for bottom, top in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        inside = (points[:, 2] >= bottom) & (points[:, 2] <= top)
        if inside.any():
            slices.append((bottom, top, _SHARE * min(float(away[inside].max()), most)))
    return slices


def leaves_of(mesh: Mesh) -> NDArray[np.bool_]:
    """Return which triangles are leaves; all if none is."""
    foliage = [m.surface in (Surface.FOLIAGE, Surface.CROWN) for m in mesh.palette]
    chosen = np.array(foliage, np.bool_)[mesh.materials]
    return chosen if chosen.any() else np.ones_like(chosen)


def _points_on(mesh: Mesh) -> NDArray[np.float64]:
    """Return points all over the leaves of a mesh, shape (K, 3)."""
    corners = mesh.positions[mesh.triangles[leaves_of(mesh)]].astype(np.float64)
    share = np.array(
        [(a, b, _CUTS - a - b) for a in range(_CUTS + 1) for b in range(_CUTS + 1 - a)]
    )
    points: NDArray[np.float64] = exact.product(share / _CUTS, corners).reshape(-1, 3)
    return points


_LONG = 1.4  # Length over width from which leaves are a hedge, and no crown

_TRUNK = 0.025  # Radius of a trunk over the height of its tree


@dataclass(frozen=True, slots=True)
class Prism:
    """An upright prism."""

    outline: NDArray[np.float64]  # Counter-clockwise [m], shape (4, 2)
    bottom: float
    top: float
    thing: int  # Object of the scene


@dataclass(frozen=True, slots=True)
class Cylinder:
    """An upright cylinder."""

    place: tuple[float, float, float]  # x, y, radius [m]
    bottom: float
    top: float
    thing: int  # Object of the scene


@dataclass(frozen=True, slots=True)
class Furniture:
    """The solids of all copies."""

    boxes: list[Prism]
    cylinders: list[Cylinder]


def furniture(scene: Scene) -> Furniture:
    """Return solids for the copies of a scene: crowns for all trees, and for what has no collider a
    box around it. Small parts of objects with a collider, such as those on roofs, get none, nor do
    stones and tufts, which are ground.
    """
    made, fixtures = Furniture([], []), scene.fixtures
    solid = {*scene.colliders.prism_object.tolist(), *scene.colliders.cylinder_object.tolist()}
    spans: dict[tuple[int, bool], _Span | None] = {}
    pairs = zip(fixtures.prototype.tolist(), fixtures.object_id.tolist(), strict=True)
    for copy, (prototype, thing) in enumerate(pairs):
        kind = scene.object_class[thing]
        tree = kind == ObjectClass.TREE
        if kind == ObjectClass.GROUND or (not tree and thing in solid):
            continue
        if (prototype, tree) not in spans:
            spans[prototype, tree] = _span(fixtures.levels[prototype][0], leaves=tree)
        span = spans[prototype, tree]
        if span is not None:
            pose = fixtures.pose[copy].astype(np.float64)
            _add(made, span, pose, thing, trunk=thing not in solid)
    return made


class _Span(NamedTuple):
    """The extent of a mesh, or of the leaves of a tree, in the mesh's frame."""

    low: list[float]  # Lowest x, y, z [m]
    high: list[float]
    slices: list[tuple[float, float, float]]
    """Bottom, top and radius of the cylinders of a crown [m]; none: it is a box."""


def _span(mesh: Mesh, *, leaves: bool) -> _Span | None:
    """Return the extent of a mesh, of its leaves if it is a tree with any; None if it is empty."""
    chosen = leaves_of(mesh) if leaves else np.ones(len(mesh.triangles), np.bool_)
    corners = mesh.positions[np.unique(mesh.triangles[chosen])].astype(np.float64)
    if not len(corners):
        return None
    low, high = corners.min(axis=0), corners.max(axis=0)
    length, width, _ = high - low
    crown = leaves and max(length, width) <= _LONG * min(length, width)
    slices = crown_slices(mesh, low, high) if crown else []
    return _Span(low.tolist(), high.tolist(), slices)


def _add(
    made: Furniture, span: _Span, pose: NDArray[np.float64], thing: int, *, trunk: bool
) -> None:
    """Add the solids of one copy."""
    (west, south, low), (east, north, high) = span.low, span.high
    foot, tall = float(pose[2, 3]), float(pose[2, 2])
    bottom, top = tall * low + foot, tall * high + foot
    if not span.slices:
        corners = np.array([[west, south], [east, south], [east, north], [west, north]])
        outline = exact.product(corners, pose[:2, :2].T) + pose[:2, 3]
        made.boxes.append(Prism(outline, bottom, top, thing))
        return
    middle = exact.product(pose[:2, :2], [0.5 * (west + east), 0.5 * (south + north)]) + pose[:2, 3]
    x, y, scale = float(middle[0]), float(middle[1]), exact.hypot(pose[0, 0], pose[1, 0])
    for begin, end, radius in span.slices:
        place = (x, y, scale * radius)
        made.cylinders.append(Cylinder(place, tall * begin + foot, tall * end + foot, thing))
    if trunk and bottom > foot:
        place = (float(pose[0, 3]), float(pose[1, 3]), _TRUNK * (top - foot))
        made.cylinders.append(Cylinder(place, foot, bottom, thing))


Floats = NDArray[np.float64]


class Solids(NamedTuple):
    """Upright prisms and cylinders that stand still.

    Item i below B is prism i; item B + c is cylinder c.
    """

    points: Floats  # Corners of the prisms, counter-clockwise [m], shape (K, 2)
    first: NDArray[np.int32]  # Start of each prism's corners, shape (B + 1,)
    round: Floats  # Centre and radius of each cylinder [m], shape (C, 3)
    bottom: Floats  # z of each item [m], shape (B + C,)
    top: Floats  # z of each item [m], shape (B + C,)
    thing: NDArray[np.int32]  # Object of the scene that each item belongs to, shape (B + C,)
    grid: ObstacleGrid  # The items in each cell
    ground: int  # Object of the scene that the ground is


BLOCK: Final = np.dtype(
    [
        ("ahead", np.float64),
        ("length", np.float64),
        ("width", np.float64),
        ("height", np.float64),
        ("towed", np.int64),
    ],
    align=True,
)
"""An upright box that is solid; a rigid model is one, an articulated one has several.

ahead: distance of its middle ahead of the reference point of the straight vehicle [m]; length,
width, height [m]; towed: 1 for a trailer, else 0.
"""


class MovingObstacles(NamedTuple):
    """The actors, and the bodies of the others, around N trackers, in W worlds."""

    motion: Motion
    world: NDArray[np.int32]  # World of each tracker, shape (N,)
    model: NDArray[np.int32]
    """Model of each actor in each world, index into the catalogue, shape (W, A)."""
    block: NDArray[np.void]  # Boxes of all models, of dtype `BLOCK`, shape (K,)
    first: NDArray[np.int32]  # Start of each model's boxes, shape (M + 1,)
    middle: Floats  # Distance of each model's middle ahead of its reference point [m], shape (M,)
    bodies: TrackerState
    """The N trackers, whose bodies others in their world meet; none: they have no bodies."""


class Boxes(NamedTuple):
    """Working memory: the upright boxes of what moves near one tracker at one time, at most B."""

    corners: Floats  # Corners, counter-clockwise, those of box b from 4 b [m], shape (4 B, 2)
    bottom: Floats  # [m], shape (B,)
    top: Floats  # [m], shape (B,)
    moved: Floats  # Motion in the last physics step [m], shape (B, 3)
    thing: NDArray[np.int32]  # Object id, shape (B,)
    bounds: Floats  # West, south, east, north [m], shape (B, 4)


class Obstacles(NamedTuple):
    """Everything solid around N trackers."""

    solids: Solids
    terrain: Terrain
    movers: MovingObstacles
    boxes: Boxes
    slopes: Slopes


def obstacles_of(
    solids: Solids,  # See `solids_of`
    terrain: Terrain,  # The ground
    motion: Motion,  # See `MovingObstacles`, as for the next two
    world: NDArray[np.int32],  # Shape (N,)
    model: NDArray[np.int32],  # Shape (W, A)
    bodies: TrackerState | None = None,  # The trackers; None: these have no bodies
) -> Obstacles:
    """Return the obstacles of a map with its traffic."""
    blocks = [_blocks_of(number) for number in range(len(MODELS))]
    movers = MovingObstacles(
        motion=motion,
        world=world,
        model=model,
        block=np.concatenate(blocks),
        first=np.cumsum([0, *map(len, blocks)]).astype(np.int32),
        middle=np.array([kind_of(number).ahead for number in range(len(MODELS))], np.float64),
        bodies=TrackerState.create(0) if bodies is None else bodies,
    )
    most = model.shape[1] * max(map(len, blocks)) + len(movers.bodies.position)
    boxes = Boxes(
        corners=np.zeros((4 * most, 2)),
        bottom=np.zeros(most),
        top=np.zeros(most),
        moved=np.zeros((most, 3)),
        thing=np.zeros(most, np.int32),
        bounds=np.zeros((most, 4)),
    )
    return Obstacles(solids, terrain, movers, boxes, slopes_of(terrain))


def _blocks_of(model: int) -> NDArray[np.void]:
    """Return the boxes of a model, of dtype `BLOCK`."""
    middle, whole = kind_of(model).ahead, (0.0, MODELS[model].size, 0)
    parts = [(*block, part.towed) for part in sections_of(model) for block in part.blocks]
    rows = [(middle + ahead, *size, towed) for ahead, size, towed in parts or [whole]]
    return np.array(rows, BLOCK)


def solids_of(scene: Scene) -> Solids:
    """Return the solids of a map: its colliders, and its trees and furniture that have none."""
    given, more = scene.colliders, furniture(scene)
    outlines = np.split(given.prism_points, given.prism_first[1:-1])[: len(given.prism_top)]
    outlines += [box.outline for box in more.boxes]
    round_ = np.column_stack([given.cylinder_centre, given.cylinder_radius])
    round_ = np.concatenate([round_, np.array([c.place for c in more.cylinders]).reshape(-1, 3)])
    parts = [
        (given.prism_bottom, given.prism_top, given.prism_object),
        _columns(more.boxes),
        (given.cylinder_bottom, given.cylinder_top, given.cylinder_object),
        _columns(more.cylinders),
    ]
    bottom, top, thing = (np.concatenate(column) for column in zip(*parts, strict=True))
    bounds = np.array(list(_bounds(outlines, round_)), np.float64).reshape(-1, 4)
    ground = np.flatnonzero(scene.object_class == ObjectClass.GROUND)
    return Solids(
        points=np.concatenate([np.zeros((0, 2)), *outlines]),
        first=np.cumsum([0, *map(len, outlines)]).astype(np.int32),
        round=round_,
        bottom=bottom.astype(np.float64),
        top=top.astype(np.float64),
        thing=thing.astype(np.int32),
        grid=grid_of(bounds, top),
        ground=int(ground[0]) if len(ground) else 0,
    )


def _columns(items: Sequence[Prism | Cylinder]) -> tuple[Floats, Floats, NDArray[np.int32]]:
    rows = np.array([(i.bottom, i.top, i.thing) for i in items], np.float64).reshape(-1, 3)
    return rows[:, 0], rows[:, 1], rows[:, 2].astype(np.int32)


def _bounds(outlines: list[Floats], round_: Floats) -> Iterator[tuple[float, ...]]:
    """Yield west, south, east, north of each item [m]."""
    for outline in outlines:
        yield (*outline.min(axis=0), *outline.max(axis=0))
    for x, y, radius in round_:
        yield (x - radius, y - radius, x + radius, y + radius)
