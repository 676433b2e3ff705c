"""What stands still and looks like a thing that moves: what a picture shows of it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.lens import NO_LENS, Lens, distorted, principal_point
from eyas.engine.core.optics.pinhole import focal_length
from eyas.engine.render.kernels.bundles import NEAR
from eyas.engine.render.kernels.scalars import i8
from eyas.engine.state.scene import LABELLED, LAST_PARKED, ObjectClass, Scene
from eyas.engine.state.snapshot import CameraState
from eyas.lanes import PackedBundle, compiled, exact, kernel

Floats = NDArray[np.float64]

_APART = 0.1
"""What hides an object is nearer than it by more than this [m]; less is rounding of its edges."""


_FAR = 1e9  # Columns and rows beyond this are no places [pixels]


class ParkedObject(NamedTuple):
    """A parked object: a car in a bay, a boat, a train, or a rack of bicycles."""

    object_id: int
    type: str  # Name of its kind on the map
    object_class: ObjectClass
    foot: tuple[float, float, float]  # Middle of its underside, world frame [m]
    size: tuple[float, float, float]  # Length, width, height [m]
    yaw: float  # Heading, counter-clockwise from east [rad]


class SeenParked(NamedTuple):
    """A parked object in a picture; boxes and pixels are as those of `exports.frame.Subject`."""

    what: ParkedObject
    box: NDArray[np.int32]
    visible_box: NDArray[np.int32]
    whole_box: Floats
    seen_pixels: int
    covered_pixels: int


class _Copies(NamedTuple):
    """The copies that R parked objects are made of, object by object."""

    row: NDArray[np.int32]  # Row of the parked object with each id, -1 for other ids, shape (ids,)
    first_copy: NDArray[np.int64]
    """First copy of each object, and the number of all, shape (R + 1,)."""
    pose: NDArray[np.float32]  # See `Fixtures`, shape (C, 3, 4)
    prototype: NDArray[np.int64]  # Prototype of each copy, one of the P that are used, shape (C,)
    first_vertex: NDArray[np.int64]
    """First vertex of each prototype, and the number of all, shape (P + 1,)."""
    vertex: NDArray[np.float32]  # Of their finest meshes [m], shape (V, 3)
    first_triangle: NDArray[np.int64]
    """First triangle of each prototype, and the number of all, shape (P + 1,)."""
    triangle: NDArray[np.int32]
    """Vertices of each triangle, counted from the prototype's first, shape (T, 3)."""


class _Query(NamedTuple):
    """A picture, its camera, and what it shows of the R objects."""

    shown: NDArray[np.int32]  # Object of each pixel, shape (H, W)
    depth: NDArray[np.float32]  # Distance of each pixel along the optical axis [m], shape (H, W)
    eye: Floats  # Optical centre [m], shape (3,)
    axes: Floats  # Camera to world; columns forward, left, up, shape (3, 3)
    camera: Floats  # Focal length, and the principal point [pixels], shape (3,)
    bent: int  # 1: `lens` bends the picture
    lens: Lens
    near: NDArray[np.float32]
    """Inverse distances of one object at a time [1/m]; all 0 before and after, shape (H, W)."""
    place: Floats
    """Column, row and inverse distance [1/m] of the vertices of a copy, shape (most, 3)."""
    pixels: NDArray[np.int32]  # Visible and hidden pixels of each object, shape (R, 2)
    visible_box: NDArray[np.int32]
    """Left, top, right, bottom of the visible ones [pixels], shape (R, 4)."""
    box: NDArray[np.int32]  # The same of all of them, shape (R, 4)
    whole_box: Floats  # The same of its vertices, shape (R, 4)


