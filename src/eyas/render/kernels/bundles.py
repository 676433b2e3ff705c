"""The arrays that the kernels share, in named bundles.

T triangles, C chunks, P prototypes (fixtures first, then parts), M meshes (levels of detail,
grouped by prototype), F fixtures, I instances, K workers, J jobs (bands of views). Each chunk and
mesh begins with a triangle whose number is a multiple of 8: eight triangles in a row are a cluster,
which is drawn at once. What fills its last cluster up has no area.

Kernels get bundles of arrays by pointer, see `eyas.core.pointers`, and read them like the bundles
themselves. Numbers of a bundle are float32 if their names are those of light, else float64.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "GROUP",
    "NEAR",
    "Air",
    "Direction",
    "Geometry",
    "Illumination",
    "Job",
    "LampFrame",
    "Light",
    "MapFrame",
    "Movers",
    "Output",
    "Plane",
    "Planes",
    "Point",
    "Projection",
    "Row",
    "Scratch",
    "Task",
    "View",
]

NEAR = 0.08
"""Distance of the near plane [m]."""

GROUP = 16
"""Chunks, or fixtures, that are culled together first."""


class Geometry(NamedTuple):
    """Everything that can be drawn, packed once for each scene."""

    cluster: NDArray[np.float32]
    """Eight triangles in each cluster, see `eyas.render.kernels.visibility.clusters`: corners [m],
    those of static chunks in the world frame, of prototypes in their own; size; tiles in a metre of
    leaves; shape (T / 8, 11, 8)."""
    bounds: NDArray[np.float32]
    """Eight clusters of a mesh in each row, see the same: box, cone of the normals, size,
    shape (., 14, 8)."""
    corner_uv: NDArray[np.float32]
    """Texture coordinates u and v of corner a, of b and of c [tiles] of the eight triangles in each
    cluster, shape (T / 8, 6, 8)."""
    shading: NDArray[np.float32]
    """Data of each triangle for shading in one place, see `eyas.render.pack.triangles.SHADING`,
    shape (T, 32)."""
    material: NDArray[np.int32]
    """Material of each triangle, shape (T,)."""
    object_id: NDArray[np.int32]
    """Object id of each static triangle, -1 for prototypes, shape (T,)."""
    chunk_box: NDArray[np.float32]
    """Lower and upper corner [m] of each chunk in a column, then of boxes that are nowhere, up to
    a multiple of `GROUP`, shape (6, .)."""
    chunk_group_box: NDArray[np.float32]
    """Box around each `GROUP` chunks in a row, likewise up to a multiple of 8, shape (6, .)."""
    chunk_range: NDArray[np.int32]
    """First and last + 1 triangle, first row of `bounds`, shape (C, 3)."""
    mesh_range: NDArray[np.int32]
    """The same for each mesh, shape (M, 3)."""
    level_first: NDArray[np.int32]
    """First mesh of each prototype, shape (P + 1,)."""
    part_first: int
    """Prototype of part 0."""
    sphere: NDArray[np.float32]
    """Centre and radius around each prototype [m], shape (P, 4)."""
    box: NDArray[np.float32]
    """Lower and upper corner of each prototype [m], shape (P, 6)."""
    silhouette: NDArray[np.float32]
    """Two boxes for the shadow of each prototype: height of the waist between them; back, front,
    right and left end of the upper one; right and left end of the lower one [m], shape (P, 7)."""
    lamps: NDArray[np.bool_]
    """Whether things of which each prototype is the largest part have head and tail lamps, shape
    (P,)."""
    fixture_prototype: NDArray[np.int32]
    """Shape (F,)."""
    fixture_pose: NDArray[np.float32]
    """Shape (F, 3, 4)."""
    fixture_object: NDArray[np.int32]
    """Shape (F,)."""
    fixture_box: NDArray[np.float32]
    """Boxes around the fixtures, like `chunk_box`, shape (6, .)."""
    fixture_group_box: NDArray[np.float32]
    """Box around each `GROUP` fixtures in a row, like `chunk_group_box`, shape (6, .)."""
    layer: NDArray[np.int32]
    """Texture of each material."""
    surface: NDArray[np.int32]
    """`Surface` of each material."""
    tint: NDArray[np.float32]
    """Linear colour factor of each material, shape (., 3)."""
    texture: NDArray[np.uint32]
    """Texels of each layer, all mip levels in a row, row 0 at v = 0: square roots of linear red,
    green, blue, and alpha, a byte each, the lowest byte first, shape (., 87381)."""


class Direction(NamedTuple):
    """A vector, or a linear colour as red, green, blue, of float32."""

    x: float
    y: float
    z: float


class Air(NamedTuple):
    """Numbers of the weather, of float32."""

    density: float
    """Of fog [1/m]."""
    power: float
    """1 or 2: how its thickness grows with distance."""
    exposure: float
    offset: float
    """Distance by which points are moved off their surface for the shadow map [m]."""
    snow: float
    """This and the following: 0 to 1, see `eyas.state.lighting.Lighting`."""
    lamps: float
    windows: float
    clouds: float
    flakes: float


class Illumination(NamedTuple):
    """Light and air of one view; linear colours."""

    sun: Direction
    """Unit vector towards the sun."""
    sun_colour: Direction
    zenith: Direction
    horizon: Direction
    above: Direction
    """Light of the sky on surfaces that face up."""
    below: Direction
    """Light from the ground on surfaces that face down."""
    fog: Direction
    air: Air


class MapFrame(NamedTuple):
    """Where a map of the ground lies, of float32."""

    west: float
    """x of its western edge [m]."""
    south: float
    """y of its southern edge [m]."""
    per_metre: float
    """Texels in a metre."""
    ground: float
    """z of the ground [m]."""


class LampFrame(NamedTuple):
    """Where the grid of street lamps lies, of float32."""

    west: float
    south: float
    per_metre: float
    """Squares in a metre."""
    cut_off: float
    """Cosine of the angle beyond which the lamps give no light."""


class Light(NamedTuple):
    """Light of a weather, and the maps that tell what reaches a point."""

    weather: Illumination
    shadow_map: NDArray[np.uint16]
    """Height towards the sun of the first thing that sunlight meets, shape (rows, columns)."""
    shadow_rows: NDArray[np.float32]
    """World to column, row and height of the shadow map, shape (3, 4)."""
    ambient: NDArray[np.uint16]
    """Share of the sky's light on the ground and height of what hides it, see `AmbientMap`."""
    ambient_frame: MapFrame
    lamp: NDArray[np.float32]
    """Position [m], axis, strength and 0 for each street lamp, shape (L, 8)."""
    lamp_cell: NDArray[np.int32]
    """Lamps that may light each square of a grid, the nearest first, -1 after the last,
    shape (rows, columns, .)."""
    lamp_frame: LampFrame
    tracks: NDArray[np.uint8]
    """Wear of the snow on roads, see `eyas.render.bake.tracks.TrackMap`."""
    track_frame: MapFrame
    tone: NDArray[np.uint8]
    """Byte of the picture for each step of exposed radiance."""
    ground: Direction
    """Colour of far land without snow, see `eyas.render.bake.hills`."""
    clouds: NDArray[np.uint8]
    """Opacity, and brightness times opacity, see `eyas.render.bake.clouds`,
    shape (rows, columns, 2)."""
    hills: NDArray[np.uint8]
    """Cover, sunlight, woods and farness, see `eyas.render.bake.hills`,
    shape (rows, columns, 4)."""


