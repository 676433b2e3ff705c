"""What to draw, into which arrays, with what working memory."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.lighting import LightState


class Job(NamedTuple):
    """The cameras, and which rows of which view each job draws."""

    picture: NDArray[np.int32]  # Picture that each view is drawn into, shape (V,)

    band: NDArray[np.int32]  # View, first row, last row + 1, shape (J, 3)
    begun: NDArray[np.int64]  # Number of jobs begun, at first one for each worker, shape (1,)
    eye: NDArray[np.float64]  # Optical centres [m], shape (V, 3)
    axes: NDArray[np.float64]  # Forward, left, up as rows, shape (V, 3, 3)
    world: NDArray[np.int32]  # Shape (V,)
    subject: NDArray[np.int32]  # Shape (V,)
    light: LightState
    instant: NDArray[np.float64]
    """Time for what falls and for the wind [s], shape (V,), or (0,) if neither is shown."""
    focal: NDArray[np.float64]  # Focal length along rows and along columns [pixels], shape (V, 2)
    lens: NDArray[np.int32]
    """Row of `LensTables` of each view, shape (V,), or (0,) if no lens bends the pictures."""


class Scratch(NamedTuple):
    """Working memory of each worker. Its planes have as many columns as a picture whose width is a
    multiple of 8 pixels; those beyond the width of the picture stay sky.
    """

    key: NDArray[np.int64]
    """What each sample shows, see `eyas.engine.render.kernels.visibility.key`,
    shape (K, rows, columns)."""
    alone: NDArray[np.int64]
    """The same for one actor without all else, shape (K, rows, columns), or (K, 0, 0)."""
    shade: NDArray[np.uint8]
    """Sun and sky light that moving things let through, 255 for all, and light of vehicles' head
    and tail lamps, shape (K, rows, columns, 4)."""
    drawn: NDArray[np.int32]
    """Visible instances: first triangle of the mesh, and the instance: a fixture, or F + a slot
    of the draw list, shape (K, I, 2)."""
    mesh: NDArray[np.int32]  # Mesh of each of them, shape (K, I)
    tiles: NDArray[np.float32]
    """Farthest 1/distance in each 8 x 8 samples, see
    `eyas.engine.render.kernels.visibility.occlusion`, shape (K, rows / 8, columns / 8)."""
    order: NDArray[np.int64]
    """What to draw, the nearest first: sort keys of visible chunks and instances,
    shape (K, C + I)."""
    triangle: NDArray[np.float64]
    """Eight triangles on the screen, see `eyas.engine.render.kernels.visibility.triangles`,
    shape (K, 28, 8)."""
    polygon: NDArray[np.float64]
    """The triangles that the near plane leaves of one: column, row [samples] and 1/distance [1/m]
    of corner a, of b and of c, then their texture coordinates [tiles], shape (K, 15, 8)."""
    span: NDArray[np.int32]
    """A triangle in eight rows of samples, see `eyas.engine.render.kernels.visibility.fill`,
    shape (K, 7, 8)."""
    word: NDArray[np.uint32]  # `shade` again, four bytes in each element, shape (K, rows, columns)
    bent_key: NDArray[np.int64]
    """`key` as the picture shows it through a lens, `ELSEWHERE` where another face does,
    shape (K, rows, columns), or (K, 0, 0)."""
    bent_shade: NDArray[np.uint8]
    """`shade` in the same way, shape (K, rows, columns, 4), or (K, 0, 0, 4)."""
    leaning: NDArray[np.float32]
    """Poses of the visible fixtures in the wind, the rows of `drawn`, shape (K, I, 3, 4), or
    (K, 0, 3, 4) in calm air."""
    item: NDArray[np.float64]
    """What a view shows, see `eyas.engine.render.kernels.visibility.items`, shape (K, C + I, 21);
    this and the next three are empty where one worker draws all of a band.
    """
    item_row: NDArray[np.int64]
    """Rows of `Geometry.bounds` that the items before each have, shape (K, C + I + 1)."""
    seen: NDArray[np.int64]
    """Clusters that may be seen: item and row of `Geometry.cluster`, shape (K, .)."""
    found: NDArray[np.int64]
    """How many those are, and how many rows of `Geometry.bounds` all items have, shape (K, 2)."""
    record: NDArray[np.float64]
    """Triangles to be filled later, eight in each like `triangle`, shape (K, R / 8, 28, 8), or
    (K, 0, 28, 8) where they are filled at once, and when there is no room for more."""
    record_shown: NDArray[np.int64]
    """Their tags, and layer and mip level of their holes, -1: none, shape (K, R, 2)."""
    unit: NDArray[np.int32]
    """A row of one of them: its number times 1,024, and which row; -1: none, shape (K, U)."""
    recorded: NDArray[np.int64]  # Rows asked for, in the upper half, and records, shape (K, 1)
    line: NDArray[np.uint8]  # Rows of a picture, see `eyas.engine.render.kernels.tent.filter_rows`
    total: NDArray[np.uint32]  # Their sums
    bent_tile: NDArray[np.int32]
    """What stands for `Glass.tile` where there is no lens, shape (0, 0, 4)."""


class Output(NamedTuple):
    """Arrays to write; those of length 0 are not wanted."""

    rgb: NDArray[np.uint8]
    radiance: NDArray[np.float32]
    depth: NDArray[np.float32]
    object_id: NDArray[np.int32]
    class_id: NDArray[np.uint8]
    normal: NDArray[np.uint8]
    subject: NDArray[np.int32]
    """Left, top, right, bottom, seen and covered pixels of the view's subject in each job, all 0
    if it covers none, then left, top, right, bottom of the seen ones, shape (J, 10)."""
    actor: NDArray[np.int32]  # The same for each actor of the view's world, shape (J, A, 10)


class Canvas(NamedTuple):
    """Where the colours of a band are written: as bytes, or as radiance; the other is empty."""

    pixels: NDArray[np.uint8]  # sRGB, shape (rows, columns, 3)
    red: NDArray[np.float32]  # Linear radiance, shape (rows, columns)
    green: NDArray[np.float32]
    blue: NDArray[np.float32]


class Task(NamedTuple):
    """Inputs that change from picture to picture."""

    across: int  # Samples along a row of each pixel, 1 or 2
    down: int  # Samples along a column of each pixel, 1 or 2
    width: int  # Size of the pictures [pixels]
    height: int
    falls: int  # 1: flakes, drops and leaves are drawn at the views' instants
    until: int  # The last `eyas.engine.state.draw.DrawStage`.
    job: Job
    tent: int = 0  # 1: jobs draw whole pictures, and filter their bytes, see `tent.filter_rows`
