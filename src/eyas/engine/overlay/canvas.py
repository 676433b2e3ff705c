"""The picture on which an overlay is drawn, and its camera."""

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.core.optics import lens
from eyas.engine.core.optics.lens import Lens
from eyas.engine.core.optics.pinhole import project
from eyas.engine.state.draw import Views
from eyas.lanes import exact

NEAR = 0.1  # Nearer parts than this are not drawn [m]

Floats = NDArray[np.float32]

CASING = (0.04, 0.05, 0.07)  # Colour of the outlines, which make marks visible on any ground


SPARSE = 0.3  # Share of a window's pixels below which only those that are touched are blended


class Canvas:
    """The colours of picture `v` of some views, to paint on.

    Attributes:
        depth: Distance along the optical axis at the pixels' centres [m], shape (H, W).
        unit: Width of the thinnest strokes [pixels], for a picture of this size.
        lens: The lens; None: a pinhole.
    """

    def __init__(
        self,
        views: Views,  # The cameras
        v: int,  # Index of the view
        rgb: NDArray[np.uint8],  # Its picture, shape (H, W, 3); not changed
        depth: NDArray[np.float32],  # As above
    ) -> None:
        self.depth = depth
        self.height, self.width = depth.shape
        self.position = np.asarray(views.position[v], np.float64)
        self.rotation = np.asarray(views.rotation[v], np.float64)
        self._fields = views.fields_of(v)
        self.across, self.down = views.focal(self.height, self.width)[v].tolist()
        self.lens = None if views.lens is None else _lens_of(views.lens[v])
        self.unit = max(1.0, self.height / 360)
        self._colour = rgb.astype(np.float32)

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return column, row [pixels] and depth [m] of points, shape (..., 3); see `pinhole`."""
        size = self.width, self.height
        if self.lens is not None:
            bent = lens.project(points, self.position, self.rotation, size, self._fields, self.lens)
            return np.stack(bent, -1)
        return np.stack(project(points, self.position, self.rotation, *size, *self._fields), -1)

    def window(self, low: ArrayLike, high: ArrayLike, margin: float) -> tuple[slice, slice]:
        """Return the rows and columns in the picture that a box of columns and rows covers."""
        limit = (self.width, self.height)
        first = np.clip(np.floor(np.asarray(low) - margin), 0, limit).astype(int)
        last = np.clip(np.ceil(np.asarray(high) + margin), 0, limit).astype(int)
        return slice(first[1], last[1]), slice(first[0], last[0])

    def plane(
        self,
        normal: ArrayLike,  # Camera frame: forward, left, up, shape (3,)
        where: tuple[slice, slice],  # Rows and columns
    ) -> NDArray[np.float32]:
        """Return normal times ray for each pixel of a window; rays have length 1 along the axis."""
        forward, left, up = np.asarray(normal, np.float64)
        if self.lens is not None:
            ray = self._rays[where]
            return np.asarray(forward + left * ray[..., 1] + up * ray[..., 2], np.float32)
        rows, columns = (np.arange(part.start, part.stop) + 0.5 for part in where)
        row = forward + up * (0.5 * self.height - rows) / self.down
        column = left * (0.5 * self.width - columns) / self.across
        plane: NDArray[np.float32] = row[:, None].astype(np.float32) + column.astype(np.float32)
        return plane

    def distance(self, normal: NDArray[np.float64], where: tuple[slice, slice]) -> Floats:
        """Return how far pixels of a window are from where `plane` is 0 [pixels]."""
        if self.lens is None:
            slope = float(exact.hypot(normal[1] / self.across, normal[2] / self.down))
            return self.plane(normal / max(slope, 1e-12), where)
        height, width = (part.stop - part.start for part in where)
        if min(height, width) < 2:
            return np.full((height, width), -1.0, np.float32)
        # The line is bent: how fast the plane's equation grows differs from place to place.
        plane = self.plane(normal, where)
        below, aside = np.gradient(plane)
        slope_there = np.sqrt(np.square(below) + np.square(aside))
        away = plane / np.maximum(slope_there, np.float32(1e-12))
        return np.asarray(np.nan_to_num(away, nan=-1.0), np.float32)

    @cached_property
    def _rays(self) -> NDArray[np.float64]:
        """Directions of all pixels, forward, left, up, of length 1 along the axis, (H, W, 3)."""
        assert self.lens is not None
        return lens.rays(np.eye(3), (self.width, self.height), self._fields, self.lens)

    def blend(
        self,
        where: tuple[slice, slice],
        colour: ArrayLike,
        share: NDArray[np.floating] | NDArray[np.bool_],
    ) -> None:
        """Mix a colour, sRGB 0 to 1, into a window's pixels, with a share of 0 to 1 for each."""
        touched = np.nonzero(share)
        if len(touched[0]) < SPARSE * share.size:
            rows, columns = (part + side.start for part, side in zip(touched, where, strict=True))
            above = np.asarray(colour)
            above = above[touched] if above.ndim > 1 else above
            self.blend_pixels(rows, columns, above, share[touched])
        else:
            below = self._colour[where]
            above = np.asarray(colour, np.float32) * np.float32(255.0)
            below += (above - below) * share[..., None].astype(np.float32)

    def blend_pixels(
        self,
        rows: NDArray[np.int64],
        columns: NDArray[np.int64],
        colour: ArrayLike,
        share: NDArray[np.floating] | NDArray[np.bool_],
    ) -> None:
        """Mix a colour into pixels, each of which is named once; see `blend`."""
        below = self._colour[rows, columns]
        above = np.asarray(colour, np.float32) * np.float32(255.0)
        self._colour[rows, columns] = below + (above - below) * share[:, None].astype(np.float32)

    def finished(self) -> NDArray[np.uint8]:
        """Return the colours, shape (H, W, 3)."""
        return np.rint(self._colour).astype(np.uint8)


def _lens_of(numbers: NDArray[np.float64]) -> Lens:
    return Lens(int(numbers[0]), *numbers[1:].tolist())


def cover(
    inside: NDArray[np.floating],  # Distance of its centre from the edge, positive inside [pixels]
) -> NDArray[np.floating]:
    """Return how much of a pixel lies inside a straight edge, 0 to 1."""
    covered: NDArray[np.floating] = np.clip(inside + 0.5, 0.0, 1.0)
    return covered
