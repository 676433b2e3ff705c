"""Shading of a band: from the owner of each sample to the bytes of the picture."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel
from eyas.render.kernels.bundles import Geometry, Light
from eyas.render.kernels.light.tone import tone_byte
from eyas.render.kernels.scalars import f4
from eyas.render.kernels.surface.shade import shade_point

__all__ = ["shade_band"]


@inlined_kernel
def _linear(value: float) -> float:
    """Return the linear value of an sRGB value (a cubic fit, within 0.003)."""
    return value * (value * (value * f4(0.305306011) + f4(0.682171111)) + f4(0.012522878))


@inner_kernel
def _set_frame(
    poses: NDArray[np.float32],
    colours: NDArray[np.float32],
    index: int,
    frame: NDArray[np.float32],
) -> None:
    """Fill `Scratch.frame` from row `index`; fixtures have no colours."""
    for i in range(3):
        for k in range(4):
            frame[4 * i + k] = poses[index, i, k]
        frame[12 + i] = _linear(colours[index, i]) if len(colours) > 0 else f4(1.0)
    frame[15] = f4(1.0) / (frame[0] * frame[0] + frame[4] * frame[4] + frame[8] * frame[8])


@inner_kernel
def shade_band(
    samples: int,
    top: int,
    geometry: Geometry,
    light: Light,
    poses: NDArray[np.float32],
    colours: NDArray[np.float32],
    eye: NDArray[np.float64],
    axes: NDArray[np.float64],
    lens: NDArray[np.float64],
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    shade: NDArray[np.uint8],
    frame: NDArray[np.float32],
    output: NDArray[np.uint8],
) -> None:
    """Write the pixels of a band except the sky, which `draw_backdrop` has already written.

    A pixel whose four samples show one triangle is computed once, at its centre: 1/w is linear
    on the screen, so its value there is the mean of the four.

    Args:
        samples: Samples along a side of each pixel, 1 or 2.
        top: Row of the picture that is row 0 of `output`.
        geometry: Everything that can be drawn.
        light: Light and air.
        poses: Poses of the world's draw list, shape (I, 3, 4).
        colours: Colours of the world's draw list, shape (I, 3).
        eye: See `Job`.
        axes: See `Job`.
        lens: See `Job`.
        depth: See `Scratch`.
        owner: See `Scratch`.
        shade: See `Scratch`.
        frame: See `Scratch`.
        output: sRGB, shape (rows, columns, 3).
    """
    fixtures = len(geometry.fixture_object)
    centre = f4(eye[0]), f4(eye[1]), f4(eye[2])
    pixel = f4(1.0 / lens[3])
    across, down = f4(1.0 / lens[0]), f4(1.0 / lens[4])
    middle, centre_line = f4(0.5 * lens[1]), f4(0.5 * lens[2] - top * samples)
    ahead_x, ahead_y, ahead_z = f4(axes[0, 0]), f4(axes[0, 1]), f4(axes[0, 2])
    left_x, left_y, left_z = f4(axes[1, 0]), f4(axes[1, 1]), f4(axes[1, 2])
    up_x, up_y, up_z = f4(axes[2, 0]), f4(axes[2, 1]), f4(axes[2, 2])
    framed = -1
    for row in range(output.shape[0]):
        for column in range(output.shape[1]):
            line, sample = row * samples, column * samples
            tag, inverse = owner[line, sample], depth[line, sample]
            bits, step = 0, f4(0.5) * f4(samples)
            if samples == 2:
                inverse += depth[line, sample + 1] + depth[line + 1, sample]
                inverse = (inverse + depth[line + 1, sample + 1]) * f4(0.25)
                if (
                    owner[line, sample + 1] != tag
                    or owner[line + 1, sample] != tag
                    or owner[line + 1, sample + 1] != tag
                ):
                    bits, step = 2, f4(0.5)
            red, green, blue = 0, 0, 0
            for k in range(1 << bits):
                i, j = line + (k >> 1), sample + (k & 1)
                if bits:
                    tag, inverse = owner[i, j], depth[i, j]
                if tag < 0:
                    red += output[row, column, 0]
                    green += output[row, column, 1]
                    blue += output[row, column, 2]
                    continue
                left = (middle - (f4(j) + step)) * across
                up = (centre_line - (f4(i) + step)) * down
                rx = ahead_x + left * left_x + up * up_x
                ry = ahead_y + left * left_y + up * up_y
                rz = ahead_z + left * left_z + up * up_z
                instance = (tag >> 32) - 1
                if instance != framed:
                    framed = instance
                    if instance >= fixtures:
                        _set_frame(poses, colours, instance - fixtures, frame)
                    elif instance >= 0:
                        _set_frame(geometry.fixture_pose, colours[:0], instance, frame)
                colour = shade_point(
                    geometry, light, tag & 0xFFFFFFFF, instance >= 0, frame, centre,
                    (rx, ry, rz), f4(1.0) / inverse, pixel, shade[i, j],
                )  # fmt: skip
                red += tone_byte(light, colour[0])
                green += tone_byte(light, colour[1])
                blue += tone_byte(light, colour[2])
            half = (1 << bits) >> 1
            output[row, column, 0] = (red + half) >> bits
            output[row, column, 1] = (green + half) >> bits
            output[row, column, 2] = (blue + half) >> bits
