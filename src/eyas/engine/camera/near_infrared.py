"""Near infrared, some 850 nm: a camera with a filter that keeps light out instead of infrared.

Made of the radiances of red, green and blue, and of what each pixel shows. Leaves mirror half of
it, where they take nine tenths of green light (Gates et al., "Spectral properties of plants",
Applied Optics 4 (1965)); the clear sky scatters it (550/850)^4 times as much as green light
(Rayleigh); water takes nearly all; most else is about as bright as in red light.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4, i4
from eyas.engine.state.scene import ObjectClass
from eyas.lanes import kernel, parallel, thread_count
from eyas.lanes.vector import (
    WIDTH,
    gather,
    greater,
    lane_numbers,
    lesser,
    load,
    select,
    store,
    to_i4,
)

_SKY, _WATER, _TREE = (
    i4(int(kind)) for kind in (ObjectClass.SKY, ObjectClass.WATER, ObjectClass.TREE)
)
_GROUND = i4(int(ObjectClass.GROUND))

_LEAVES = f4(4.0)  # By how much leaves are brighter than in green light, less one
_RAYLEIGH = f4(0.175)
_DEEP = f4(0.25)  # Share of red light that water gives back in near infrared


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    radiance: NDArray[np.float32]  # Shape (V, 3, pixels); written in place
    class_id: NDArray[np.uint8]  # Shape (V, pixels)


def near_infrared(radiance: NDArray[np.float32], class_id: NDArray[np.uint8]) -> None:
    """Replace the three colours of pictures by their near infrared, the same in each.

    Args:
        radiance: Linear red, green and blue, shape (V, 3, H, W); written in place.
        class_id: `ObjectClass` of each pixel, shape (V, H, W).
    """
    views = len(radiance)
    work = _Work(radiance.reshape(views, 3, -1), class_id.reshape(views, -1))
    _change(min(thread_count(), views), work)


@kernel(inline=True)
def _shown(red: float, green: float, blue: float, kind: int) -> float:
    """Return the radiance of eight pixels."""
    zero, one = f4(0.0), f4(1.0)
    least = lesser(red, lesser(green, blue))
    sky = least + _RAYLEIGH * (blue - least)
    excess = (green - greater(red, blue)) / greater(green, f4(1e-6))
    leafy = lesser(greater(excess * f4(5.0), zero), one)
    plant = green * (one + _LEAVES * leafy)
    shown = select((kind == _TREE) | (kind == _GROUND), greater(plant, red), red)
    shown = select(kind == _WATER, _DEEP * red, shown)
    near: float = select(kind == _SKY, sky, shown)
    return near


@parallel
def _change(worker: int, workers: int, work: _Work) -> None:
    """Change the pictures whose turn is this worker's."""
    pixels = work.class_id.shape[1]
    whole = pixels - pixels % WIDTH
    for view in range(worker, work.class_id.shape[0], workers):
        red, green, blue = work.radiance[view, 0], work.radiance[view, 1], work.radiance[view, 2]
        for at in range(0, whole, WIDTH):
            kind = to_i4(gather(work.class_id[view], lane_numbers() + i4(at)))
            shown = _shown(load(red, at), load(green, at), load(blue, at), kind)
            store(red, at, shown)
            store(green, at, shown)
            store(blue, at, shown)
        for at in range(whole, pixels):
            one = _shown(red[at], green[at], blue[at], i4(work.class_id[view, at]))
            red[at] = green[at] = blue[at] = one
