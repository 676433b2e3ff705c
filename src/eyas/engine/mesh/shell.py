"""Meshes of panels with smooth shading across gentle edges, for the bodies of vehicles."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.mesh.panels import box_panels, cells, closed, fan, halves, mirrored
from eyas.engine.state.mesh import Material, Mesh
from eyas.lanes import exact

_CREASE = 0.75  # Panels that meet at a larger angle keep a hard edge [rad]


class Shell:
    """A mesh under construction. Corners are counter-clockwise as seen from outside."""

    def __init__(self) -> None:
        self._corners: list[NDArray[np.float64]] = []
        self._uvs: list[NDArray[np.float64]] = []
        self._materials: list[Material] = []
        self.crease = _CREASE
        """Angle from which on an edge is hard [rad]; round bodies of few sides need a large one."""

    def quads(
        self,
        corners: ArrayLike,
        material: Material,
        *,
        uvs: ArrayLike | None = None,
        both_sides: bool = False,
    ) -> None:
        """Add quadrilaterals, shape (Q, 4, 3) or (4, 3).

        Args:
            corners: In the model's frame [m].
            material: Material of all of them.
            uvs: Texture coordinates [tiles], shape (Q, 4, 2) or (4, 2); None: 0.
            both_sides: Also add them mirrored left to right, with the same texture coordinates.
        """
        triangles = halves(np.asarray(corners, np.float64).reshape(-1, 4, 3))
        if uvs is not None:
            uvs = halves(np.asarray(uvs, np.float64).reshape(-1, 4, 2))
        self.triangles(triangles, material, uvs=uvs, both_sides=both_sides)

    def triangles(
        self,
        corners: ArrayLike,
        material: Material,
        *,
        uvs: ArrayLike | None = None,
        both_sides: bool = False,
    ) -> None:
        """Add triangles, shape (T, 3, 3) [m], see `quads`; those without area are skipped."""
        points = np.array(corners, np.float64).reshape(-1, 3, 3)
        flat = np.zeros((len(points), 3, 2)) if uvs is None else np.array(uvs, np.float64)
        flat = flat.reshape(-1, 3, 2)
        self._corners.append(points)
        self._uvs.append(flat)
        self._materials.append(material)
        if both_sides:
            self.triangles(mirrored(points), material, uvs=flat[:, ::-1])

    def box(
        self,
        low: Sequence[float],
        high: Sequence[float],
        material: Material,
        *,
        taper: float = 0.0,
        both_sides: bool = False,
    ) -> None:
        """Add a box between two corners; its top is inset by `taper` on all four sides [m]."""
        self.quads(box_panels(low, high, taper), material, both_sides=both_sides)

    def prism(
        self,
        profile: ArrayLike,
        y: tuple[float, float],
        material: Material,
        *,
        both_sides: bool = False,
    ) -> None:
        """Add a prism with a convex side view (x, z), counter-clockwise as seen from the right.

        Args:
            profile: Corners [m], shape (K, 2).
            y: Its right and left ends [m].
            material: Material of all faces.
            both_sides: Also add it mirrored left to right.
        """
        outline = np.asarray(profile, np.float64)
        right = np.insert(outline, 1, y[0], axis=1)
        left = np.insert(outline, 1, y[1], axis=1)
        self.rings(np.stack([left, right]), material, both_sides=both_sides)

    def rings(
        self, rings: ArrayLike, material: Material, *, both_sides: bool = False, caps: bool = True
    ) -> None:
        """Add the surface through a sequence of closed outlines, and close both ends.

        Args:
            rings: Outlines with K corners each, shape (R, K, 3); counter-clockwise as seen from
                beyond the last one.
            material: Material of all faces.
            both_sides: Also add it mirrored left to right.
            caps: Whether the ends are closed; their outlines must be convex.
        """
        r = np.asarray(rings, np.float64)
        self.quads(cells(closed(r)), material, both_sides=both_sides)
        if caps:
            self.triangles(fan(r[0, ::-1]), material, both_sides=both_sides)
            self.triangles(fan(r[-1]), material, both_sides=both_sides)

    def tube(
        self,
        path: ArrayLike,
        radii: Sequence[float],
        material: Material,
        *,
        sides: int = 6,
        both_sides: bool = False,
    ) -> None:
        """Add a round rod along points, shape (R, 3), with a radius at each point [m]."""
        points = np.asarray(path, np.float64)
        along = np.gradient(points, axis=0)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        helper = np.where(np.abs(along[:, 1:2]) < 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
        u = exact.cross(helper, along)
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        v = exact.cross(along, u)
        angle = np.arange(sides) * (2 * np.pi / sides)
        circle = exact.cos(angle)[:, None] * u[:, None] + exact.sin(angle)[:, None] * v[:, None]
        size = np.asarray(radii, np.float64)[:, None, None]
        self.rings(points[:, None] + size * circle, material, both_sides=both_sides)

    def ball(
        self,
        centre: Sequence[float],
        radii: Sequence[float],
        material: Material,
        *,
        rows: int = 5,
        sides: int = 8,
        both_sides: bool = False,
    ) -> None:
        """Add an ellipsoid with axes along x, y and z [m]."""
        upwards = np.linspace(-np.pi / 2, np.pi / 2, rows + 1)[:, None]
        angle = np.arange(sides) * (2 * np.pi / sides)
        unit = [exact.cos(upwards) * exact.cos(angle), exact.cos(upwards) * exact.sin(angle)]
        unit.append(np.broadcast_to(exact.sin(upwards), unit[0].shape))
        rings = np.stack(unit, axis=-1) * np.asarray(radii) + np.asarray(centre)
        self.rings(rings, material, both_sides=both_sides, caps=False)

    def corners(self) -> NDArray[np.float64]:
        """Return the corners of all triangles [m], shape (3 T, 3)."""
        return np.concatenate(self._corners)[self._solid()].reshape(-1, 3)

    def _solid(self) -> NDArray[np.bool_]:
        """Return which triangles have an area: of all at once, for single panels are thousands."""
        solid: NDArray[np.bool_] = (
            np.linalg.norm(_cross(np.concatenate(self._corners)), axis=1) > 1e-7
        )
        return solid

    def mesh(self) -> Mesh:
        """Return all panels as one mesh."""
        solid = self._solid()
        corners = np.concatenate(self._corners)[solid]
        panel = np.repeat(np.arange(len(self._corners)), [len(each) for each in self._corners])
        panel = panel[solid]
        shown = dict.fromkeys(self._materials[i] for i in np.unique(panel))
        palette = {m: i for i, m in enumerate(shown)}
        material = np.array([palette.get(m, -1) for m in self._materials], np.int32)[panel]
        vertices = np.concatenate(
            [
                corners.reshape(-1, 3),
                _normals(corners, material, self.crease).reshape(-1, 3),
                np.concatenate(self._uvs)[solid].reshape(-1, 2),
            ],
            axis=1,
        )
        first, index = _distinct(np.round(vertices, 5))
        kept = vertices[first]
        return Mesh(
            positions=np.ascontiguousarray(kept[:, :3], np.float32),
            normals=np.ascontiguousarray(kept[:, 3:6], np.float32),
            uvs=np.ascontiguousarray(kept[:, 6:], np.float32),
            triangles=np.ascontiguousarray(index.reshape(-1, 3), np.int32),
            materials=material,
            palette=tuple(palette),
        )


def _distinct(rows: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the first of the rows that are alike, in their order, and which of these each is.

    As `numpy.unique` does along an axis, in half the time.
    """
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    new = np.append(True, (ordered[1:] != ordered[:-1]).any(axis=1))
    index = np.empty(len(rows), np.intp)
    index[order] = np.cumsum(new) - 1
    return order[new], index


