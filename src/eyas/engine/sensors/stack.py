"""Pictures as learners want them: grey or RGB, channels first or last, the latest few together."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import ColourLayout, Colours
from eyas.lanes import kernel, parallel, thread_count

Bytes = NDArray[np.uint8]

"""Pixels, shape (V, pixels, 3), and their lumas, shape (V, pixels)."""


class FrameStack:
    """The latest pictures of N cameras, each stack in one array.

    Attributes:
        shape: Shape of one stack: (H, W, frames x channels) or (frames x channels, H, W).
        images: The stacks, shape (N, *shape); the newest picture has the last channels.

    Args:
        count: N.
        size: Height and width [pixels].
        colours: RGB, or grey as in ITU-R BT.601 (Pillow's mode `L`).
        layout: Order of the axes.
        frames: Number of pictures in a stack.
    """

    def __init__(
        self,
        count: int,
        size: tuple[int, int],
        colours: Colours = Colours.RGB,
        layout: ColourLayout = ColourLayout.HWC,
        frames: int = 1,
    ) -> None:
        self._grey = colours is Colours.GREY
        self._channels = 1 if self._grey else 3
        self._frames = frames
        planes = frames * self._channels
        first = layout is ColourLayout.CHW
        self.shape = (planes, *size) if first else (*size, planes)
        self.images: Bytes = np.zeros((count, *self.shape), np.uint8)
        self._axis = 1 if first else -1

    def add(
        self,
        rgb: Bytes,  # Pictures, shape (V, H, W, 3)
        chosen: NDArray[np.integer],  # The stack of each, shape (V,)
        # Whether each is the first of an episode, which fills its stack, shape (V,); None: none is
        begun: NDArray[np.bool_] | None = None,
    ) -> None:
        """Add a picture to some stacks."""
        stacks = np.moveaxis(_lumas(rgb) if self._grey else rgb, -1, self._axis)
        if self._frames > 1:
            older = np.split(self.images[chosen], [self._channels], self._axis)[1]
            if begun is not None:
                older[begun] = np.concatenate([stacks[begun]] * (self._frames - 1), self._axis)
            stacks = np.concatenate([older, stacks], self._axis)
        self.images[chosen] = stacks


def _lumas(rgb: Bytes) -> Bytes:
    """Return the luma of pixels, shape (V, H, W, 1)."""
    views, pixels = len(rgb), rgb.shape[1] * rgb.shape[2]
    lumas = np.empty((*rgb.shape[:-1], 1), np.uint8)
    workers = min(thread_count(), views)
    _find_lumas(workers, rgb.reshape(views, pixels, 3), lumas.reshape(views, pixels))
    return lumas


@kernel(inline=True)
def luma(red: int, green: int, blue: int) -> int:
    """Return the luma of a pixel, in Pillow's arithmetic."""
    return int((19595 * red + 38470 * green + 7471 * blue + 0x8000) >> 16)


@parallel
def _find_lumas(worker: int, workers: int, rgb: Bytes, lumas: Bytes) -> None:
    """Find the lumas of the pictures whose turn is this worker's."""
    for view in range(worker, rgb.shape[0], workers):
        for at in range(rgb.shape[1]):
            lumas[view, at] = luma(rgb[view, at, 0], rgb[view, at, 1], rgb[view, at, 2])
