"""Plants that nobody tends, as fixtures: tufts of grass, reeds, dry bushes. Lengths in metres."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.scene_builder import Levels
from eyas.lanes import exact
from eyas.maps.plants.foliage import Crown, leaf_cards

BED = 3.4  # Length of a piece of a bed of reeds, along x [m]

Array = NDArray[np.float64]
Tint = tuple[float, float, float]

_STRAW: tuple[Tint, ...] = ((0.66, 0.57, 0.36), (0.78, 0.69, 0.45), (0.86, 0.79, 0.57))
_GRASS: tuple[Tint, ...] = ((0.32, 0.42, 0.20), (0.42, 0.52, 0.26), (0.56, 0.60, 0.34))
_REEDS: tuple[Tint, ...] = ((0.30, 0.37, 0.17), (0.42, 0.46, 0.23), (0.60, 0.55, 0.35))
_DRY: tuple[Tint, ...] = ((0.42, 0.40, 0.26), (0.55, 0.52, 0.34), (0.68, 0.63, 0.43))


def _blades(
    count: int,
    spread: float,
    long: float,
    heights: tuple[float, float],
    width: float,
    tints: Sequence[Tint],
    rng: np.random.Generator,
) -> Mesh:
    """Return blades, a triangle each, that lean outwards and are seen from above.

    They are no `Surface.FOLIAGE`, whose holes and shadows cost more than such small plants show.
    """
    away, angle = np.sqrt(rng.uniform(0.0, 1.0, count)), rng.uniform(0.0, 2 * np.pi, count)
    out = np.column_stack([exact.cos(angle), exact.sin(angle), np.zeros(count)])
    foot = spread * away[:, None] * out
    foot[:, 0] += rng.uniform(-0.5, 0.5, count) * long
    tall = rng.uniform(*heights, count)
    lean = tall * (0.12 + 0.5 * away) * rng.uniform(0.4, 1.2, count)
    turn = rng.uniform(0.0, np.pi, count)
    across = np.column_stack([exact.cos(turn), exact.sin(turn), np.zeros(count)])
    tip = foot + lean[:, None] * out
    tip[:, 2] = tall
    half = 0.5 * width * across
    corners = np.stack([foot - half, foot + half, tip], axis=1)
    below = np.cross(2.0 * half, tip - foot)[:, 2] < 0.0
    corners[below] = corners[below][:, ::-1]
    normal = 0.7 * out + np.array([0.0, 0.0, 0.7])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return Mesh(
        positions=corners.reshape(-1, 3).astype(np.float32),
        normals=np.repeat(normal, 3, axis=0).astype(np.float32),
        uvs=np.tile([[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]], (count, 1)).astype(np.float32),
        triangles=np.arange(3 * count, dtype=np.int32).reshape(-1, 3),
        materials=rng.integers(0, len(tints), count).astype(np.int32),
        palette=tuple(Material("plain", tint, Surface.CROWN) for tint in tints),
    )


def _tufts(tints: Sequence[Tint], rng: np.random.Generator) -> Levels:
    """Return a few tufts of grass that stand together."""
    spots = rng.uniform(-1.0, 1.0, (4, 2))
    sizes = rng.uniform(0.7, 1.2, 4)

    def each(count: int, spread: float, heights: tuple[float, float], width: float) -> Mesh:
        made = []
        for spot, size in zip(spots, sizes, strict=True):
            tuft = _blades(count, size * spread, 0.0, heights, width, tints, rng)
            tuft.positions[:, :2] += spot.astype(np.float32)
            made.append(tuft)
        return concatenate(made)

    return (each(34, 0.34, (0.16, 0.50), 0.045), each(11, 0.31, (0.18, 0.46), 0.14), Mesh.none())


def _reeds(rng: np.random.Generator) -> Levels:
    """Return a piece of a bed of reeds."""
    return (
        _blades(170, 0.7, BED, (0.6, 1.45), 0.05, _REEDS, rng),
        _blades(60, 0.65, BED, (0.7, 1.35), 0.13, _REEDS, rng),
        Mesh.none(),
    )


def _bush(rng: np.random.Generator) -> Levels:
    """Return a low bush of the desert, through which light falls."""
    angle = np.arange(4) * np.pi / 2 + rng.uniform(-0.5, 0.5, 4)
    reach = rng.uniform(0.22, 0.5, 4)
    low = [reach * exact.cos(angle), reach * exact.sin(angle), rng.uniform(0.18, 0.36, 4)]
    centres = np.concatenate([np.stack(low, 1), [[0.0, 0.0, 0.42]]])
    radii = np.append(rng.uniform(0.2, 0.32, 4), 0.3)
    crown = Crown(centres, radii, np.array([0.0, 0.0, 0.1]))
    return (
        _pale(leaf_cards(crown, 60, (0.22, 0.38), _DRY, rng, bent=False)),
        _pale(leaf_cards(crown, 22, (0.32, 0.5), _DRY, rng, bent=False)),
        Mesh.none(),
    )


def _pale(mesh: Mesh) -> Mesh:
    """Return leaves in the colours of their tints alone."""
    mesh.palette = tuple(replace(one, texture="pale_leaves") for one in mesh.palette)
    return mesh


WILD: dict[str, Callable[[np.random.Generator], Levels]] = {
    "dry tuft": lambda rng: _tufts(_STRAW, rng),
    "green tuft": lambda rng: _tufts(_GRASS, rng),
    "reeds": _reeds,
    "dry bush": _bush,
}
"""Makers of plants too low to hide anything; from afar there is nothing of them."""