def _cross(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the normals of triangles, with lengths of twice their areas, shape (T, 3)."""
    crossed: NDArray[np.float64] = exact.cross(
        corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    )
    return crossed


def _angles(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inner angles of triangles at their corners [rad], shape (T, 3)."""
    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    length = np.linalg.norm(ahead, axis=2) * np.linalg.norm(behind, axis=2)
    cosine = exact.dot(ahead, behind) / length
    return np.asarray(exact.acos(np.clip(cosine, -1.0, 1.0)), np.float64)


def _normals(
    corners: NDArray[np.float64], material: NDArray[np.int32], crease: float
) -> NDArray[np.float64]:
    """Return unit normals of the corners, shape (T, 3, 3).

    A normal is the mean over the triangles of the same material that meet at the corner at less
    than the crease angle, weighted by their angles there, so that long and short panels count
    equally.
    """
    flat = _cross(corners)
    unit = np.repeat(flat / np.linalg.norm(flat, axis=1, keepdims=True), 3, axis=0)
    weighted = unit * _angles(corners).reshape(-1, 1)
    key = np.column_stack([np.round(corners.reshape(-1, 3), 4), np.repeat(material, 3)])
    _, group = _distinct(key)
    size = np.bincount(group)
    order = np.argsort(group, kind="stable")
    first = np.cumsum(size) - size
    rank = np.arange(len(order)) - np.repeat(first, size)
    member = np.full((len(size), size.max()), -1)
    member[np.repeat(np.arange(len(size)), size), rank] = order
    others = member[group]
    cosine = exact.dot(unit[:, None], unit[others])
    close = (others >= 0) & (cosine > exact.cos(crease))
    total = np.where(close[:, :, None], weighted[others], 0.0).sum(axis=1)
    total /= np.linalg.norm(total, axis=1, keepdims=True)
    smooth: NDArray[np.float64] = total.reshape(-1, 3, 3)
    return smooth
