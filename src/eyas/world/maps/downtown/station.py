"""The station of the elevated railway: platforms on both sides of its tracks, canopies, stairs."""

import numpy as np

from eyas.mesh.assembly import concatenate
from eyas.mesh.flat import quads
from eyas.mesh.solids import box
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES, material
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.maps.downtown.viaduct import STATION, UNDER, Viaduct

__all__ = ["DARK", "PLATFORM", "SLAB", "STEEL", "add_station", "level"]

PLATFORM = (3.45, 7.6)
"""Inner and outer edge of the platforms, from the middle of the line [m]."""
STEEL = material("plain", (0.27, 0.32, 0.31))
"""What the railway is built of."""
DARK = material("plain", (0.16, 0.19, 0.19))
"""Its railings, posts and undersides."""
SLAB = material("concrete", (0.88, 0.87, 0.84))
"""Its platforms and the feet of its columns."""

_TOP = 8.5
"""z of the platforms: they hide the railings of the deck [m]."""
_FOOT = UNDER + 0.3
"""z of their undersides: over those of the girders [m]."""
_TREADS, _GOING = 24, 0.48
_STAIRS = _TREADS * _GOING
"""Number and depth of the treads of stairs, and the length of a flight [m]."""
_INNER = 4.75
"""Inner edge of the stairs, beside the girders [m]."""
_CANOPY = 11.3
"""z of the upper edge of the canopies [m]."""
_OPEN = 6.0
"""Length of a platform without canopy at either end [m]."""
_WING = 1.75
"""Half the width of a canopy [m]."""
_YELLOW = material("plain", (0.88, 0.70, 0.12))
_COPPER = material("roof_membrane", (0.50, 0.74, 0.66))
_WOOD = material("plain", (0.30, 0.22, 0.16))
_GLOW = Material(tint=(1.0, 0.92, 0.76), surface=Surface.LAMP, emission=1.6)


def add_station(builder: SceneBuilder, line: Viaduct) -> None:
    """Add platforms and canopies on both sides of the tracks."""
    kind = builder.prototype("station", lambda: (_station(fine=True), _station()))
    spot = (*line.at(line.station).tolist(), 0.0)
    owner = builder.add_copy(ObjectClass.STRUCTURE, kind, spot, line.turn, 1.0)
    low, high = line.station - STATION / 2, line.station + STATION / 2
    for side in (-1, 1):
        right, left = sorted(side * edge for edge in PLATFORM)
        builder.add_prism(line.strip(low, high, right, left), _FOOT, _TOP, owner)
        roof = line.strip(low + _OPEN, high - _OPEN, right, left)
        builder.add_prism(roof, _CANOPY - 0.7, _CANOPY, owner)
        right, left = sorted((side * _INNER, side * PLATFORM[1]))
        for end in (low - _STAIRS, high):
            stairs = line.strip(end, end + _STAIRS, right, left)
            builder.add_prism(stairs, FLOOR_HEIGHT, _TOP, owner)


def level(
    west: float, east: float, south: float, north: float, z: float, cover: Material,
    *, down: bool = False,
) -> Mesh:  # fmt: skip
    """Return a level rectangle."""
    corners = np.array([(west, south, z), (east, south, z), (east, north, z), (west, north, z)])
    corners = corners[::-1] if down else corners
    return quads(corners[None], corners[None, :, :2] / TEXTURES[cover.texture], cover)


def _station(*, fine: bool = False) -> Mesh:
    """Return the station along x: its middle over the origin."""
    near, far = PLATFORM
    half = STATION / 2
    deep = _TOP - _FOOT
    made = []
    for side in (-1, 1):
        middle = side * (near + far) / 2
        at = (0.0, middle, _FOOT + deep / 2)
        made.append(box((STATION, far - near, deep), at, SLAB, TEXTURES["concrete"]))
        edge = sorted((side * near, side * (near + 0.4)))
        made.append(level(-half, half, edge[0], edge[1], _TOP + 0.01, _YELLOW))
        made += _canopy(middle, half - _OPEN)
        made += [_stairs(end, side * (_INNER + far) / 2, far - _INNER) for end in (-half, half)]
        fence = (0.0, side * (far - 0.06), _TOP + 0.6)
        made.append(box((STATION, 0.06, 1.2), fence, STEEL, 1.0))
        if fine:
            for x in np.arange(-half + 9.0, half - 6.0, 6.0).tolist():
                post = (x, middle, (_TOP + _CANOPY - 0.5) / 2)
                made.append(box((0.18, 0.18, _CANOPY - 0.5 - _TOP), post, DARK, 1.0))
                made.append(box((1.6, 0.3, 0.08), (x + 3.0, middle, _CANOPY - 0.75), _GLOW, 1.0))
            made += [
                box((1.8, 0.5, 0.5), (x, middle, _TOP + 0.25), _WOOD, 1.0)
                for x in np.arange(-half + 12.0, half - 12.0, 12.0).tolist()
            ]
    return concatenate(made)


def _stairs(end: float, middle: float, width: float) -> Mesh:
    """Return the stairs from one end of a platform down to the ground, with solid sides."""
    out = float(np.sign(end))
    rise = (_TOP - FLOOR_HEIGHT) / _TREADS
    made = []
    for k in range(_TREADS):
        top = _TOP - (k + 0.5) * rise
        at = (end + out * (k + 0.5) * _GOING, middle, top - 0.4)
        made.append(box((_GOING, width - 0.5, 0.8), at, SLAB, 6.0))
    for y in (middle - width / 2 + 0.15, middle + width / 2 - 0.15):
        ends = ((end, _TOP), (end + out * _STAIRS, FLOOR_HEIGHT))
        side = np.array([(x, y, z + high) for (x, z), high in zip(
            (*ends, *ends[::-1]), (-0.9, -0.1, 1.1, 1.1), strict=True)])  # fmt: skip
        apart = np.array([0.0, 0.05, 0.0])
        faces = np.stack([side - out * apart, side[::-1] + out * apart])
        made.append(quads(faces, np.zeros((2, 4, 2)), STEEL))
    return concatenate(made)


def _canopy(middle: float, half: float) -> list[Mesh]:
    """Return a roof of two slopes that fall to its middle, seamed by ribs."""
    made = []
    for side in (-1, 1):
        outer, inner = middle + side * _WING, middle
        top, low = _CANOPY, _CANOPY - 0.35
        slope = np.array([(-half, inner, low), (half, inner, low),
                          (half, outer, top), (-half, outer, top)])  # fmt: skip
        slope = slope if side > 0 else slope[::-1]
        flat = slope[:, :2] / TEXTURES[_COPPER.texture]
        made += [quads(slope[None], flat[None], _COPPER)]
        under = slope[::-1] - [0.0, 0.0, 0.12]
        made.append(quads(under[None], np.zeros((1, 4, 2)), DARK))
        made.append(box((2 * half, 0.08, 0.3), (0.0, outer, top - 0.1), STEEL, 1.0))
    return made
