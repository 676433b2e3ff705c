"""Blobs of one colour in a picture from above, in metres on the ground."""

from functools import cache
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import MissingExtraError
from eyas.engine.targets.colour_names import COLOUR_NAMES
from eyas.lanes import exact

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

_CHROMA: Final = 0.12
"""Largest difference of the shares of red, green and blue, added up, of pixels of one colour."""

_VEIL: Final = (0.07, 0.12, 0.18)
"""What the sky's reflection adds to paint in the sun, sRGB: measured on the cars of citystreet by
day, where red paint of (0.80, 0.11, 0.10) shares is seen with (0.59, 0.18, 0.24)."""

_FROM_NAME: Final = 0.2  # Largest difference of shares from a name's paint

_LIGHT: Final = (0.6, 1.15)
"""Brightness in shade and in sun, as a multiple of the paint's; measured likewise."""

_DARKER: Final = 0.3  # Weight of the logarithm of what is beyond these
_UNSURE: Final = 0.05  # A paint may be one of two names that differ by less
_LEVELS: Final = 32  # Levels of each channel in the table of names

_BRIDGED: Final = 0.8, 0.45
"""Windows and roofs up to twice as long do not divide a blob, where it is one vehicle or a queue of
equal ones, and where different ones of one colour may be side by side [m]."""

_FILLED: Final = 0.3
"""Least share of a blob's rectangle that has its colour: leaves have it here and there."""

_QUEUE: Final = 1.4  # A blob that is so many times as long as one vehicle is a queue
_SPACING: Final = 1.5  # Between the vehicles of a queue [m]
_SIZES: Final = (0.8, 16.0)  # Shortest and longest blob that may be a vehicle [m]
_WIDEST: Final = 4.0  # [m]
_LEAST: Final = 4  # Fewest pixels


class Blobs(NamedTuple):
    """B blobs, the largest first."""

    place: Floats  # Column and row of the middle [pixels], shape (B, 2)
    length: Floats  # [m], shape (B,)
    width: Floats  # [m], shape (B,)
    axis: Floats  # Direction of the long side: column and row, shape (B, 2)


def painted(picture: NDArray[np.uint8], name: str) -> Mask:
    """Return which pixels look like paint of a colour, and about as much as of any other name.

    Returns:
        Shape (H, W).
    """
    red, green, blue = np.moveaxis(picture // (256 // _LEVELS), -1, 0)
    mask: Mask = _seen_as(name)[red, green, blue]
    return mask


@cache
def _seen_as(name: str) -> Mask:
    """Return which colours that a camera sees may be paint of a name, one axis for each channel."""
    away = _from_names()
    own = away[list(COLOUR_NAMES).index(name)]
    mask: Mask = (own < _FROM_NAME) & (own < away.min(axis=0) + _UNSURE)
    return mask


@cache
def _from_names() -> Floats:
    """Return how far the colours that a camera sees are from the paint of each name, 4 axes."""
    steps = (np.arange(_LEVELS) + 0.5) / _LEVELS
    seen = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1)
    bright = seen.sum(axis=-1)
    found = []
    for own in COLOUR_NAMES.values():
        paint = np.add(own, _VEIL)
        away = np.abs(seen / bright[..., None] - paint / paint.sum()).sum(axis=-1)
        light = bright / sum(own)
        beyond = exact.log(light / np.clip(light, *_LIGHT))
        found.append(away + _DARKER * np.abs(beyond))
    return np.array(found)


def coloured(
    picture: NDArray[np.uint8],
    colour: Floats,  # 0 to 255, shape (3,)
) -> Mask:
    """Return which pixels have about the hue of a colour that the camera has seen, shape (H, W)."""
    bright = picture.sum(axis=2, dtype=np.float64)
    shares = picture / np.maximum(bright, 1.0)[..., None]
    near: Mask = np.abs(shares - colour / colour.sum()).sum(axis=2) < _CHROMA
    near &= bright > 0.4 * colour.sum()
    return near


