"""What a visibility buffer shows, as depths, as object ids and as classes."""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.lanes.vector import WIDTH, load, store
from eyas.render.kernels.bundles import Geometry, Movers
from eyas.render.kernels.scalars import f4, i8
from eyas.render.kernels.visibility.key import distance_inverse, drawn_of, tag_of, triangle_of
from eyas.state.scene import ACTOR_OBJECT, SKY_OBJECT

__all__ = ["object_of", "write_classes", "write_depth", "write_objects"]


@kernel
def write_depth(key: NDArray[np.int64], output: NDArray[np.float32]) -> None:
    """Write the distance along the optical axis of each pixel [m], infinity for sky.

    Args:
        key: See `Scratch`, shape (rows, columns).
        output: Shape (rows, width of the picture).
    """
    width = output.shape[1]
    for row in range(output.shape[0]):
        whole = width & -WIDTH
        for column in range(0, whole, WIDTH):
            inverse = distance_inverse(load(key, row * key.shape[1] + column))
            store(output, row * width + column, f4(1.0) / inverse)
        for column in range(whole, width):
            output[row, column] = f4(1.0) / distance_inverse(key[row, column])


@kernel(inline=True)
def object_of(
    geometry: Geometry, movers: Movers, world: int, drawn: NDArray[np.int32], key: int
) -> int:
    """Return the object id for a key."""
    if key == 0:
        return SKY_OBJECT
    tag = tag_of(key)
    row = drawn_of(tag)
    if row < 0:
        return i8(geometry.object_id[triangle_of(tag)])
    instance, fixtures = drawn[row, 1], len(geometry.fixture_object)
    if instance < fixtures:
        return i8(geometry.fixture_object[instance])
    return i8(movers.object_id[world, instance - fixtures])


@kernel
def write_objects(
    geometry: Geometry,
    movers: Movers,
    world: int,
    drawn: NDArray[np.int32],
    key: NDArray[np.int64],
    output: NDArray[np.int32],
) -> None:
    """Write the object of each pixel.

    Args:
        geometry: Everything that can be drawn.
        movers: The draw lists.
        world: The one of the view.
        drawn: See `Scratch`.
        key: See `Scratch`, shape (rows, columns).
        output: Shape (rows, width of the picture).
    """
    for row in range(output.shape[0]):
        for column in range(output.shape[1]):
            output[row, column] = object_of(geometry, movers, world, drawn, key[row, column])


@kernel
def _class_of(
    geometry: Geometry, movers: Movers, world: int, drawn: NDArray[np.int32], key: int
) -> int:
    """Return the class for a key."""
    shown = object_of(geometry, movers, world, drawn, key)
    if shown >= ACTOR_OBJECT:
        return i8(movers.object_class[world, shown - ACTOR_OBJECT])
    sky = len(geometry.object_class) - 1
    return i8(geometry.object_class[sky if shown == SKY_OBJECT else shown])


@kernel
def write_classes(
    geometry: Geometry,
    movers: Movers,
    world: int,
    drawn: NDArray[np.int32],
    key: NDArray[np.int64],
    output: NDArray[np.uint8],
) -> None:
    """Write the class of each pixel; arguments as above.

    Most pixels show the same triangle as the one before them.
    """
    for row in range(output.shape[0]):
        before, shown = i8(0), _class_of(geometry, movers, world, drawn, i8(0))
        for column in range(output.shape[1]):
            now = key[row, column]
            if tag_of(now) != tag_of(before) or (now == i8(0)) != (before == i8(0)):
                shown = _class_of(geometry, movers, world, drawn, now)
            before = now
            output[row, column] = shown
