"""Leaves: crowns covered with cards that show clusters of leaves, and how they turn in autumn."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.solids import sphere
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.scene_builder import Levels
from eyas.lanes import exact

Array = NDArray[np.float64]

_ATLAS = 2  # Clusters in each direction of the texture `leaves`


@dataclass(frozen=True, slots=True)
class Crown:
    """The space that leaves fill: a union of B balls."""

    centres: Array  # Shape (B, 3)
    radii: Array  # Shape (B,)
    middle: Array  # Centre from which shading normals point outwards, shape (3,)

    def depth(self, points: Array) -> Array:
        """Return the depth of points within the crown, negative outside, shape (P,)."""
        distance = exact.lengths(points[:, None] - self.centres)
        return np.asarray((self.radii - distance).max(axis=1), np.float64)

    def surface(self, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
        """Return points spread over the outside of the crown, and unit vectors that face outwards.

        Shapes (count, 3).
        """
        weight = np.square(self.radii) / np.square(self.radii).sum()
        kept: list[Array] = []
        facing: list[Array] = []
        have = 0
        while have < count:
            ball = rng.choice(len(self.radii), size=4 * count, p=weight)
            way = exact.normal(rng, size=(4 * count, 3))
            way /= np.linalg.norm(way, axis=1, keepdims=True)
            points = self.centres[ball] + way * self.radii[ball, None]
            outside = self.depth(points) < 0.015
            kept.append(points[outside])
            facing.append(way[outside])
            have += int(outside.sum())
        return np.concatenate(kept)[:count], np.concatenate(facing)[:count]

    def soft_normals(self, points: Array, facing: Array) -> Array:
        """Return shading normals: half the ball's, half the whole crown's, for soft edges."""
        away = points - self.middle
        away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-9)
        blend = 0.55 * away + 0.45 * facing + np.array([0.0, 0.0, 0.12])
        return np.asarray(blend / np.linalg.norm(blend, axis=1, keepdims=True), np.float64)


def leaf_cards(
    crown: Crown,  # Crown to cover
    count: int,
    size: tuple[float, float],  # Least and largest side of a card
    # Factors on the leaves' colour, from the darkest (below, in clefts) to the lightest
    tints: tuple[tuple[float, float, float], ...],
    rng: np.random.Generator,
    *,
    bent: bool,  # Fold each card along its middle (4 triangles); otherwise flat (2 triangles)
) -> Mesh:
    """Return cards with clusters of leaves on the outside of a crown."""
    points, facing = crown.surface(count, rng)
    normals = crown.soft_normals(points, facing)
    side = rng.uniform(*size, count)
    # Large cards would make the crown larger than it is.
    middle = points - 0.22 * side[:, None] * facing
    columns = 3 if bent else 2
    positions = middle[:, None] + side[:, None, None] * _tilted_cards(facing, columns, rng)
    cell = np.stack(np.meshgrid(np.linspace(0, 1, columns), [0, 1]), axis=2).reshape(-1, 2)
    uvs = (rng.integers(0, _ATLAS, (count, 1, 2)) + cell) / _ATLAS
    quad = np.array([[0, 1, columns + 1], [0, columns + 1, columns]])
    pattern = np.concatenate([quad + k for k in range(columns - 1)])
    triangles = (np.arange(count) * 2 * columns)[:, None, None] + pattern
    brightness = _brightness(crown, points, facing) + exact.normal(rng, 0, 0.1, count)
    level = np.clip(np.floor(brightness * len(tints)), 0, len(tints) - 1).astype(np.int32)
    return Mesh(
        positions=positions.reshape(-1, 3).astype(np.float32),
        normals=np.repeat(normals, 2 * columns, axis=0).astype(np.float32),
        uvs=uvs.reshape(-1, 2).astype(np.float32),
        triangles=triangles.reshape(-1, 3).astype(np.int32),
        materials=np.repeat(level, len(pattern)),
        palette=tuple(Material("leaves", tint, Surface.FOLIAGE) for tint in tints),
    )


def _tilted_cards(facing: Array, columns: int, rng: np.random.Generator) -> Array:
    """Return the corners of cards of side 1 about the origin, shape (count, 2 columns, 3).

    They face roughly outwards, each tilted and turned at random; three columns make a fold.
    """
    count = len(facing)
    tilted = facing + 0.55 * exact.normal(rng, size=(count, 3))
    across = exact.cross(tilted, exact.normal(rng, size=(count, 3)))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    up = exact.cross(tilted, across)
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-0.5, 0.5, columns), [-0.5, 0.5]))
    fold = -0.88 * np.square(x) if columns > 2 else 0 * x
    corners = (
        across[:, None] * x[:, None] + up[:, None] * y[:, None] + tilted[:, None] * fold[:, None]
    )
    return np.asarray(corners, np.float64)


def _brightness(crown: Crown, points: Array, facing: Array) -> Array:
    """Return how open to the sky points on a crown are, about 0 to 1."""
    low, high = crown.centres[:, 2].min(), (crown.centres[:, 2] + crown.radii).max()
    height = (points[:, 2] - low) / (high - low)
    # Clefts between balls lie near the middle and get little light.
    out = crown.depth(points + 0.25 * crown.radii.mean() * facing)
    return np.asarray(
        0.15 + 0.55 * height + 0.3 * facing[:, 2] - 1.5 * np.maximum(out, 0), np.float64
    )


def shell(
    crown: Crown,
    subdivisions: int,  # Subdivisions of its icosphere
    shrink: float,  # Size of the inside, as a share of the crown
    tint: tuple[float, float, float],  # Factor on the leaves' colour
    tiles: float = 2.0,  # Repeats of the texture in the radius
) -> Mesh:
    """Return the dark inside of a crown: a closed surface, seen through gaps between the cards."""
    mesh = sphere(subdivisions, Material("foliage", tint, Surface.CROWN))
    way = np.asarray(mesh.positions, np.float64)
    reach = np.zeros(len(way))
    for step in np.linspace(0.05, 1.0, 60):
        inside = crown.depth(crown.middle + step * way) > 0
        reach[inside] = step
    positions = crown.middle + shrink * reach[:, None] * way
    mesh.positions = positions.astype(np.float32)
    mesh.normals = crown.soft_normals(positions, way).astype(np.float32)
    mesh.uvs = (tiles * mesh.uvs).astype(np.float32)
    return mesh


Tint = tuple[float, float, float]

COLOURS: tuple[tuple[Tint, float], ...] = (
    ((0.93, 0.70, 0.20), 0.85),
    ((0.84, 0.44, 0.15), 0.75),
    ((0.66, 0.66, 0.27), 1.0),
    ((0.60, 0.42, 0.24), 0.22),
    ((0.72, 0.26, 0.15), 0.8),
    ((0.96, 0.78, 0.32), 0.5),
    ((0.50, 0.55, 0.27), 1.0),
    ((0.74, 0.52, 0.22), 0.6),
)
"""Colour of sunlit leaves, sRGB, and the share of them that is still on the tree: yellow as limes,
orange as maples, still green, nearly bare, red, ... Trees take them in turn."""

_PALE = {"leaves": "pale_leaves", "foliage": "pale_foliage"}

_TWIGS: Tint = (0.46, 0.40, 0.34)  # Colour of a crown without leaves, seen from afar


def in_autumn(
    levels: Levels,  # The plant in summer, the finest level of detail first
    which: int,  # Chooses one of `COLOURS`
) -> Levels:
    """Return a plant in autumn, drawn without random numbers: what stands beside it stays."""
    colour, share = COLOURS[which % len(COLOURS)]
    return tuple(_turned(mesh, colour, share) for mesh in levels)


def _turned(mesh: Mesh, colour: Tint, share: float) -> Mesh:
    cards = np.array([one.surface == Surface.FOLIAGE for one in mesh.palette])[mesh.materials]
    brightest = max(
        (_material_brightness(one) for one in mesh.palette if one.texture in _PALE), default=1.0
    )
    palette = tuple(_coloured(one, colour, share, brightest) for one in mesh.palette)
    kept = ~cards
    kept[cards] = _left(mesh.triangles[cards], share)
    inner = np.array([one.surface == Surface.CROWN for one in mesh.palette])[mesh.materials]
    if share < 0.4 and cards.sum() > 100:  # else a crown seen from afar would be gone
        kept &= ~inner
    return replace(
        mesh, triangles=mesh.triangles[kept], materials=mesh.materials[kept], palette=palette
    )


def _left(triangles: NDArray[np.int32], share: float) -> NDArray[np.bool_]:
    """Return which triangles of leaves are on cards that are left; cards share no vertex."""
    first = triangles.min(axis=1)
    card = np.cumsum(np.diff(first, prepend=first[:1]) > 2)
    # Multiples of the golden ratio: evenly spread, and the same in all places.
    return np.asarray((card * 0.6180339887498949) % 1.0 < share, np.bool_)


def _material_brightness(one: Material) -> float:
    return sum(one.tint) / 3.0


def _coloured(one: Material, colour: Tint, share: float, brightest: float) -> Material:
    if one.texture not in _PALE:
        return one
    light = _material_brightness(one) / brightest
    if one.surface == Surface.CROWN:  # through a thin crown, twigs are seen
        red, green, blue = (
            part + (1.0 - share) * (twig - part) for part, twig in zip(colour, _TWIGS, strict=True)
        )
        colour = red, green, blue
    return replace(
        one,
        texture=_PALE[one.texture],
        tint=(light * colour[0], light * colour[1], light * colour[2]),
    )
