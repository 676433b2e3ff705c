"""Bundles in the memory of a graphics processor, laid out as `eyas.lanes.held` has them here."""

import threading
import weakref
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from eyas.gpu.cuda.context import Context
from eyas.gpu.cuda.memory import CudaArray
from eyas.lanes.held import _NOTHING, _flatten, _layout, _layouts

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
        bundle: The tuple.
        on_card: Puts its arrays there; it is called for all that is no tuple.
        blocks: Where the bundle is laid out.
        nothing: Address there for empty arrays, see `eyas.lanes.held`.

    Attributes:
        bundle: The tuple with its arrays there.
        address: Its address there.
        kind: Identifies its type, see `eyas.lanes.held.Held`; the same as there, if all its arrays
            are writable and C-contiguous.
    """

    def __init__(
        self,
        bundle: Any,  # noqa: ANN401
        on_card: Callable[[Any], Any],
        blocks: Blocks,
        nothing: int,
    ) -> None:
        words: list[Any] = []
        key: list[object] = []

        def add(value: Any) -> Any:  # noqa: ANN401  # anything in a bundle
            """Append what `eyas.lanes.held` would; its words of an array are asked for once."""
            if isinstance(value, tuple):
                key.extend((type(value), len(value)))
                return _like(value, map(add, value))
            part = on_card(value)
            if isinstance(part, CudaArray):
                if part.words is None:
                    own: tuple[list[Any], list[object]] = [], []
                    _flatten(part.stand_in, *own)
                    part.words = own
                words.extend(part.words[0])
                key.extend(part.words[1])
            else:
                _flatten(part, words, key)
            return part

        self.bundle = add(bundle)
        layout = _layouts.get(tuple(key)) or _layouts.setdefault(
            tuple(key), _layout(_mapped(self.bundle, lambda array: array.stand_in))
        )
        # Empty arrays have the very object for their address.
        words = [nothing if word is _NOTHING else word for word in words]
        self.kind = layout.kind
        self.address = blocks.filled(layout.format.pack(*words), self)

    @property
    def types(self) -> Any:  # noqa: ANN401
        """A bundle of the same types, whose arrays are small ones of numpy."""
        return _mapped(self.bundle, lambda array: np.empty((1,) * array.ndim, array.dtype))


def _like(bundle: Any, parts: Iterable[Any]) -> Any:  # noqa: ANN401  # a tuple
    """Return a tuple of the type of another."""
    return type(bundle)(*parts) if hasattr(bundle, "_fields") else tuple(parts)


def _mapped(value: Any, change: Callable[[CudaArray], Any]) -> Any:  # noqa: ANN401
    """Return a bundle with others in the places of its arrays."""
    if isinstance(value, tuple):
        return _like(value, [_mapped(part, change) for part in value])
    return change(value) if isinstance(value, CudaArray) else value
