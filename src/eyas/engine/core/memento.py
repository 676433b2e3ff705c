"""Mementos of objects: everything that a run changes in one, to be put into another one that is
made of the same arguments.

So a copy needs neither maps nor machine code, which each process has once, nor addresses in memory.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

Memento = dict[tuple[Any, ...], Any]
"""Values of the parts that may change, by the names, indices and keys that lead to each."""

_VALUES = (type(None), bool, int, float, str, np.generic)


def remember(thing: object, fixed: tuple[type, ...]) -> Memento:
    """Return what an object remembers.

    Args:
        thing: An object with attributes.
        fixed: Types of parts that no run changes, or that are worked out anew at each use.

    Raises:
        TypeError: A part is of a type that is unknown here: nothing is left out silently.
    """
    found: Memento = {}
    _collect(thing, (), fixed, found, set())
    return found


def recall(thing: object, memento: Memento) -> None:
    """Make an object remember what another one of the same arguments does."""
    for path, value in memento.items():
        parent = thing
        for step in path[:-1]:
            parent = _part(parent, step)
        if isinstance(value, np.ndarray) and value.shape == _part(parent, path[-1]).shape:
            _part(parent, path[-1])[...] = value
        elif isinstance(value, list):
            _part(parent, path[-1])[:] = value
        elif isinstance(parent, dict | list):
            parent[path[-1]] = value
        else:
            setattr(parent, path[-1], value)


def _collect(
    thing: Any,  # noqa: ANN401  # anything
    path: tuple[Any, ...],
    fixed: tuple[type, ...],
    found: Memento,
    seen: set[int],
) -> None:
    """Add what a part remembers; `seen` has the identities of all parts that were met."""
    if id(thing) in seen or isinstance(thing, fixed):
        return
    seen.add(id(thing))
    if isinstance(thing, np.ndarray):
        if thing.flags.writeable:
            found[path] = thing.copy()
        return
    if isinstance(thing, list) and all(isinstance(part, _VALUES) for part in thing):
        found[path] = thing.copy()
        return
    for step, part in _parts(thing, path):
        if not isinstance(part, _VALUES):
            _collect(part, (*path, step), fixed, found, seen)
        elif not isinstance(thing, tuple):
            found[*path, step] = part


def _parts(whole: Any, path: tuple[Any, ...]) -> Iterable[tuple[Any, Any]]:  # noqa: ANN401  # anything
    if isinstance(whole, tuple | list):
        return enumerate(whole)
    if isinstance(whole, Mapping):
        return whole.items()
    if hasattr(whole, "__dict__"):
        return tuple(vars(whole).items())
    raise TypeError(f"{'.'.join(map(str, path))}: a {type(whole).__name__} cannot be copied")


def _part(whole: Any, step: Any) -> Any:  # noqa: ANN401  # anything
    return whole[step] if isinstance(whole, tuple | list | Mapping) else getattr(whole, step)