class Movers(NamedTuple):
    """The draw list of each world, see `eyas.state.draw.DrawList`."""

    part: NDArray[np.int32]
    pose: NDArray[np.float32]
    colour: NDArray[np.float32]
    object_id: NDArray[np.int32]


class Job(NamedTuple):
    """The cameras, and which rows of which view each job draws."""

    band: NDArray[np.int32]
    """View, first row, last row + 1, shape (J, 3)."""
    begun: NDArray[np.int64]
    """Number of jobs begun, at first one for each worker, shape (1,)."""
    eye: NDArray[np.float64]
    """Optical centres [m], shape (V, 3)."""
    axes: NDArray[np.float64]
    """Forward, left, up as rows, shape (V, 3, 3)."""
    world: NDArray[np.int32]
    """Shape (V,)."""
    subject: NDArray[np.int32]
    """Shape (V,)."""
    light: NDArray[np.float32]
    """Factor on the sky and its light, factor on the sun, fog density [1/m], shape (V, 3)."""
    instant: NDArray[np.float64]
    """Time for falling snow [s], shape (V,), or (0,) if none falls."""
    focal: NDArray[np.float64]
    """Focal length along rows and along columns [pixels], shape (V, 2)."""


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
    distance: Row
    """Along the optical axis [m]."""


