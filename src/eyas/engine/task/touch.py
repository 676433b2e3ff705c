"""What a body touches first on its way: solids, vehicles, other trackers, the ground."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.grid import cells_between
from eyas.engine.sensors.movers import find_boxes
from eyas.engine.sensors.obstacles import Obstacles
from eyas.engine.state.terrain import ground_at
from eyas.engine.task.sweep import NEVER, Sweep, sweep_cylinder, sweep_prism, while_level
from eyas.lanes import kernel


class Hit(NamedTuple):
    """The first touch of anything."""

    share: float  # Share of the motion at the touch, 0 to 1, or `NEVER`
    x: float  # Place, world frame [m]
    y: float
    thing: int  # Object id
    bottom: float  # z of the thing there [m]
    top: float


@kernel(inline=True)
def touch_solids(sweep: Sweep, obstacles: Obstacles) -> Hit:
    """Return the first solid that is touched."""
    solids, best = obstacles.solids, NEVER
    x, y, thing, low, high = 0.0, 0.0, -1, 0.0, 0.0
    wide = math.sqrt(sweep.half_length * sweep.half_length + sweep.half_width * sweep.half_width)
    to_x, to_y = sweep.x + sweep.motion_x, sweep.y + sweep.motion_y
    prisms, grid = solids.first.shape[0] - 1, solids.grid
    lowest = min(sweep.z, sweep.z + sweep.motion_z) - sweep.half_height
    first_row, last_row, left, right = cells_between(grid, (sweep.x, to_x), (sweep.y, to_y), wide)
    for row in range(first_row, last_row + 1):
        for column in range(left, right + 1):
            cell = row * grid.columns + column
            if grid.top[cell] < lowest:
                continue
            for k in range(grid.first[cell], grid.first[cell + 1]):
                item = grid.item[k]
                bottom, top = solids.bottom[item], solids.top[item]
                start, end = while_level(sweep, bottom, top)
                if start > end:
                    continue
                if item < prisms:
                    first, last = solids.first[item], solids.first[item + 1]
                    touch = sweep_prism(sweep, solids.points, first, last, start, end)
                else:
                    touch = sweep_cylinder(sweep, solids.round[item - prisms], start, end)
                if touch.share < best:
                    best, x, y = touch.share, touch.x, touch.y
                    thing, low, high = int(solids.thing[item]), bottom, top
    return Hit(best, x, y, thing, low, high)


@kernel(inline=True)
def touch_movers(
    sweep: Sweep,  # The motion of the body in the last physics step
    obstacles: Obstacles,  # Everything solid
    n: int,  # The tracker
    tick: int,  # Time at the end of the step, in physics steps
) -> Hit:
    """Return the first vehicle, or body of another tracker, that is touched."""
    boxes, best = obstacles.boxes, NEVER
    x, y, thing, low, high = 0.0, 0.0, -1, 0.0, 0.0
    reach = abs(sweep.motion_x) + abs(sweep.motion_y) + abs(sweep.motion_z)
    reach += sweep.half_length + sweep.half_width + sweep.half_height
    place = (sweep.x, sweep.y, sweep.z)
    for box in range(find_boxes(obstacles.movers, n, tick, place, reach, boxes)):
        # As seen from the mover, which stands where it is at the end.
        beside = _seen_from(sweep, boxes.moved[box])
        bottom, top = boxes.bottom[box], boxes.top[box]
        start, end = while_level(beside, bottom, top)
        if start > end:
            continue
        touch = sweep_prism(beside, boxes.corners, 4 * box, 4 * box + 4, start, end)
        if touch.share < best:
            best, x, y = touch.share, touch.x, touch.y
            thing, low, high = int(boxes.thing[box]), bottom, top
    return Hit(best, x, y, thing, low, high)


@kernel(inline=True)
def _seen_from(sweep: Sweep, moved: NDArray[np.float64]) -> Sweep:
    """Return a motion relative to something that has moved, and has come to rest where it is."""
    return Sweep(
        sweep.x + moved[0],
        sweep.y + moved[1],
        sweep.z + moved[2],
        sweep.motion_x - moved[0],
        sweep.motion_y - moved[1],
        sweep.motion_z - moved[2],
        sweep.cosine,
        sweep.sine,
        sweep.half_length,
        sweep.half_width,
        sweep.half_height,
    )


@kernel(inline=True)
def touch_ground(sweep: Sweep, obstacles: Obstacles) -> Hit:
    """Return the first touch of the ground, looked for at the corners and the middle of the box, in
    steps of half a cell of the relief.
    """
    terrain = obstacles.terrain
    way = abs(sweep.motion_x) + abs(sweep.motion_y)
    hills = terrain.relief.shape[0] > 0
    steps = int(way / (0.5 * terrain.spacing)) + 1 if hills else 1
    for step in range(steps):
        share = (step + 1.0) / steps
        low = sweep.z + share * sweep.motion_z - sweep.half_height
        for corner in range(5 if hills else 1):
            ahead = 0.0 if corner == 0 else sweep.half_length if corner < 3 else -sweep.half_length
            aside = sweep.half_width if corner % 2 else -sweep.half_width
            left = 0.0 if corner == 0 else aside
            x = sweep.x + share * sweep.motion_x + sweep.cosine * ahead - sweep.sine * left
            y = sweep.y + share * sweep.motion_y + sweep.sine * ahead + sweep.cosine * left
            ground = ground_at(terrain, x, y)
            if low <= ground:
                return Hit(share, x, y, obstacles.solids.ground, ground, ground)
    return Hit(NEVER, 0.0, 0.0, obstacles.solids.ground, 0.0, 0.0)
