"""The class of each pixel, looked up from the object that it shows."""

import numpy as np
from numpy.typing import NDArray

from eyas.state.draw import DrawList
from eyas.state.scene import ACTOR_OBJECT, ObjectClass, Scene

__all__ = ["class_table", "write_classes"]


def class_table(scene: Scene) -> NDArray[np.uint8]:
    """Return the class of each of the scene's O objects, and of the sky, shape (O + 1,).

    The sky comes last: its object id, -1, indexes from the end.
    """
    return np.append(scene.object_class, ObjectClass.SKY).astype(np.uint8)


def write_classes(
    table: NDArray[np.uint8],
    movers: DrawList,
    world: NDArray[np.int32],
    object_id: NDArray[np.int32],
    class_id: NDArray[np.uint8],
) -> None:
    """Write the class of each pixel.

    Args:
        table: From `class_table`.
        movers: Classes of the moving objects.
        world: World whose movers each view shows, shape (V,).
        object_id: Object of each pixel, shape (V, H, W).
        class_id: Written in place, same shape.
    """
    moving = object_id >= ACTOR_OBJECT
    class_id[:] = table[np.where(moving, -1, object_id)]
    row = world[np.nonzero(moving)[0]]
    class_id[moving] = movers.object_class[row, object_id[moving] - ACTOR_OBJECT]
