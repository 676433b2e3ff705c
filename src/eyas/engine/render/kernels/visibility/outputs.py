"""What a visibility buffer shows, as depths, as object ids and as classes."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import SHADING_COLUMNS, Band
from eyas.engine.render.kernels.scalars import f4, i4, i8
from eyas.engine.render.kernels.visibility.key import (
    distance_inverse,
    drawn_of,
    tag_of,
    triangle_of,
)
from eyas.engine.state.scene import ACTOR_OBJECT, SKY_OBJECT
from eyas.lanes import kernel
from eyas.lanes.vector import WIDTH, bit_pattern, load, store


@kernel
def write_depth(
    key: NDArray[np.int64],  # See `Scratch`, shape (rows, columns)
    output: NDArray[np.float32],  # Shape (rows, width of the picture)
    member: int,  # See `Band`
    members: int,  # See `Band`
) -> None:
    """Write the distance along the optical axis of each pixel [m], infinity for sky."""
    width = output.shape[1]
    for row in range(member, output.shape[0], members):
        whole = width & -WIDTH
        for column in range(0, whole, WIDTH):
            inverse = distance_inverse(load(key, row * key.shape[1] + column))
            store(output, row * width + column, f4(1.0) / inverse)
        for column in range(whole, width):
            output[row, column] = f4(1.0) / distance_inverse(key[row, column])


@kernel(inline=True)
def object_of(band: Band, key: int) -> int:
    """Return the object id for a key."""
    geometry, drawn = band.geometry, band.drawn
    if key == 0:
        return SKY_OBJECT
    tag = tag_of(key)
    row = drawn_of(tag)
    if row < 0:
        word = bit_pattern(geometry.shading[triangle_of(tag), SHADING_COLUMNS - 1])
        return i8(word >> i4(16)) & i8(0xFFFF)  # ids of a large city fill all sixteen bits
    instance, fixtures = drawn[row, 1], len(geometry.fixture_object)
    if instance < fixtures:
        return i8(geometry.fixture_object[instance])
    return i8(band.movers.object_id[band.world, instance - fixtures])


@kernel
def write_objects(band: Band, output: NDArray[np.int32]) -> None:
    """Write the object of each pixel into an array, shape (rows, width of the picture)."""
    key = band.key
    for row in range(band.member, output.shape[0], band.members):
        for column in range(output.shape[1]):
            if key[row, column] >= i8(0):
                output[row, column] = object_of(band, key[row, column])


@kernel
def _class_of(band: Band, key: int) -> int:
    """Return the class for a key."""
    shown, classes = object_of(band, key), band.geometry.object_class
    if shown >= ACTOR_OBJECT:
        return i8(band.movers.object_class[band.world, shown - ACTOR_OBJECT])
    return i8(classes[len(classes) - 1 if shown == SKY_OBJECT else shown])


@kernel
def write_classes(band: Band, output: NDArray[np.uint8]) -> None:
    """Write the class of each pixel into an array, shape (rows, width of the picture).

    Most pixels show the same triangle as the one before them.
    """
    key = band.key
    for row in range(band.member, output.shape[0], band.members):
        before, shown = i8(0), _class_of(band, i8(0))
        for column in range(output.shape[1]):
            now = key[row, column]
            if now < i8(0):
                continue
            if tag_of(now) != tag_of(before) or (now == i8(0)) != (before == i8(0)):
                shown = _class_of(band, now)
            before = now
            output[row, column] = shown
