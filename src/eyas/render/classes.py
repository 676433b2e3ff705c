"""What each pixel is, looked up from the object it shows."""

import numpy as np
from numpy.typing import NDArray

from eyas.state.scene import ObjectClass, Scene

__all__ = ["class_table", "write_classes"]


def class_table(scene: Scene) -> NDArray[np.uint8]:
    """Return the class of each of the scene's O objects, of actors, and of the sky, shape (O + 2,).

    The sky comes last: its object id, -1, counts from the end.
    """
    ends = [ObjectClass.VEHICLE, ObjectClass.SKY]
    return np.concatenate([scene.object_class, ends]).astype(np.uint8)


def write_classes(
    table: NDArray[np.uint8], object_id: NDArray[np.int32], class_id: NDArray[np.uint8]
) -> None:
    """Write the class of each pixel.

    Args:
        table: See `class_table`.
        object_id: Object of each pixel, shape (V, H, W).
        class_id: Written in place, same shape.
    """
    class_id[:] = table[np.minimum(object_id, len(table) - 2)]
