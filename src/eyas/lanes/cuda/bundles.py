"""Bundles in the memory of a graphics processor, laid out as `eyas.lanes.held` has them here."""

import threading
import weakref
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from eyas.lanes.cuda.context import Context
from eyas.lanes.cuda.memory import CudaArray
from eyas.lanes.held import _NOTHING, _flatten, _layout, _layouts

__all__ = ["Blocks", "CudaBundle", "laid", "mapped", "types_of"]

_SLAB = 1 << 20
"""Memory for bundles is allocated in pieces of this size [bytes]; a bundle takes some kilobytes."""


class Blocks:
    """Small pieces of a card's memory, used again and again.

    The driver would take some ten microseconds for each, and wait for all work to free one. What is
    written into a block that was used before comes after all work so far, so nothing has to wait.

    Args:
        context: Where.
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self._lock = threading.Lock()
        self._free: dict[int, list[int]] = {}
        self._slab, self._left = 0, 0

    def filled(self, content: bytes, owner: object = None) -> int:
        """Return the address of a copy of some bytes.

        Args:
            content: The bytes.
            owner: Its memory is used again when nothing refers to this any more; never, if None.
        """
        size = max(256, 1 << (len(content) - 1).bit_length())
        with self._lock:
            free = self._free.setdefault(size, [])
            address = free.pop() if free else self._new(size)
        if owner is not None:  # `append`, as this may be while the lock is held
            weakref.finalize(owner, free.append, address).atexit = False
        self._context.put(address, content)
        return address

    def _new(self, size: int) -> int:
        if size > _SLAB:
            return self._context.allocated(size)
        if size > self._left:
            self._slab, self._left = self._context.allocated(_SLAB), _SLAB
        self._left -= size
        return self._slab + self._left


class CudaBundle:
    """A bundle in the memory of a graphics processor.

    Args:
        bundle: The tuple; its arrays are all there.
        blocks: Where it is laid out.
        nothing: Address there for empty arrays, see `eyas.lanes.held`.

    Attributes:
        address: Its address there.
        kind: Identifies its type, see `eyas.lanes.held.Held`.
    """

    def __init__(self, bundle: Any, blocks: Blocks, nothing: int) -> None:  # noqa: ANN401
        self.bundle = bundle
        content, self.kind = laid(bundle, nothing)
        self.address = blocks.filled(content, self)


class Laid(NamedTuple):
    """A bundle as it is to lie in the device's memory."""

    content: bytes
    kind: str
    """See `eyas.lanes.held.Held`; the same as there, if the arrays are writable and C-contiguous.
    """


def mapped(value: Any, change: Callable[[Any], Any]) -> Any:  # noqa: ANN401  # any bundle
    """Return a bundle with each array and number changed, in tuples of the same types."""
    if not isinstance(value, tuple):
        return change(value)
    parts = [mapped(part, change) for part in value]
    return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)


def laid(bundle: Any, nothing: int) -> Laid:  # noqa: ANN401  # any bundle
    """Lay a bundle out.

    Args:
        bundle: Its arrays are all in the device's memory.
        nothing: Address there for empty arrays, see `eyas.lanes.held`.
    """
    stand_in = mapped(bundle, lambda part: part.stand_in if isinstance(part, CudaArray) else part)
    words: list[Any] = []
    key: list[object] = []
    _flatten(stand_in, words, key)
    layout = _layouts.get(tuple(key)) or _layouts.setdefault(tuple(key), _layout(stand_in))
    # Empty arrays have the very object for their address.
    words = [nothing if word is _NOTHING else word for word in words]
    return Laid(layout.format.pack(*words), layout.kind)


def types_of(bundle: Any) -> Any:  # noqa: ANN401  # any bundle
    """Return a bundle of the same types, whose arrays are small ones of numpy."""

    def small(part: Any) -> Any:  # noqa: ANN401
        return np.empty((1,) * part.ndim, part.dtype) if isinstance(part, CudaArray) else part

    return mapped(bundle, small)
