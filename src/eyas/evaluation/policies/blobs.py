"""Blobs of one colour in a picture from above, in metres on the ground."""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import MissingExtraError

__all__ = ["Blobs", "blobs_in", "coloured", "salient"]

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

_CHROMA: Final = 0.14
"""Largest difference of the shares of red, green and blue, added up, of pixels of one colour."""

_BRIGHT: Final = (0.3, 1.5)
"""Brightness in shade and in sun, as a multiple of the paint's."""

_BRIDGED: Final = 0.8
"""Windows and roofs up to twice as long do not divide a blob [m]."""

_SIZES: Final = (0.8, 16.0)
"""Shortest and longest blob that may be a vehicle [m]."""


class Blobs(NamedTuple):
    """B blobs, the largest first."""

    place: Floats
    """Column and row of the middle [pixels], shape (B, 2)."""
    length: Floats
    """[m], shape (B,)."""
    width: Floats
    """[m], shape (B,)."""
    axis: Floats
    """Direction of the long side: column and row, shape (B, 2)."""
    labels: NDArray[np.int32]
    """Number of the blob of each pixel from 1, others 0, shape (H, W)."""


def coloured(picture: Floats, colour: Floats) -> Mask:
    """Return which pixels may show a paint, shape (H, W).

    Args:
        picture: 0 to 1, shape (H, W, 3).
        colour: The paint, 0 to 1, shape (3,).
    """
    bright, own = picture.sum(axis=2), colour.sum()
    shares = picture / np.maximum(bright, 1e-3)[..., None]
    away = np.abs(shares - colour / own).sum(axis=2)
    low, high = _BRIGHT
    near: Mask = (away < _CHROMA) & (bright > low * own) & (bright < high * own)
    return near


def salient(picture: Floats) -> Mask:
    """Return which pixels are as colourful as paint, and no plants, shape (H, W)."""
    high, low = picture.max(axis=2), picture.min(axis=2)
    plant = picture[..., 1] > 1.08 * np.maximum(picture[..., 0], picture[..., 2])
    mask: Mask = (high - low > 0.45 * high) & (high > 0.15) & ~plant
    return mask


def blobs_in(mask: Mask, scale: float) -> Blobs:
    """Return the blobs of a mask that may be vehicles.

    Args:
        mask: Shape (H, W).
        scale: Metres in a pixel.
    """
    cv2 = _opencv()
    reach = max(round(_BRIDGED / scale), 1)
    kernel = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, kernel)
    count, labels = cv2.connectedComponents(closed, connectivity=4)
    found = []
    sizes = np.bincount(labels.ravel(), minlength=count)
    for label in range(1, count):
        if sizes[label] < 4:
            continue
        rows, columns = np.nonzero(labels == label)
        middle = columns.mean(), rows.mean()
        spread = np.cov(np.stack((columns, rows))) + np.eye(2) / 12.0
        values, vectors = np.linalg.eigh(spread)
        # A bar of length L has a variance of L^2 / 12.
        short, long = (np.sqrt(12.0 * np.maximum(values, 0.0)) * scale).tolist()
        if _SIZES[0] <= long <= _SIZES[1] and short <= 4.5:
            found.append((sizes[label], *middle, long, short, *vectors[:, 1], label))
    found.sort(reverse=True)
    table = np.array(found, np.float64).reshape(-1, 8)
    numbers = np.zeros(count, np.int32)
    numbers[table[:, 7].astype(int)] = np.arange(1, len(table) + 1)
    return Blobs(table[:, 1:3], table[:, 3], table[:, 4], table[:, 5:7], numbers[labels])


def _opencv() -> Any:  # noqa: ANN401  # a module
    try:
        import cv2
    except ImportError as error:
        raise MissingExtraError("a servo that sees colours", "policies") from error
    return cv2
