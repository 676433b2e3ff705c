"""The arrays that the kernels share, in named bundles.

V vertices, T triangles, C chunks, P prototypes (fixtures first, then parts), M meshes (levels of
detail, grouped by prototype), F fixtures, K workers, J jobs (bands of views).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "GROUP",
    "NEAR",
    "Geometry",
    "Job",
    "Light",
    "Movers",
    "Output",
    "Scratch",
    "Still",
    "Task",
    "View",
]

NEAR = 0.08
"""Distance of the near plane [m]."""

GROUP = 16
"""Chunks, or fixtures, that are culled together first."""


class Geometry(NamedTuple):
    """Everything that can be drawn, packed once for each scene."""

    positions: NDArray[np.float32]
    """[m], shape (V, 3); static chunks in the world frame, prototypes in their own."""
    uvs: NDArray[np.float32]
    """Texture coordinates [tiles], shape (V, 2)."""
    corners: NDArray[np.int32]
    """Vertices of each triangle, shape (T, 3)."""
    gradients: NDArray[np.float32]
    """Data of each triangle for shading, shape (T, 24): a corner; then gradient and value at
    that corner of u and of v; normal at the corner; gradients of the three components of the
    normal; texture tiles in a metre, negative where the normal is not the same all over."""
    material: NDArray[np.int32]
    """Material of each triangle, shape (T,)."""
    size: NDArray[np.float32]
    """Root of the area [m] of each triangle that is a detail, seen before something larger, and
    may be left out when it is small; infinite for others; falling in each chunk, shape (T,)."""
    object_id: NDArray[np.int32]
    """Object id of each static triangle, -1 for prototypes, shape (T,)."""
    chunk_box: NDArray[np.float32]
    """Lower and upper corner [m], shape (C, 6)."""
    chunk_group_box: NDArray[np.float32]
    """Box around each `GROUP` chunks in a row, shape (., 6)."""
    chunk_range: NDArray[np.int32]
    """First and last + 1 triangle, first and last + 1 vertex, shape (C, 4)."""
    mesh_range: NDArray[np.int32]
    """The same for each mesh, shape (M, 4)."""
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
    fixture_group_box: NDArray[np.float32]
    """Box around each `GROUP` fixtures in a row, shape (., 6)."""
    layer: NDArray[np.int32]
    """Texture of each material."""
    surface: NDArray[np.int32]
    """`Surface` of each material."""
    tint: NDArray[np.float32]
    """Linear colour factor of each material, shape (., 3)."""
    emission: NDArray[np.float32]
    """Own light of each material."""
    snow_bed: NDArray[np.int32]
    """`eyas.render.kernels.surface.snow.Bed` of each material."""
    crown_middle: NDArray[np.float32]
    """z of the middle of the crowns made of each material, in the frame of their trees."""
    texture: NDArray[np.uint32]
    """Texels of each layer, all mip levels in a row, row 0 at v = 0: square roots of linear red,
    green, blue, and alpha, a byte each, the lowest byte first, shape (., 87381)."""


class Light(NamedTuple):
    """Light and air; linear colours, shape (3,) each."""

    sun: NDArray[np.float32]
    """Unit vector towards the sun."""
    sun_colour: NDArray[np.float32]
    zenith: NDArray[np.float32]
    horizon: NDArray[np.float32]
    ambient_up: NDArray[np.float32]
    ambient_down: NDArray[np.float32]
    fog: NDArray[np.float32]
    air: NDArray[np.float32]
    """Fog density [1/m] and power, exposure, offset of shadows [m], snow, lamps, windows, clouds
    and flakes (0 to 1 each, see `eyas.state.scene.Lighting`), shape (9,)."""
    shadow_map: NDArray[np.uint16]
    """Height towards the sun of the first thing that sunlight meets, shape (rows, columns)."""
    shadow_rows: NDArray[np.float32]
    """World to column, row and height of the shadow map, shape (3, 4)."""
    ambient: NDArray[np.uint16]
    """Share of the sky's light on the ground and height of what hides it, see `AmbientMap`."""
    ambient_frame: NDArray[np.float32]
    """West and south edge of that map [m], texels per metre, z of the ground [m]."""
    lamp: NDArray[np.float32]
    """Position [m], axis and strength of each street lamp, shape (L, 7)."""
    lamp_cell: NDArray[np.int32]
    """Lamps that may light each square of a grid, the nearest first, -1 after the last,
    shape (rows, columns, .)."""
    lamp_frame: NDArray[np.float32]
    """West and south edge of the grid [m], squares per metre, cosine of the lamps' cut-off."""
    tracks: NDArray[np.uint8]
    """Wear of the snow on roads, see `eyas.render.bake.tracks.TrackMap`."""
    track_frame: NDArray[np.float32]
    """West and south edge of that map [m], texels per metre."""
    tone: NDArray[np.uint8]
    """Byte of the picture for each step of exposed radiance."""
    ground: NDArray[np.float32]
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
    lens: NDArray[np.float64]
    """Focal length along rows, width, height [samples], mean focal length [pixels], focal length
    along columns [samples], shape (5,)."""