class Plane(NamedTuple):
    """Points inside have `x * px + y * py + z * pz + w >= 0`; of float64."""

    x: float
    y: float
    z: float
    w: float
    length: float
    """Of the normal (x, y, z)."""


class Planes(NamedTuple):
    """Planes around the space that a band shows."""

    left: Plane
    right: Plane
    top: Plane
    bottom: Plane
    near: Plane


class View(NamedTuple):
    """A band of a view: where its samples are in the world."""

    eye: Point
    """Optical centre."""
    ahead: Point
    """Unit vector along the optical axis; the next two are to the left and up."""
    left: Point
    up: Point
    focal_x: float
    """Focal length along rows [samples]."""
    focal_y: float
    """The same along columns."""
    focal: float
    """Mean of both [pixels]."""
    width: int
    """Size of the whole picture [samples]."""
    height: int
    top: int
    """First row of samples of the band."""
    rows: int
    """Number of rows of samples in the band."""
    samples: int
    """Samples along a side of each pixel, 1 or 2."""
    screen: Projection
    """World to screen."""
    planes: Planes


class Scratch(NamedTuple):
    """Working memory of each worker. Its planes have as many columns as a picture whose width is a
    multiple of 8 pixels; those beyond the width of the picture stay sky.
    """

    key: NDArray[np.int64]
    """What each sample shows, see `eyas.render.kernels.visibility.key`,
    shape (K, rows, columns)."""
    alone: NDArray[np.int64]
    """The same for one actor without all else, shape (K, rows, columns), or (K, 0, 0)."""
    shade: NDArray[np.uint8]
    """Sun and sky light that moving things let through, 255 for all, and light of vehicles' head
    and tail lamps, shape (K, rows, columns, 4)."""
    drawn: NDArray[np.int32]
    """Visible instances: first triangle of the mesh, and the instance: a fixture, or F + a slot
    of the draw list, shape (K, I, 2)."""
    mesh: NDArray[np.int32]
    """Mesh of each of them, shape (K, I)."""
    order: NDArray[np.int64]
    """What to draw, the nearest first: sort keys of visible chunks and instances,
    shape (K, C + I)."""
    triangle: NDArray[np.float64]
    """Eight triangles on the screen, see `eyas.render.kernels.visibility.triangles`,
    shape (K, 28, 8)."""
    polygon: NDArray[np.float64]
    """The triangles that the near plane leaves of one: column, row [samples] and 1/distance [1/m]
    of corner a, of b and of c, then their texture coordinates [tiles], shape (K, 15, 8)."""
    span: NDArray[np.int32]
    """A triangle in eight rows of samples, see `eyas.render.kernels.visibility.fill`,
    shape (K, 7, 8)."""


class Output(NamedTuple):
    """Arrays to write; those of length 0 are not wanted."""

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    object_id: NDArray[np.int32]
    subject: NDArray[np.int32]
    """Left, top, right, bottom, seen and covered pixels of the view's subject in each job, all 0
    if it covers none, shape (J, 6)."""
    actor: NDArray[np.int32]
    """The same for each actor of the view's world, shape (J, A, 6)."""


class Task(NamedTuple):
    """Inputs that change from picture to picture."""

    samples: int
    """Samples along a side of each pixel, 1 or 2."""
    width: int
    """Size of the pictures [pixels]."""
    height: int
    until: int
    """The last `eyas.state.draw.DrawStage`."""
    job: Job
