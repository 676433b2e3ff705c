"""Street trees, wide and bushy so that their crowns hide cars; rows of them; evergreen cones."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import tube
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.materials import material
from eyas.lanes import exact
from eyas.maps.plants.foliage import Crown, leaf_cards, shell

VARIANTS = 4  # Number of shapes; variants k and k + 4 differ only by chance

Array = NDArray[np.float64]
Tints = tuple[tuple[float, float, float], ...]

# Factors on the leaf texture from the dark underside to the sunlit top; the original's trees
# are dark olive green.
_GREENS: tuple[Tints, ...] = (
    ((0.42, 0.46, 0.36), (0.58, 0.62, 0.48), (0.76, 0.8, 0.6), (0.95, 0.98, 0.74)),
    ((0.42, 0.48, 0.40), (0.56, 0.64, 0.52), (0.72, 0.82, 0.64), (0.86, 0.98, 0.76)),
    ((0.46, 0.46, 0.32), (0.64, 0.63, 0.44), (0.84, 0.82, 0.56), (1.0, 0.98, 0.68)),
    ((0.40, 0.45, 0.38), (0.54, 0.60, 0.50), (0.70, 0.77, 0.60), (0.88, 0.94, 0.72)),
)
_CORE = (0.48, 0.51, 0.38)
_FAR = 0.92
"""Factor that makes a closed surface of leaves as dark as the cards with clefts it replaces."""
# Crown width as a share of the height: the original's are 15.5 to 31 m wide, 14.8 to 27 m tall.
_WIDTHS = (1.1, 1.02, 1.16, 1.06)
_PALE_BARK = (1.0, 0.98, 0.95)


def street_tree_levels(rng: np.random.Generator, variant: int) -> tuple[Mesh, ...]:
    """Return a tree of height 1 that stands on the origin, the finest level of detail first.

    The levels have about 2,700, 530, 130 and 30 triangles; the last is for crowns of a few pixels.
    Multiply by 15 to 27 for metres.
    """
    kind = variant % VARIANTS
    crown = _crown(_WIDTHS[kind] / 2, rng)
    greens = _GREENS[kind]
    red, green, blue = greens[2]
    far = (_FAR * red, _FAR * green, _FAR * blue)
    fine = concatenate(
        [
            _wood(crown, rng, limbs=7, sides=8),
            shell(crown, 2, 0.86, _CORE),
            leaf_cards(crown, 540, (0.12, 0.19), greens, rng, bent=True),
        ]
    )
    middle = concatenate(
        [
            _wood(crown, rng, limbs=2, sides=5),
            shell(crown, 1, 0.88, _CORE),
            leaf_cards(crown, 195, (0.19, 0.28), greens, rng, bent=False),
        ]
    )
    trunk = _wood(crown, rng, limbs=0, sides=3)
    cards = leaf_cards(crown, 20, (0.28, 0.38), greens, rng, bent=False)
    coarse = concatenate([trunk, shell(crown, 1, 1.06, far, 1.0), cards])
    tiny = concatenate([trunk, shell(crown, 0, 1.25, far, 1.0)])
    return fine, middle, coarse, tiny


def _crown(half_width: float, rng: np.random.Generator) -> Crown:
    """Return balls in a flat ring and above it, from a quarter of the height to the top."""
    ring = 8
    turn = rng.uniform(0, 2 * np.pi)
    angle = turn + (np.arange(ring) + rng.uniform(-0.25, 0.25, ring)) * (2 * np.pi / ring)
    low = np.column_stack([exact.cos(angle), exact.sin(angle), np.zeros(ring)])
    low *= (0.62 * half_width) * rng.uniform(0.9, 1.08, (ring, 1))
    low[:, 2] = rng.uniform(0.44, 0.58, ring)
    upper = turn + 0.5 + (np.arange(5) + rng.uniform(-0.3, 0.3, 5)) * (2 * np.pi / 5)
    high = np.column_stack([exact.cos(upper), exact.sin(upper), np.zeros(5)])
    high *= (0.33 * half_width) * rng.uniform(0.8, 1.15, (5, 1))
    high[:, 2] = rng.uniform(0.68, 0.76, 5)
    centres = np.concatenate([low, high, [[0, 0, 0.55], [0.02, -0.03, 0.8]]])
    radii = np.concatenate(
        [rng.uniform(0.19, 0.235, ring), rng.uniform(0.17, 0.21, 5), [0.28, 0.17]]
    )
    # Bring the outline to exactly the wanted width and height; cards stick out a little more.
    reach = np.linalg.norm(centres[:, :2], axis=1) + radii
    centres[:, :2] *= (half_width - 0.05 - radii[:, None]) / (reach.max() - radii[:, None])
    centres[:, 2] += 0.96 - (centres[:, 2] + radii).max()
    return Crown(centres, radii, np.array([0.0, 0.0, 0.52]))


def _wood(crown: Crown, rng: np.random.Generator, *, limbs: int, sides: int) -> Mesh:
    """Return the trunk, and limbs that lead to the lower balls of a crown."""
    bark = material("bark", _PALE_BARK)
    lean = rng.uniform(-0.02, 0.02, 2)
    trunk = np.array(
        [[0, 0, -0.02], [0, 0, 0.015], [*(lean / 2), 0.14], [*lean, 0.3], [*lean, 0.55]]
    )
    thick = [0.036, 0.026, 0.021, 0.019, 0.008]
    if limbs == 0:
        trunk, thick = trunk[::2], thick[::2]
    pieces = [tube(trunk, thick, sides, bark, 0.1)]
    for k in range(limbs):
        start = np.array([*lean, 0.2 + 0.02 * k])
        end = crown.centres[k % len(crown.centres)]
        elbow = 0.5 * (start + end) + [0, 0, -0.03]
        path = np.stack([start, elbow, end])
        pieces.append(tube(path, [0.012, 0.009, 0.004], max(sides - 3, 3), bark, 0.1))
    return concatenate(pieces)


def place_along(
    line: shapely.LineString,  # Line of the row [m]
    spacing: tuple[float, float],  # Least and largest distance from one tree to the next [m]
    rng: np.random.Generator,
    keep_free: shapely.Geometry,  # Area without trunks; trees there are left out
) -> Array:
    """Return the positions of the trees of a row, shape (K, 2) [m]."""
    gaps = rng.uniform(*spacing, int(line.length / spacing[0]) + 2)
    along = np.cumsum(gaps) - gaps[0] * rng.uniform(0.3, 0.9)
    along = along[along < line.length - 0.3 * spacing[0]]
    points = shapely.line_interpolate_point(line, along)
    free = ~shapely.intersects(keep_free, points)
    return np.asarray(shapely.get_coordinates(points[free]), np.float64).reshape(-1, 2)


CONES = 3  # Number of shapes


_CONE_GREENS = (
    ((0.36, 0.47, 0.40), (0.50, 0.64, 0.51), (0.66, 0.83, 0.62), (0.82, 0.98, 0.70)),
    ((0.38, 0.51, 0.35), (0.54, 0.69, 0.46), (0.72, 0.89, 0.55), (0.88, 1.0, 0.64)),
    ((0.33, 0.45, 0.42), (0.45, 0.61, 0.53), (0.58, 0.76, 0.64), (0.76, 0.93, 0.74)),
)
_CONE_CORE = (0.34, 0.42, 0.34)
_HALF_WIDTH = (0.46, 0.40, 0.43)
"""Half the width of the crown, as a share of the height: in the original, 0.5."""
_LOW = 0.10  # Height of the lowest branches
_RINGS = 6


def cone_tree_levels(rng: np.random.Generator, variant: int) -> tuple[Mesh, ...]:
    """Return a tree of height 1 that stands on the origin, the finest level of detail first.

    The levels have about 1,700, 480 and 40 triangles.
    """
    kind = variant % CONES
    half, greens = _HALF_WIDTH[kind], _CONE_GREENS[kind]
    crown = _cone_crown(half, rng)
    fine = concatenate(
        [
            _cone_trunk(7),
            _cone(half, 12, 0.80, _CONE_CORE),
            leaf_cards(crown, 400, (0.11, 0.19), greens, rng, bent=True),
        ]
    )
    middle = concatenate(
        [
            _cone_trunk(5),
            _cone(half, 9, 0.84, _CONE_CORE),
            leaf_cards(crown, 190, (0.17, 0.27), greens, rng, bent=False),
        ]
    )
    coarse = concatenate([_cone_trunk(3), _cone(half, 7, 1.0, greens[2])])
    return fine, middle, coarse


def _cone_crown(half: float, rng: np.random.Generator) -> Crown:
    """Return balls in rings that become smaller towards the top."""
    centres, radii = [np.array([[0.0, 0.0, 0.94]])], [np.array([0.045])]
    for ring in range(_RINGS):
        share = ring / (_RINGS - 1)
        reach, height = half * (1.0 - share), _LOW + 0.10 + 0.72 * share
        size = 0.055 + 0.42 * reach
        count = max(1, round(2 * np.pi * max(reach - size, 0.0) / size))
        angle = rng.uniform(0, 2 * np.pi) + np.arange(count) * 2 * np.pi / count
        out = max(reach - size, 0.0) * rng.uniform(0.9, 1.06, count)
        z = height + rng.uniform(-0.025, 0.025, count)
        centres.append(np.column_stack([out * exact.cos(angle), out * exact.sin(angle), z]))
        radii.append(np.full(count, size))
    return Crown(np.concatenate(centres), np.concatenate(radii), np.array([0.0, 0.0, 0.4]))


def _cone(half: float, sides: int, size: float, tint: tuple[float, float, float]) -> Mesh:
    """Return the dark inside of a crown."""
    stuff = Material("foliage", tint, Surface.CROWN)
    path = np.array([[0, 0, _LOW], [0, 0, _LOW + 0.08], [0, 0, 0.5], [0, 0, 0.5 + 0.48 * size]])
    wide = [0.45 * half * size, half * size, 0.55 * half * size, 0.005]
    return tube(path, wide, sides, stuff, 0.5)


def _cone_trunk(sides: int) -> Mesh:
    path = np.array([[0, 0, -0.02], [0, 0, 0.04], [0, 0, 0.3]])
    return tube(path, [0.032, 0.024, 0.02], sides, material("bark"), 0.1)
