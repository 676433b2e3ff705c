"""Meshes of simple solids. Angles in radians, lengths in metres, z up."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from eyas.engine.mesh.assembly import of_one_material
from eyas.engine.mesh.flat import quads
from eyas.engine.state.mesh import Material, Mesh
from eyas.lanes import exact


def box(size: Sequence[float], centre: Sequence[float], material: Material, tile: float) -> Mesh:
    """Return a box with six faces; textures repeat every `tile` metres."""
    half = np.asarray(size, np.float64) / 2
    corners, uvs = [], []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for sign in (1.0, -1.0):
            face = np.zeros((4, 3))
            face[:, axis] = sign * half[axis]
            face[:, u] = sign * half[u] * np.array([-1, 1, 1, -1])
            face[:, v] = half[v] * np.array([-1, -1, 1, 1])
            flat = face[:, (u, v)] if v == 2 or axis == 2 else face[:, (v, u)]
            corners.append(face + np.asarray(centre))
            uvs.append((flat - flat.min(0)) / tile)
    return quads(corners, uvs, material)


def cylinder(
    radius: tuple[float, float],  # Radius at the bottom and at the top [m]
    height: tuple[float, float],  # z of the bottom and of the top [m]
    sides: int,  # Number of sides
    material: Material,  # Material of all faces
    *,
    cap: bool = False,  # Whether to close the top and the bottom
    tile: float = 1.0,  # Length that one repeat of the texture covers [m]
) -> Mesh:
    """Return a truncated cone around z."""
    angle = np.arange(sides + 1) * (2 * np.pi / sides)
    ring = np.column_stack([exact.cos(angle), exact.sin(angle)])
    slope = (radius[0] - radius[1]) / max(height[1] - height[0], 1e-9)
    normal = np.column_stack([ring, np.full(sides + 1, slope)])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    positions = np.concatenate(
        [
            np.column_stack([ring * r, np.full(sides + 1, z)])
            for r, z in zip(radius, height, strict=True)
        ]
    )
    along = angle * max(radius) / tile
    uvs = np.concatenate(
        [np.column_stack([along, np.full(sides + 1, (z - height[0]) / tile)]) for z in height]
    )
    low = np.arange(sides)
    high = low + sides + 1
    triangles = np.concatenate(
        [np.column_stack([low, low + 1, high + 1]), np.column_stack([low, high + 1, high])]
    )
    normals = np.concatenate([normal, normal])
    if cap:
        for z_index, sign in ((0, -1.0), (1, 1.0)):
            first = len(positions)
            disc = ring[:-1] * radius[z_index]
            positions = np.concatenate(
                [positions, np.column_stack([disc, np.full(sides, height[z_index])])]
            )
            normals = np.concatenate([normals, np.tile([0.0, 0.0, sign], (sides, 1))])
            uvs = np.concatenate([uvs, disc / tile])
            fan = np.column_stack(
                [
                    np.full(sides - 2, first),
                    first + np.arange(1, sides - 1),
                    first + np.arange(2, sides),
                ]
            )
            triangles = np.concatenate([triangles, fan if sign > 0 else fan[:, ::-1]])
    return of_one_material(positions, normals, uvs, triangles, material)


def tube(
    path: ArrayLike, radii: Sequence[float], sides: int, material: Material, tile: float = 1.0
) -> Mesh:
    """Return a round tube of varying thickness along points, open at its ends.

    Args:
        path: Points of its axis [m], shape (P, 3).
        radii: Radius at each point [m], P numbers.
        sides: Number of sides.
        material: Material of all faces.
        tile: Length that one repeat of the texture covers [m].
    """
    points = np.asarray(path, np.float64)
    along = np.asarray(np.gradient(points, axis=0), np.float64)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    # Any perpendicular direction works if it turns little from point to point.
    across = exact.cross(along, np.eye(3)[int(np.argmin(np.abs(along).sum(0)))])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    other = exact.cross(along, across)
    angle = np.arange(sides + 1) * (2 * np.pi / sides)
    normals = (
        across[:, None] * exact.cos(angle)[:, None] + other[:, None] * exact.sin(angle)[:, None]
    )
    radius = np.asarray(radii, np.float64)[:, None, None]
    travelled = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    around = np.maximum(np.round(2 * np.pi * max(radii) / tile), 1) * angle / (2 * np.pi)
    uvs = np.stack(np.broadcast_arrays(around[None], travelled[:, None] / tile), axis=2)
    first = (np.arange(len(points) - 1)[:, None] * (sides + 1) + np.arange(sides)).reshape(-1, 1)
    cells = first + np.array([0, 1, sides + 2, 0, sides + 2, sides + 1])
    rings = points[:, None] + radius * normals
    return of_one_material(
        rings.reshape(-1, 3),
        normals.reshape(-1, 3),
        uvs.reshape(-1, 2),
        cells.reshape(-1, 3),
        material,
    )


def sphere(subdivisions: int, material: Material, tile: float = 1.0) -> Mesh:
    """Return a unit icosphere: 20 triangles, four times as many with each subdivision.

    If `tile` is 1, there are six tiles around the equator and two from pole to pole.
    """
    golden = (1 + math.sqrt(5)) / 2
    points = [
        (-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0),
        (0, -1, golden), (0, 1, golden), (0, -1, -golden), (0, 1, -golden),
        (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1),
    ]  # fmt: skip
    faces = np.array([
        (0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
        (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
        (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1),
    ])  # fmt: skip
    corners = np.array(points, np.float64)[faces]
    for _ in range(subdivisions):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        cells = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        corners = np.concatenate([np.stack(cell, axis=1) for cell in cells])
    corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    around = exact.atan2(corners[..., 1], corners[..., 0]) * (3.0 / np.pi)
    # Triangles across the seam continue beyond it instead of spanning the whole texture.
    around += 6.0 * ((around < 0.0) & (around.max(axis=1, keepdims=True) > around + 3.0))
    flat = np.stack([*np.moveaxis(corners, -1, 0), around, corners[..., 2]], -1).reshape(-1, 5)
    _, first, index = np.unique(np.round(flat, 9), axis=0, return_index=True, return_inverse=True)
    positions, uvs = flat[first, :3], flat[first, 3:] / tile
    return of_one_material(positions, positions, uvs, index.reshape(-1, 3), material)