class ParkedObjects:
    """All parked objects of a scene."""

    def __init__(self, scene: Scene) -> None:
        fixtures = scene.fixtures
        parked = np.isin(scene.object_class, [int(kind) for kind in LABELLED])
        parked[:1] = parked[LAST_PARKED + 1 :] = False  # 0 is nothing in masks
        copies = np.flatnonzero(parked[fixtures.object_id])
        copies = copies[np.argsort(fixtures.object_id[copies], kind="stable")]
        ids, first = np.unique(fixtures.object_id[copies], return_index=True)
        rows = np.full(len(parked), -1, np.int32)
        rows[ids] = np.arange(len(ids))
        used, prototype = np.unique(fixtures.prototype[copies], return_inverse=True)
        meshes = [fixtures.levels[kind][0] for kind in used.tolist()]
        vertices = [mesh.positions for mesh in meshes]
        triangles = [mesh.triangles for mesh in meshes]
        self._place = np.zeros((max(map(len, vertices), default=0), 3))
        self._near = np.zeros((0, 0), np.float32)
        self._copies = PackedBundle(
            _Copies(
                row=rows,
                first_copy=np.append(first, len(copies)).astype(np.int64),
                pose=np.ascontiguousarray(fixtures.pose[copies]),
                prototype=prototype.astype(np.int64),
                first_vertex=np.cumsum([0, *map(len, vertices)]).astype(np.int64),
                vertex=np.concatenate([np.zeros((0, 3), np.float32), *vertices]),
                first_triangle=np.cumsum([0, *map(len, triangles)]).astype(np.int64),
                triangle=np.concatenate([np.zeros((0, 3), np.int32), *triangles]),
            )
        )
        extents = [
            np.array([mesh.positions.min(axis=0), mesh.positions.max(axis=0)], np.float64)
            for mesh in meshes
        ]
        self.objects = tuple(
            _object(scene, number, own, [extents[kind] for kind in kinds.tolist()])
            for number, own, kinds in zip(
                ids.tolist(), np.split(copies, first[1:]), np.split(prototype, first[1:]),
                strict=True,
            )
        ) if len(ids) else ()  # fmt: skip

    def seen(
        self,
        shown: NDArray[np.int32],  # Object of each pixel, shape (H, W)
        # Distance of each pixel along the optical axis [m], shape (H, W)
        depth: NDArray[np.float32],
        cameras: CameraState,  # The cameras of all trackers
        tracker: int,  # Whose picture it is
        lens: Lens | None = None,  # Its lens; None: a pinhole
    ) -> list[SeenParked]:
        """Return the objects of which a picture shows a pixel, in the order of their ids."""
        if not self.objects:
            return []
        height, width = shown.shape
        count = len(self.objects)
        if self._near.shape != shown.shape:  # kept, as new memory takes longer than the rest
            self._near = np.zeros(shown.shape, np.float32)
        nothing = np.array([_FAR, _FAR, -_FAR, -_FAR])
        focal = focal_length(width, float(cameras.field_of_view[tracker]))
        query = _Query(
            shown=shown,
            depth=depth,
            eye=cameras.position[tracker],
            axes=cameras.rotation[tracker],
            camera=np.array([focal, *principal_point(lens or NO_LENS, width, height)]),
            bent=int(lens is not None),
            lens=lens or NO_LENS,
            near=self._near,
            place=self._place,
            pixels=np.zeros((count, 2), np.int32),
            visible_box=np.tile(nothing.astype(np.int32), (count, 1)),
            box=np.tile(nothing.astype(np.int32), (count, 1)),
            whole_box=np.tile(nothing, (count, 1)),
        )
        _measure(self._copies, query)
        return [
            SeenParked(
                what=self.objects[row],
                box=query.box[row],
                visible_box=query.visible_box[row],
                whole_box=whole if whole[0] <= whole[2] else np.zeros(4),
                seen_pixels=int(query.pixels[row, 0]),
                covered_pixels=int(query.pixels[row].sum()),
            )
            for row in np.flatnonzero(query.pixels[:, 0]).tolist()
            for whole in (query.whole_box[row],)
        ]


def _object(
    scene: Scene, number: int, copies: NDArray[np.int64], extents: list[Floats]
) -> ParkedObject:
    """Return an object: the box of all its copies along the first of them."""
    fixtures = scene.fixtures
    first = fixtures.pose[copies[0]].astype(np.float64)
    turned = first[:, :3] / exact.length(first[:, 0])
    ends = []
    for copy, extent in zip(copies.tolist(), extents, strict=True):
        pose = fixtures.pose[copy].astype(np.float64)
        corners = np.array([(x, y, z) for x in extent[:, 0] for y in extent[:, 1]
                            for z in extent[:, 2]])  # fmt: skip
        ends.append(exact.product(exact.product(corners, pose[:, :3].T) + pose[:, 3], turned))
    low, high = np.concatenate(ends).min(axis=0), np.concatenate(ends).max(axis=0)
    middle = exact.product(np.array([[*(low + high)[:2] / 2, low[2]]]), turned.T)[0]
    x, y, z = middle.tolist()
    length, width, height = (high - low).tolist()
    return ParkedObject(
        object_id=number,
        type=fixtures.names[int(fixtures.prototype[copies[0]])],
        object_class=ObjectClass(int(scene.object_class[number])),
        foot=(x, y, z),
        size=(length, width, height),
        yaw=float(exact.atan2(first[1, 0], first[0, 0])),
    )


@compiled
def _measure(copies: _Copies, query: _Query) -> None:
    """Write what the picture shows of each object that is visible."""
    _count(copies, query)
    for thing in range(len(query.pixels)):
        if query.pixels[thing, 0] > 0:
            for copy in range(copies.first_copy[thing], copies.first_copy[thing + 1]):
                kind = copies.prototype[copy]
                _place(copies, query, copy, query.whole_box[thing])
                for k in range(copies.first_triangle[kind], copies.first_triangle[kind + 1]):
                    a, b, c = copies.triangle[k, 0], copies.triangle[k, 1], copies.triangle[k, 2]
                    _fill(query.place[a], query.place[b], query.place[c], query.near)
            _uncover(copies, query, thing)


