"""Triangle meshes and their materials."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

MARGIN = 0.275
"""Asphalt beside the lines of a `Surface.MARKING` [m]: half the gap between bars of a crossing."""


class Surface(IntEnum):
    """Kinds of surfaces: the way in which a material reflects or emits light."""

    MATT = 0
    """Plain diffuse."""
    PAINT = 1
    """Car paint: tint times the colour of the instance, with a gloss where the texture's alpha is
    high."""
    GLASS = 2
    """Reflects the sky."""
    FOLIAGE = 3
    """Leaves: lit from both sides, with holes where the texture's alpha is low."""
    FACADE = 4
    """A wall with windows: glass where the texture's alpha is low."""
    WATER = 5
    """Reflects the sky, with small waves."""
    LAMP = 6
    """Emits light (`emission`) when the weather has its lamps on."""
    CROWN = 7
    """Inside of a tree's crown: matt, and casts no shadow; the leaves in front of it do."""
    SIGNAL = 8
    """Emits light (`emission`) in every weather, like a traffic light."""
    MARKING = 9
    """A line of paint on level asphalt; a pixel shows as much of each as it covers. The texture
    repeats every 8 m, whatever u and v: asphalt and, in alpha, the brightness of paint. u is 31 at
    the right edge of the line and 33 at the left one, and v has the same scale. Triangles without
    paint reach `MARGIN` farther."""
    HILLSIDE = 10
    """Grass, with dry patches, and with rock where it is steep."""
    HEATH = 11
    """Soil, with patches of dry grass and scrub."""
    TAIL_LAMP = 12
    """A `LAMP` of a vehicle that braking brightens, see `eyas.engine.state.draw.DrawList.lamps`."""
    HIGH_BRAKE_LAMP = 13
    """One that shines only when it brakes."""
    INDICATOR_LEFT = 14
    """One that blinks before it goes left."""
    INDICATOR_RIGHT = 15
    """One that blinks before it goes right."""
    DESERT = 16
    """Sand with ripples, gravel and dry grass; of this and all that follow, the texture lies on the
    ground, whatever u and v."""
    DESERT_TRACK = 17
    """`DESERT`, driven on; of this and all that follow, u is a distance [m], here from the edge of
    the track."""
    DESERT_SNOW = 18
    """`DESERT` with snow; u is 32 m more than the height over the line where snow begins."""
    DESERT_DRIFT = 19
    """Asphalt under sand that grows thinner; u is the distance from where it hides the road."""
    HILLSIDE_PATH = 20
    """Grass trodden down to the soil; u is the distance from the edge of the path."""
    HILLSIDE_SHORE = 21
    """Grass beside water; u is the distance from the water."""
    HEATH_SHORE = 22
    """Heath beside water; u is the distance from the water."""
    HILLSIDE_VERGE = 23
    """Gravel beside a road that grass grows into; u is the distance from the road."""


@dataclass(frozen=True, slots=True)
class Material:
    """Material of a triangle."""

    texture: str = "plain"
    """Name of a texture in `eyas.engine.world.build.materials.TEXTURES`; `plain` is white."""
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Factor on the texture, sRGB, each 0 to 1; slightly more where plain parts of the texture are
    not white."""
    surface: Surface = Surface.MATT
    """Kind of its surface."""
    emission: float = 0.0
    """Emitted light, as a factor on the colour."""


@dataclass(slots=True)
class Mesh:
    """Triangles, counter-clockwise as seen from outside. V vertices, T triangles."""

    positions: NDArray[np.float32]
    """Vertices [m], shape (V, 3)."""
    normals: NDArray[np.float32]
    """Unit normals, shape (V, 3)."""
    uvs: NDArray[np.float32]
    """Texture coordinates in tiles (1 = one repeat), shape (V, 2); v grows upwards on walls."""
    triangles: NDArray[np.int32]
    """Vertex indices, shape (T, 3)."""
    materials: NDArray[np.int32]
    """Index into `palette` for each triangle, shape (T,)."""
    palette: tuple[Material, ...]
    """The materials used."""

    @classmethod
    def none(cls) -> "Mesh":
        """Return a mesh without triangles."""
        return cls(
            positions=np.zeros((0, 3), np.float32),
            normals=np.zeros((0, 3), np.float32),
            uvs=np.zeros((0, 2), np.float32),
            triangles=np.zeros((0, 3), np.int32),
            materials=np.zeros(0, np.int32),
            palette=(),
        )
