"""Bayer mosaics: reading one, and finding the two missing colours of each photosite.

Rows begin red, green, red, ... and green, blue, green, ... by turns (RGGB).
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.counting import Counts
from eyas.engine.camera.photosites import Readout, noise_bits, pattern_bits, read_out, row_error
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.lanes import kernel
from eyas.lanes.vector import WIDTH, greater, lane_numbers, load, select, splat, store, to_u4

HALO = 2  # Rows above and below those of a picture that finding their colours takes

MARGIN = 8  # Columns beside them in the working memory, of which two are used

Colours = tuple[float, float, float]


@kernel(inline=True)
def _mirrored(row: int, height: int) -> int:
    """Return the row that stands for one outside the picture, of the same colours."""
    row = abs(row)
    return row if row < height else 2 * (height - 1) - row


@kernel
def read_mosaic(
    readout: Readout,  # How they are read
    radiance: NDArray[np.float32],  # Shape (V, 3, H, W)
    view: int,  # Which picture
    rows: tuple[int, int],  # Its first row, and the row after the last
    counts: Counts,  # Tables of few electrons
    # Written: values, 1 at saturation, with white balanced; shape (rows + 2 `HALO`, W + 2 `MARGIN`)
    raw: NDArray[np.float32],
) -> None:
    """Read the photosites of some rows of a picture, with the rows around them."""
    height, width = radiance.shape[2], radiance.shape[3]
    plane, line = height * width, raw.shape[1]
    first, last = rows
    for k in range(last - first + 2 * HALO):
        row = _mirrored(first + k - HALO, height)
        below = row & 1
        common = row_error(readout, row)
        even, odd = below, below + 1  # channels of the photosites in even and odd columns
        for start in range(0, width, WIDTH):
            column = min(start, width - WIDTH)
            pixel = row * width + column
            at = (3 * view + below) * plane + pixel
            is_odd = ((lane_numbers() + i4(column)) & i4(1)) == i4(1)
            left = load(radiance, at) * readout.electrons[even]
            right = load(radiance, at + plane) * readout.electrons[odd]
            index = to_u4(lane_numbers() + i4(pixel))
            noise, pattern = noise_bits(readout, index), pattern_bits(readout, index)
            light = select(is_odd, right, left)
            value = read_out(readout, light, noise, pattern, common, counts)
            white = select(is_odd, splat(readout.balance[odd]), splat(readout.balance[even]))
            store(raw, k * line + MARGIN + column, value * white)
        for beside in range(1, HALO + 1):
            raw[k, MARGIN - beside] = raw[k, MARGIN + beside]
            raw[k, MARGIN + width - 1 + beside] = raw[k, MARGIN + width - 1 - beside]


@kernel(inline=True)
def demosaicked(
    raw: NDArray[np.float32],  # See `read_mosaic`
    row: int,  # Row in the picture
    at_row: int,  # Row in the band
    column: int,  # Column of the first of them
    malvar: bool,  # Which filters
) -> Colours:
    """Return red, green and blue of eight photosites of a row.

    `malvar`: the linear filters of Malvar, He and Cutler (High-quality linear interpolation for
    demosaicing of Bayer-patterned color images, ICASSP 2004), figure 2; else bilinear.
    """
    line = raw.shape[1]
    at = (at_row + HALO) * line + MARGIN + column
    own = load(raw, at)
    beside = load(raw, at - 1) + load(raw, at + 1)
    above = load(raw, at - line) + load(raw, at + line)
    corners = load(raw, at - line - 1) + load(raw, at - line + 1)
    corners += load(raw, at + line - 1) + load(raw, at + line + 1)
    across, down = f4(0.5) * beside, f4(0.5) * above
    round_it, diagonal = f4(0.25) * (beside + above), f4(0.25) * corners
    if malvar:
        far_beside = load(raw, at - 2) + load(raw, at + 2)
        far_above = load(raw, at - 2 * line) + load(raw, at + 2 * line)
        far = far_beside + far_above
        eighth = f4(0.125)
        round_it = eighth * (f4(4.0) * own + f4(2.0) * (beside + above) - far)
        across = f4(5.0) * own + f4(4.0) * beside - corners - far_beside
        across = eighth * (across + f4(0.5) * far_above)
        down = f4(5.0) * own + f4(4.0) * above - corners - far_above
        down = eighth * (down + f4(0.5) * far_beside)
        diagonal = eighth * (f4(6.0) * own + f4(2.0) * corners - f4(1.5) * far)
    odd = ((lane_numbers() + i4(column)) & i4(1)) == i4(1)
    if row & 1 == 0:
        return select(odd, across, own), select(odd, own, round_it), select(odd, down, diagonal)
    return select(odd, diagonal, down), select(odd, round_it, own), select(odd, own, across)


@kernel(inline=True)
def denoised(
    raw: NDArray[np.float32],  # See `read_mosaic`
    row: int,  # As for `demosaicked`
    at_row: int,
    column: int,
    colours: Colours,  # What that returned
    strength: float,  # 0 to 1
    grain: float,  # Value of some electrons, the deviation of a dark photosite
) -> Colours:
    """Return colours as the noise filters of cameras leave them at high gain.

    Colour is the mean over 5x5 photosites, and lost where that is hardly above the grain; half of
    the grain of their brightness stays.
    """
    red, green, blue = splat(f4(0.0)), splat(f4(0.0)), splat(f4(0.0))
    for down in (-1, 1):
        for across in (-1, 1):
            each = demosaicked(raw, row + down, at_row + down, column + across, malvar=False)
            red, green, blue = red + each[0], green + each[1], blue + each[2]
    mean = f4(0.0625) * (red + blue) + f4(0.125) * green
    own = f4(0.25) * (colours[0] + colours[2]) + f4(0.5) * colours[1]
    bright, lit = strength * f4(0.5) * (own + mean), greater(mean, f4(0.0))
    share, kept = strength * lit / (lit + grain), f4(1.0) - strength
    return (
        kept * colours[0] + bright + share * (f4(0.25) * red - mean),
        kept * colours[1] + bright + share * (f4(0.25) * green - mean),
        kept * colours[2] + bright + share * (f4(0.25) * blue - mean),
    )
