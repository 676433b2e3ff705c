"""Edges of pictures behind a lens: darker, and with fringes of colour."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.lens import LensSet
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.lanes import kernel, parallel, thread_count
from eyas.lanes.vector import (
    WIDTH,
    gather,
    greater,
    lane_numbers,
    lesser,
    load,
    select,
    splat,
    store,
    to_f4,
    to_i4,
)

Floats = NDArray[np.float64]


def change_light(
    # Radiances in front of the lens, shape (V, 3, H, W); changed, if only darkened
    light: NDArray[np.float32],
    trackers: NDArray[np.integer],  # The tracker of each view, shape (V,)
    lenses: LensSet,  # The lenses of all trackers
) -> NDArray[np.float32]:
    """Return radiances as they come through lenses that darken and colour edges.

    Red and blue are shown a little larger or smaller than green, about the principal point: the
    radiance is looked up between four pixels, and that of the edge is repeated outside.
    """
    views, _, height, width = light.shape
    middle = 0.5 + lenses.numbers[trackers, 7:9]
    scale = np.ones((views, 3))
    scale[:, 0] += lenses.fringes[trackers, 0]
    scale[:, 2] += lenses.fringes[trackers, 1]
    fringes = bool((scale != 1.0).any())
    bend = 1.0 / np.sqrt(1.0 - lenses.vignetting[trackers]) - 1.0
    front = light.reshape(views, 3, -1)
    work = _Work(
        front,
        np.empty_like(front) if fringes else front,
        int(not fringes),
        width,
        middle * (width, height),
        1.0 / scale,
        np.stack([bend, np.full(views, 4.0 / (width * width + height * height))], axis=1),
    )
    _see(min(thread_count(), views), work)
    return work.behind.reshape(light.shape)


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    front: NDArray[np.float32]  # Shape (V, 3, pixels)
    behind: NDArray[np.float32]  # The same, behind the lens
    in_place: int  # 1: the two are the same, as they may be where there are no fringes
    width: int
    middle: Floats  # Column and row of the principal point [pixels], shape (V, 2)
    shrink: Floats  # One over the size of each colour, shape (V, 3)
    fall: Floats
    """How light falls off, and one over the square of half the diagonal [1/pixels^2], shape
    (V, 2)."""


@kernel(inline=True)
def _between(plane: NDArray[np.float32], width: int, column: float, row: float) -> float:
    """Return eight values between the centres of pixels, for columns and rows from these."""
    height = len(plane) // width
    column = lesser(greater(column, f4(0.0)), f4(width - 1))
    row = lesser(greater(row, f4(0.0)), f4(height - 1))
    left, top = to_i4(column), to_i4(row)
    across, down = column - to_f4(left), row - to_f4(top)
    right, below = lesser(left + i4(1), i4(width - 1)), lesser(top + i4(1), i4(height - 1))
    above, under = top * i4(width), below * i4(width)
    a, b = gather(plane, above + left), gather(plane, above + right)
    c, d = gather(plane, under + left), gather(plane, under + right)
    upper: float = a + across * (b - a)
    between: float = upper + down * (c + across * (d - c) - upper)
    return between


@parallel
def _see(worker: int, workers: int, work: _Work) -> None:
    """Change the light of the views whose turn is this worker's."""
    width, pixels = work.width, work.front.shape[2]
    numbers = to_f4(lane_numbers())
    for view in range(worker, work.front.shape[0], workers):
        middle_x, middle_y = f4(work.middle[view, 0] - 0.5), f4(work.middle[view, 1] - 0.5)
        bend, unit = f4(work.fall[view, 0]), f4(work.fall[view, 1])
        for row in range(pixels // width):
            down = f4(row) - middle_y
            for first in range(0, width, WIDTH):
                place = min(first, width - WIDTH)
                at = row * width + place
                aside = numbers + (f4(place) - middle_x)
                fall = f4(1.0) + bend * ((aside * aside + down * down) * unit)
                share = f4(1.0) / (fall * fall)
                if work.in_place == 1:
                    # The last eight overlap those before, which are darkened already.
                    share = select(numbers < f4(first - place), splat(f4(1.0)), share)
                for channel in range(3):
                    plane = work.front[view, channel]
                    shrink = f4(work.shrink[view, channel])
                    value = load(plane, at)
                    if shrink != f4(1.0):
                        column, line = aside * shrink + middle_x, splat(down * shrink + middle_y)
                        value = _between(plane, width, column, line)
                    store(work.behind[view, channel], at, value * share)
