"""Conversion between points in the world and samples of a view."""

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import View

__all__ = ["around", "nowhere", "point_of"]


@inlined_kernel
def nowhere() -> tuple[float, float, float, float]:
    """Return an empty box: left, top, right, bottom [samples]."""
    return 1e9, 1e9, -1e9, -1e9


@inlined_kernel
def around(
    box: tuple[float, float, float, float], view: View, x: float, y: float, z: float
) -> tuple[float, float, float, float]:
    """Return a screen box extended by a point; unbounded if the point is not in front."""
    rows, lens = view.rows, view.lens
    w = rows[2, 0] * x + rows[2, 1] * y + rows[2, 2] * z + rows[2, 3]
    if w < 0.1:
        return -1e9, -1e9, 1e9, 1e9
    column = rows[0, 0] * x + rows[0, 1] * y + rows[0, 2] * z + rows[0, 3]
    row = rows[1, 0] * x + rows[1, 1] * y + rows[1, 2] * z + rows[1, 3]
    column, row = 0.5 * lens[1] + column / w, 0.5 * lens[2] + row / w
    return min(box[0], column), min(box[1], row), max(box[2], column), max(box[3], row)


@inlined_kernel
def point_of(view: View, line: int, column: int) -> tuple[float, float, float]:
    """Return the point that a sample shows [m]; it must not be sky."""
    eye, axes, lens = view.eye, view.axes, view.lens
    left = (0.5 * lens[1] - (column + 0.5)) / lens[0]
    up = (0.5 * lens[2] - (line + view.top + 0.5)) / lens[4]
    w = 1.0 / view.depth[line, column]
    return (
        eye[0] + w * (axes[0, 0] + left * axes[1, 0] + up * axes[2, 0]),
        eye[1] + w * (axes[0, 1] + left * axes[1, 1] + up * axes[2, 1]),
        eye[2] + w * (axes[0, 2] + left * axes[1, 2] + up * axes[2, 2]),
    )
