"""Bundles in the memory of a graphics processor, laid out as `eyas.lanes.held` has them here."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from eyas.lanes.cuda.memory import CudaArray
from eyas.lanes.held import _NOTHING, _flatten, _layout, _layouts

__all__ = ["Laid", "laid", "mapped", "types_of"]


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
