"""Tunnels under grown-over mounds: lumpy arches over the road that hide what drives below."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, of_one_material
from eyas.engine.mesh.panels import cells, halves
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import TEXTURES
from eyas.lanes import exact
from eyas.maps.build.values import Place, Positive, Unit

HALF_WIDTH = 19.0
"""Distance from the middle of the road to the foot of the mound [m]."""

_TOP = 9.6
"""Mean height of the mound [m]."""
_OPENING = (12.5, 7.4)
"""Half width and height of the opening [m]."""
_LUMPS = 0.75
"""Size of the lumps [m]."""
_SECTIONS, _SIDES = 17, 14
"""Number of cross-sections along the tunnel, and of facets around each."""
_STRIPS = (-HALF_WIDTH, -11.0, -8.6, -4.5, 4.5, 8.6, 11.0, HALF_WIDTH)
"""Borders of the solids of a tunnel, across the road [m]."""
_SUNK = 0.4
"""Depth of the feet below the ground [m]."""

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Tunnel:
    """A tunnel in plan view."""

    place: Place
    """Middle of the tunnel, on the middle of the road [m], shape (2,)."""
    along: Unit
    """Direction of the road, a unit vector, shape (2,)."""
    length: Positive
    """Length [m]."""

    @property
    def area(self) -> shapely.Polygon:
        """What it covers [m]."""
        half = self.length / 2
        corners = [(-half, -HALF_WIDTH), (half, -HALF_WIDTH), (half, HALF_WIDTH)]
        return shapely.Polygon(self.placed(np.array([*corners, (-half, HALF_WIDTH)])))

    @property
    def passage(self) -> shapely.Polygon:
        """The ground inside [m]."""
        half, side = self.length / 2 + 2.0, _OPENING[0] + 0.3
        corners = [(-half, -side), (half, -side), (half, side), (-half, side)]
        return shapely.Polygon(self.placed(np.array(corners)))

    def placed(self, points: Points) -> Points:
        """Return points given along the road and to its left [m], shape (..., 2), in the world."""
        across = np.array([-self.along[1], self.along[0]])
        return np.asarray(
            self.place + points[..., :1] * self.along + points[..., 1:] * across, np.float64
        )


def tunnel_mesh(
    tunnel: Tunnel,
    floor: float,  # z of the ground [m]
    outside: Material,
    inside: Material,  # Material of the opening and of both fronts
    rng: np.random.Generator,
) -> Mesh:
    """Return the mound over the road and the rock inside of it."""
    at = np.linspace(-0.5, 0.5, _SECTIONS) * tunnel.length
    lumps = _lumps(rng)
    # The ends are lower and uneven, so that no two fronts are alike.
    end = np.clip((tunnel.length / 2 - np.abs(at)) / 5.0, 0.0, 1.0)[:, None]
    size = lumps * (0.4 + 0.6 * end) - 0.7 * (1.0 - end)
    outer = _arches(at, HALF_WIDTH + size, _TOP + size, 2.3)
    inner = _arches(at, _OPENING[0] + 0.3 * lumps, _OPENING[1] + 0.25 * lumps, 3.0)
    outer[1:-1, :, 0] += rng.uniform(-0.6, 0.6, outer[1:-1, :, 0].shape)
    parts = [
        _surface(tunnel, floor, outer[::-1], outside),
        _surface(tunnel, floor, inner, inside),
        _surface(tunnel, floor, np.stack([outer[0], inner[0]]), inside),
        _surface(tunnel, floor, np.stack([inner[-1], outer[-1]]), inside),
    ]
    return concatenate(parts)


def tunnel_prisms(tunnel: Tunnel, floor: float) -> list[tuple[Points, float, float]]:
    """Return the solids of a tunnel: outline, bottom and top of each [m]."""
    half = tunnel.length / 2 - 0.5
    made = []
    for right, left in pairwise(_STRIPS):
        outline = np.array([(-half, right), (half, right), (half, left), (-half, left)])
        far, near = max(abs(right), abs(left)), min(abs(right), abs(left))
        if right < 0.0 < left:
            near = 0.0
        legs = far > _OPENING[0]
        bottom = floor if legs else _arch(far, *_OPENING, 3.0)
        top = _arch(min(near, 0.98 * HALF_WIDTH), HALF_WIDTH, _TOP, 2.3)
        made.append((tunnel.placed(outline), bottom, floor + top))
    return made


def _arch(aside: float, half: float, top: float, power: float) -> float:
    return round(float(top * exact.power(1.0 - exact.power(aside / half, power), 1.0 / power)), 3)


def _lumps(rng: np.random.Generator) -> Points:
    """Return how far each point of the arches lies outwards, smooth but uneven [m]."""
    i, j = np.meshgrid(np.arange(_SECTIONS), np.arange(_SIDES + 1), indexing="ij")
    lumps = np.zeros(i.shape)
    for _ in range(4):
        turn, rate = rng.uniform(0, 2 * np.pi), rng.uniform(0.35, 0.95, 2)
        lumps += exact.sin(rate[0] * i + rate[1] * j + turn) / 4
    return np.asarray(_LUMPS * (1.6 * lumps + rng.uniform(-0.45, 0.45, i.shape)), np.float64)


def _arches(at: Points, half: Points, top: Points, power: float) -> Points:
    """Return cross-sections from the right foot to the left one, shape (sections, sides + 1, 3)."""
    angle = np.linspace(0.0, np.pi, _SIDES + 1)
    cosine, sine = exact.cos(angle), np.maximum(exact.sin(angle), 0.0)
    aside = -np.sign(cosine) * exact.power(np.abs(cosine), 2 / power)
    rows = np.empty((len(at), _SIDES + 1, 3))
    rows[..., 0] = at[:, None]
    rows[..., 1] = half * aside
    rows[..., 2] = top * exact.power(sine, 2 / power)
    rows[:, [0, -1], 2] = -_SUNK
    return rows


def _surface(tunnel: Tunnel, floor: float, rows: Points, stuff: Material) -> Mesh:
    """Return the facets between neighbouring rows of points, two triangles a cell."""
    world = np.concatenate([tunnel.placed(rows[..., :2]), rows[..., 2:] + floor], axis=-1)
    tile = TEXTURES[stuff.texture]
    # Measured along the surface both ways, so that fronts and roof look alike.
    u, v = (
        np.linalg.norm(np.diff(rows, axis=axis, prepend=rows.take([0], axis)), axis=2).cumsum(axis)
        for axis in (0, 1)
    )
    uvs = np.stack([u, v], axis=-1) / tile
    corners = halves(cells(world))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return of_one_material(
        corners.reshape(-1, 3),
        np.repeat(normals, 3, axis=0),
        halves(cells(uvs)).reshape(-1, 2),
        np.arange(3 * len(corners)).reshape(-1, 3),
        stuff,
    )
