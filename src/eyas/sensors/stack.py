"""Pictures as learners want them: grey or RGB, channels first or last, the latest few together."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import step_kernel, thread_count
from eyas.core.parallel import Held, Pointer, parallel_kernel
from eyas.sensors.config import ColourLayout, Colours

__all__ = ["FrameStack"]

Bytes = NDArray[np.uint8]


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
        self._channels = 3 if colours is Colours.RGB else 1
        planes = frames * self._channels
        first = layout is ColourLayout.CHW
        self.shape = (planes, *size) if first else (*size, planes)
        self.images: Bytes = np.zeros((count, *self.shape), np.uint8)
        pixels = size[0] * size[1]
        self._strides = (1, pixels) if first else (planes, 1)
        self._frames = frames
        self._flat = self.images.reshape(count, planes * pixels)
        self._pixels = pixels

    def add(
        self, rgb: Bytes, chosen: NDArray[np.integer], begun: NDArray[np.bool_] | None = None
    ) -> None:
        """Add a picture to some stacks.

        Args:
            rgb: Pictures, shape (V, H, W, 3).
            chosen: The stack of each, shape (V,).
            begun: Whether each is the first of an episode, which fills its stack, shape (V,); None:
                none is.
        """
        views = len(chosen)
        work = _Work(
            rgb.reshape(views, self._pixels, 3),
            self._flat,
            np.ascontiguousarray(chosen, np.int64),
            np.zeros(views, np.bool_) if begun is None else begun,
            self._channels,
            self._frames,
            *self._strides,
        )
        _add_pictures(min(thread_count(), views), Held(work))


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    rgb: Bytes
    """Shape (V, pixels, 3)."""
    stacks: Bytes
    """Shape (N, bytes of a stack)."""
    chosen: NDArray[np.int64]
    begun: NDArray[np.bool_]
    channels: int
    frames: int
    pixel_stride: int
    """Bytes from a pixel to the next one of its plane."""
    plane_stride: int
    """Bytes from a plane to the next one at the same pixel."""


@parallel_kernel
def _add_pictures(parts: Pointer[tuple[Pointer[_Work]]], worker: int, workers: int) -> None:
    """Add the pictures whose turn is this worker's."""
    rgb, stacks, chosen, begun, channels, frames, pixel, plane = parts[0][0][0]
    for view in range(worker, rgb.shape[0], workers):
        stack, picture = stacks[chosen[view]], rgb[view]
        first = 0 if begun[view] else frames - 1
        for old in range(0 if begun[view] else first * channels):
            for at in range(picture.shape[0]):
                place = at * pixel + old * plane
                stack[place] = stack[place + channels * plane]
        for frame in range(first, frames):
            start = frame * channels * plane
            if channels == 1:
                for at in range(picture.shape[0]):
                    stack[start + at * pixel] = _grey(picture, at)
            else:
                for channel in range(3):
                    for at in range(picture.shape[0]):
                        stack[start + channel * plane + at * pixel] = picture[at, channel]


@step_kernel
def _grey(picture: Bytes, at: int) -> int:
    """Return the luma of a pixel, in Pillow's arithmetic."""
    red, green, blue = picture[at, 0], picture[at, 1], picture[at, 2]
    luma: int = (19595 * red + 38470 * green + 7471 * blue + 0x8000) >> 16
    return luma