def salient(picture: NDArray[np.uint8]) -> Mask:
    """Return which pixels are as colourful as paint, and no plants, shape (H, W)."""
    high, low = picture.max(axis=2).astype(np.float64), picture.min(axis=2)
    plant = picture[..., 1] > 1.08 * np.maximum(picture[..., 0], picture[..., 2])
    mask: Mask = (high - low > 0.45 * high) & (high > 38.0) & ~plant
    return mask


def blobs_in(mask: Mask, scale: float, each: float | None = None, *, apart: bool = False) -> Blobs:
    """Return the blobs of a mask that may be vehicles.

    Args:
        mask: Shape (H, W).
        each: Length of all of them, so that queues can be divided [m]; None: not known.
    """
    cv2 = _opencv()
    reach = max(round(_BRIDGED[apart] / scale), 1)
    kernel = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, kernel)
    count, labels = cv2.connectedComponents(closed, connectivity=4)
    rows, columns = np.nonzero(labels)
    order = np.argsort(labels[rows, columns], kind="stable")
    rows, columns = rows[order], columns[order]
    points = np.stack((columns, rows, mask[rows, columns]), axis=1).astype(np.float64)
    ends = np.cumsum(np.bincount(labels[labels > 0], minlength=count)[1:])
    found = []
    for blob in np.split(points, ends[:-1]) if count > 1 else ():
        for part in _divided(blob, scale, each):
            if len(part) >= _LEAST:
                middle, axis, long, short = _shape(part[:, :2], scale)
                fits = _SIZES[0] <= long <= _SIZES[1] and short <= _WIDEST
                if fits and part[:, 2].sum() * scale * scale >= _FILLED * long * short:
                    found.append((len(part), *middle, long, short, *axis))
    found.sort(reverse=True)
    table = np.array(found, np.float64).reshape(-1, 7)
    return Blobs(table[:, 1:3], table[:, 3], table[:, 4], table[:, 5:7])


def _shape(points: Floats, scale: float) -> tuple[Floats, Floats, float, float]:
    """Return middle and long axis of a blob [pixels], and its length and width [m]."""
    middle = points.mean(axis=0)
    away = points - middle
    across, down = (np.square(away).sum(axis=0) / (len(points) - 1) + 1.0 / 12.0).tolist()
    both = float(away.prod(axis=1).sum()) / (len(points) - 1)
    half = 0.5 * float(exact.hypot(across - down, 2.0 * both))
    angle = 0.5 * float(exact.atan2(2.0 * both, across - down))
    axis = np.array([exact.cos(angle), exact.sin(angle)])
    # A bar of length L has a variance of L^2 / 12.
    values = np.array([0.5 * (across + down) - half, 0.5 * (across + down) + half])
    short, long = (np.sqrt(12.0 * np.maximum(values, 0.0)) * scale).tolist()
    return middle, axis, long, short


def _divided(points: Floats, scale: float, each: float | None) -> list[Floats]:
    """Return the vehicles of a queue, or the whole blob.

    Each has the columns and rows of its pixels, and whether they are coloured, shape (K, 3).
    """
    if each is None or len(points) < _LEAST:
        return [points]
    middle, axis, long, _ = _shape(points[:, :2], scale)
    count = round((long + _SPACING) / (each + _SPACING))
    if long < _QUEUE * each or count < 2:
        return [points]
    along = ((points[:, :2] - middle) * axis).sum(axis=1)
    limits = np.linspace(along.min(), along.max(), count + 1)[1:-1]
    part = np.searchsorted(limits, along)
    return [points[part == k] for k in range(count)]


def _opencv() -> Any:  # noqa: ANN401  # a module
    try:
        import cv2
    except ImportError as error:
        raise MissingExtraError("a servo that sees colours", "policies") from error
    cv2.setNumThreads(1)
    return cv2
