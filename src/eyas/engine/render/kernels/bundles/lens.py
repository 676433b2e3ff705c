"""Where the samples of pictures lie that are seen through lenses."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.lens import Lens

FACES = 5  # Most pictures of a pinhole, its faces, that are drawn for one through a lens

DARK = -1  # Face of a pixel to which no light comes

ELSEWHERE = -1  # Key of a sample that another face shows

LENS_TILE = 16  # Samples along a side of the squares of `LensTables.tile`.


class LensTables(NamedTuple):
    """L lenses for pictures of one size, each drawn as up to F faces: pictures of a pinhole with
    the same optical centre, in which every sample of the picture has its place.
    """

    column: NDArray[np.float32]
    """Place of each sample in its face [samples], shape (L, rows, columns); the number of columns
    is a multiple of 8 pixels."""
    line: NDArray[np.float32]
    size: NDArray[np.float32]
    """Width of what the sample shows, in those of the face, shape (L, rows, columns)."""
    face: NDArray[np.int32]
    """Face that shows it, the same in all samples of a pixel, or `DARK`,
    shape (L, rows, columns)."""
    faces: NDArray[np.int32]  # Number of faces, shape (L,)
    dark: NDArray[np.int32]  # 1: some pixels are dark, shape (L,)
    turn: NDArray[np.float64]
    """Axes of the faces, forward, left, up as rows, in the camera's, shape (L, F, 3, 3)."""
    focal: NDArray[np.float64]
    """Their focal lengths along rows and columns [pixels], shape (L, F, 2)."""
    extent: NDArray[np.int32]  # Their widths and heights [pixels], shape (L, F, 2)
    row: NDArray[np.int32]
    """First row of pixels of a face, and the one after the last, that a row of pixels of the
    picture needs, shape (L, F, rows of pixels, 2)."""
    tile: NDArray[np.int32]
    """Left, top, right, bottom [samples], the last two exclusive, of the part of the picture that
    each `LENS_TILE` x `LENS_TILE` samples of a face are seen in, shape (L, F, rows, columns, 4)."""
    lens: NDArray[np.float64]  # The numbers of `eyas.engine.core.optics.lens.Lens`, shape (L, 10).
    camera: NDArray[np.float64]
    """Focal length along rows and columns, column and row of the principal point [pixels],
    shape (L, 4)."""


class Glass(NamedTuple):
    """A face of a view, and the lens through which it is seen."""

    on: int  # 1: there is a lens; 0: nothing else here is read
    column: NDArray[np.float32]
    """This and the next two: the band's rows of `LensTables`, shape (rows, columns)."""
    line: NDArray[np.float32]
    size: NDArray[np.float32]
    face: NDArray[np.int32]
    number: int  # The face
    tile: NDArray[np.int32]  # See `LensTables`, shape (rows, columns, 4)
    turn: NDArray[np.float64]  # See `LensTables`, shape (3, 3)
    top: int  # First row of the band [pixels]
    lens: Lens
    focal_x: float  # [pixels]
    focal_y: float
    middle: float  # Column of the principal point [pixels]
    centre: float  # Its row in the band [pixels]
