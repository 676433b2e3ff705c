"""Shapes of parts at levels of detail."""

from collections.abc import Callable
from functools import lru_cache

from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Mesh

Shape = Callable[[Shell, int], None]
"""Adds the panels of a part to a shell, in the part's own frame. The number is the detail: 2 from
near, 1, or 0 from afar; a part may be empty from afar."""

DETAILS = (2, 1, 0)  # From near to afar, the order of levels of detail


def levels_of(shape: Shape) -> tuple[Mesh, ...]:
    """Return the meshes of a shape, the finest first."""
    return tuple(shell_of(shape, detail).mesh() for detail in DETAILS)


@lru_cache(maxsize=1024)  # people share most shapes, whose meshes and extents are both wanted
def shell_of(shape: Shape, detail: int) -> Shell:
    """Return the panels of a shape, which must not be changed."""
    shell = Shell()
    shape(shell, detail)
    return shell
