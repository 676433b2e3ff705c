"""Lines of paint on roads: as much paint in a pixel as it covers of the line."""

from eyas.lanes import kernel
from eyas.lanes.vector import greater, lesser, magnitude, root
from eyas.render.kernels.scalars import f4
from eyas.state.mesh import MARGIN

__all__ = ["TILES", "painted_share"]

TILES = f4(1.0 / 8.0)
"""Repeats of the texture in a metre, see `Surface.MARKING`."""

_WIDEST = f4(2.0 * MARGIN)

Vector = tuple[float, float, float]


@kernel(inline=True)
def painted_share(
    across: float, slope: Vector, scale: float, way: Vector, cosine: float, size: float
) -> float:
    """Return the share of a pixel that a line covers, 0 to 1.

    The pixel is a strip along the line, as wide as the pixel reaches across it, but not wider than
    the margins let be seen: lines farther away are as bright on average, but less steady.

    Args:
        across: u, see `Surface.MARKING`.
        slope: Gradient of u [1/m].
        scale: Its length: one over half the width of the line [1/m].
        way: Unit vector from the eye.
        cosine: Of the angle between the normal and the way to the eye.
        size: Width of the pixel at the point, seen from the front [m].
    """
    one = f4(1.0)
    # A pixel is a circle seen from the front; on the ground it is longer along the view.
    lean = (slope[0] * way[0] + slope[1] * way[1] + slope[2] * way[2]) / greater(cosine, f4(0.05))
    wide = lesser(size * root(scale * scale + lean * lean), _WIDEST * scale)
    half = greater(f4(0.5) * wide, f4(1e-3))
    away = magnitude(across - f4(32.0))
    shown = lesser(away + half, one) - greater(away - half, f4(-1.0))
    return greater(shown, f4(0.0)) / (half + half)
