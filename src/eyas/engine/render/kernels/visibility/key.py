"""The key of a sample: distance and triangle in one number, of which the larger is shown.

The upper 32 bits hold 1/distance as a float32, whose bits are in the order of their values. The
lower 32 bits, the tag, name the triangle: bit 31 is 0 for triangle number `tag` of the static mesh;
else bits 17 to 30 hold a row of `Scratch.drawn`, and bits 0 to 16 the triangle in its mesh. So the
order in which triangles are drawn changes no byte. A key of 0 is sky.
"""

from eyas.engine.render.kernels.scalars import i4, i8
from eyas.lanes import kernel
from eyas.lanes.vector import bit_pattern, from_bits, like, select, to_i4, to_i8

TRIANGLE_BITS = 17
MOST_TRIANGLES = 1 << TRIANGLE_BITS  # Limit of the triangles of a level of detail

MOST_INSTANCES = 1 << (31 - TRIANGLE_BITS)
"""Limit of the instances that a view shows; more are left out."""

_MOVED = 1 << 31


@kernel(inline=True)
def instance_tag(drawn: int) -> int:
    """Return the tag of the first triangle of an instance, a row of `Scratch.drawn`."""
    return i8(_MOVED | (drawn << TRIANGLE_BITS))


@kernel(inline=True)
def key_of(inverse: float, tag: int) -> int:
    """Return the key of a distance, given as its inverse, and a tag (int64)."""
    return (to_i8(bit_pattern(inverse)) << i8(32)) | tag


@kernel(inline=True)
def distance_inverse(key: int) -> float:
    """Return 1/distance, 0 for sky."""
    return from_bits(to_i4(key >> i8(32)))


@kernel(inline=True)
def tag_of(key: int) -> int:
    """Return the lower half of a key, as int32: negative for instances."""
    return to_i4(key)


@kernel(inline=True)
def drawn_of(tag: int) -> int:
    """Return the row of `Scratch.drawn` that a tag names, -1 for the static mesh."""
    row = (tag >> i4(TRIANGLE_BITS)) & i4(MOST_INSTANCES - 1)
    return to_i4(select(tag < i4(0), row, like(tag, i4(-1))))


@kernel(inline=True)
def triangle_of(tag: int) -> int:
    """Return the triangle that a tag names: of the static mesh, or counted in its own mesh."""
    return to_i4(select(tag < i4(0), tag & i4(MOST_TRIANGLES - 1), tag))