@kernel(inline=True)
def _row_of(copies: _Copies, number: int) -> int:
    return i8(copies.row[number]) if 0 <= number < len(copies.row) else i8(-1)


@kernel(inline=True)
def _widen(box: NDArray[np.int32], column: int, line: int) -> None:
    """Widen a box by a pixel."""
    box[0], box[1] = min(box[0], column), min(box[1], line)
    box[2], box[3] = max(box[2], column + 1), max(box[3], line + 1)


@kernel
def _count(copies: _Copies, query: _Query) -> None:
    """Count the visible pixels of each object, and enclose them."""
    height, width = query.shown.shape
    for line in range(height):
        for column in range(width):
            thing = _row_of(copies, query.shown[line, column])
            if thing >= 0:
                query.pixels[thing, 0] += 1
                _widen(query.visible_box[thing], column, line)
                _widen(query.box[thing], column, line)


@kernel
def _place(copies: _Copies, query: _Query, copy: int, box: Floats) -> None:
    """Write where the vertices of a copy are in the picture, and enclose them."""
    eye, axes, place, kind = query.eye, query.axes, query.place, copies.prototype[copy]
    focal, middle, centre = query.camera[0], query.camera[1], query.camera[2]
    begin, end, pose = copies.first_vertex[kind], copies.first_vertex[kind + 1], copies.pose[copy]
    for k in range(end - begin):
        vertex = copies.vertex[begin + k]
        u, v, w = vertex[0], vertex[1], vertex[2]
        x = pose[0, 0] * u + pose[0, 1] * v + pose[0, 2] * w + pose[0, 3] - eye[0]
        y = pose[1, 0] * u + pose[1, 1] * v + pose[1, 2] * w + pose[1, 3] - eye[1]
        z = pose[2, 0] * u + pose[2, 1] * v + pose[2, 2] * w + pose[2, 3] - eye[2]
        ahead = axes[0, 0] * x + axes[1, 0] * y + axes[2, 0] * z
        place[k, 2] = 0.0
        if ahead < NEAR:
            continue
        aside = axes[0, 1] * x + axes[1, 1] * y + axes[2, 1] * z
        above = axes[0, 2] * x + axes[1, 2] * y + axes[2, 2] * z
        if query.bent == 1:
            over, down = distorted(query.lens, -aside, -above, ahead)
            column, line = middle + focal * over, centre + focal * down
        else:
            scale = focal / ahead
            column, line = middle - scale * aside, centre - scale * above
        if not (abs(column) < _FAR and abs(line) < _FAR):  # a lens may bend it to nowhere
            continue
        place[k, 0], place[k, 1], place[k, 2] = column, line, 1.0 / ahead
        box[0], box[1] = min(box[0], column), min(box[1], line)
        box[2], box[3] = max(box[2], column), max(box[3], line)


@kernel(inline=True)
def _within(low: float, high: float, size: int) -> tuple[int, int]:
    """Return the first pixel of a span, and the one after its last, inside the picture."""
    return i8(min(max(low, 0.0), 1.0 * size)), i8(max(min(high + 1.0, 1.0 * size), 0.0))


@kernel
def _fill(a: Floats, b: Floats, c: Floats, near: NDArray[np.float32]) -> None:
    """Write the inverse distances of a triangle where they are the largest.

    Its corners are rows of `_Query.place`; one with a corner behind the near plane is left out.
    """
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if area == 0.0 or min(a[2], b[2], c[2]) == 0.0:
        return
    share = 1.0 / area
    top, bottom = _within(min(a[1], b[1], c[1]), max(a[1], b[1], c[1]), near.shape[0])
    left, right = _within(min(a[0], b[0], c[0]), max(a[0], b[0], c[0]), near.shape[1])
    for line in range(top, bottom):
        for column in range(left, right):
            u, v = column + 0.5, line + 0.5
            first = ((b[0] - u) * (c[1] - v) - (b[1] - v) * (c[0] - u)) * share
            second = ((c[0] - u) * (a[1] - v) - (c[1] - v) * (a[0] - u)) * share
            third = 1.0 - first - second
            if first >= 0.0 and second >= 0.0 and third >= 0.0:
                here = first * a[2] + second * b[2] + third * c[2]
                near[line, column] = max(near[line, column], here)


@kernel
def _uncover(copies: _Copies, query: _Query, thing: int) -> None:
    """Count the hidden pixels of an object, and enclose them; clear `_Query.near`."""
    near, box = query.near, query.whole_box[thing]
    top, bottom = _within(box[1], box[3], near.shape[0])
    left, right = _within(box[0], box[2], near.shape[1])
    for line in range(top, bottom):
        for column in range(left, right):
            inverse, near[line, column] = near[line, column], 0.0
            # `1 / inverse` is the object's distance here, and what hides it is nearer.
            hides = inverse * (query.depth[line, column] + _APART) < 1.0 and inverse > 0.0
            if hides and _row_of(copies, query.shown[line, column]) != thing:
                query.pixels[thing, 1] += 1
                _widen(query.box[thing], column, line)