class View(NamedTuple):
    """A band of a view: where its samples are in the world, and what they show."""

    eye: NDArray[np.float64]
    """Optical centre, see `Job`, shape (3,)."""
    axes: NDArray[np.float64]
    """Axes of the camera, see `Job`, shape (3, 3)."""
    lens: NDArray[np.float64]
    """See `Job`."""
    top: int
    """Row of samples of the view that is row 0 of the band."""
    rows: NDArray[np.float64]
    """World to screen, see `Scratch`, shape (3, 4)."""
    planes: NDArray[np.float64]
    """See `Scratch`, shape (5, 5)."""
    depth: NDArray[np.float32]
    """See `Scratch`, shape (rows, columns)."""
    owner: NDArray[np.int64]
    """See `Scratch`, shape (rows, columns)."""


class Scratch(NamedTuple):
    """Working memory of each worker."""

    depth: NDArray[np.float32]
    """One over the distance along the optical axis, 0 for sky, shape (K, rows, columns)."""
    owner: NDArray[np.int64]
    """(instance + 1) << 32 | triangle, -1 for sky; instance -1 is the static mesh, then come
    the fixtures, then the slots of the draw list. Shape (K, rows, columns)."""
    shade: NDArray[np.uint8]
    """Sun and sky light that moving things let through, 255 for all, and light of vehicles' head
    and tail lamps, shape (K, rows, columns, 4)."""
    screen: NDArray[np.float64]
    """Column, row, 1/distance, distance of a mesh's vertices, shape (K, ., 4)."""
    order: NDArray[np.int64]
    """Sort keys of visible chunks, shape (K, C)."""
    planes: NDArray[np.float64]
    """Left, right, top, bottom, near plane and the length of their normals, shape (K, 5, 5)."""
    rows: NDArray[np.float64]
    """World, then object, to screen, shape (K, 2, 3, 4)."""
    polygon: NDArray[np.float64]
    """A clipped triangle: column, row, 1/distance, u, v, shape (K, 4, 5)."""
    frame: NDArray[np.float32]
    """Pose of the instance that is being shaded row by row, its linear colour, one over its scale
    squared, shape (K, 16)."""
    light: NDArray[np.float32]
    """The colours of `Light` for the view, then its air, shape (K, 7, 9)."""
    caster: NDArray[np.float64]
    """A moving thing's boxes, see `_set_caster`, shape (K, 16)."""


class Output(NamedTuple):
    """Arrays to write; those of length 0 are not wanted."""

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    object_id: NDArray[np.int32]
    subject: NDArray[np.int32]
    """Left, top, right, bottom, seen and covered pixels in each job, shape (J, 6)."""


class Still(NamedTuple):
    """Inputs that stay the same from picture to picture."""

    geometry: Geometry
    light: Light


class Task(NamedTuple):
    """Inputs that change from picture to picture."""

    samples: int
    """Samples along a side of each pixel, 1 or 2."""
    until: int
    """The last `eyas.state.draw.DrawStage`."""
    movers: Movers
    job: Job
    output: Output
