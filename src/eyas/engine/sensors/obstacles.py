"""Everything solid that a ray or a body may hit, in the form that kernels read."""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.furniture import Cylinder, Prism, furniture
from eyas.engine.sensors.grid import ObstacleGrid, grid_of
from eyas.engine.sensors.slopes import Slopes, slopes_of
from eyas.engine.state.motion import Motion
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.engine.targets.catalogue import MODELS, kind_of, sections_of

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
