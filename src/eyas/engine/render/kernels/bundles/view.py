"""Where cameras are, and what they show."""

from typing import NamedTuple

NEAR = 0.08  # Distance of the near plane [m]


class Point(NamedTuple):
    """A point or a vector in the world, of float64 [m]."""

    x: float
    y: float
    z: float


class Row(NamedTuple):
    """A row of a transformation: `x * px + y * py + z * pz + w`, of float64."""

    x: float
    y: float
    z: float
    w: float


class Projection(NamedTuple):
    """World, or an object's own frame, to the screen: column and row are those of a sample times
    its distance, from the middle of the picture.
    """

    column: Row
    row: Row
    distance: Row  # Along the optical axis [m]


class Plane(NamedTuple):
    """Points inside have `x * px + y * py + z * pz + w >= 0`; of float64."""

    x: float
    y: float
    z: float
    w: float
    length: float  # Of the normal (x, y, z)


class Planes(NamedTuple):
    """Planes around the space that a band shows."""

    left: Plane
    right: Plane
    top: Plane
    bottom: Plane
    near: Plane


class View(NamedTuple):
    """A band of a view: where its samples are in the world."""

    eye: Point  # Optical centre
    ahead: Point  # Unit vector along the optical axis; the next two are to the left and up
    left: Point
    up: Point
    focal_x: float  # Focal length along rows [samples]
    focal_y: float  # The same along columns
    focal: float  # Mean of both [pixels]
    width: int  # Size of the whole picture [samples]
    height: int
    top: int  # First row of samples of the band
    rows: int  # Number of rows of samples in the band
    across: int  # Samples along a row of each pixel, 1 or 2
    down: int  # Samples along a column of each pixel, 1 or 2
    screen: Projection  # World to screen
    planes: Planes
