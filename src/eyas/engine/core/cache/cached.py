"""Values that take long to compute and are always the same, kept from run to run."""

import ctypes
import dataclasses
import functools
import gc
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum
from hashlib import blake2b
from pathlib import Path
from typing import TypeVar

import numpy as np

from eyas.engine.core.cache.array_file import Content, array_file, map_arrays
from eyas.engine.core.cache.entries import write_entry
from eyas.engine.core.cache.first_start import reported
from eyas.engine.core.cache.flat import flatten, restore
from eyas.engine.core.cache.folder import EntryKind, cache_limit
from eyas.engine.core.identity.program import UnknownCodeError, code_of
from eyas.lanes.trusted import cache_folder, not_kept, touch

Thing = TypeVar("Thing")

_LOG = logging.getLogger("eyas")
_PLAIN = frozenset({bool, float, int, type(None)})  # Types whose `repr` tells all


def cached(
    kind: EntryKind,
    make: Callable[[], Thing],
    inputs: tuple[object, ...],
    *,
    of: type[Thing],
    folder: Path | None = None,
) -> Thing:
    """Return a value from the cache; make it anew if what makes it or its inputs changed.

    Args:
        kind: Kind of the value.
        make: Returns the value: a function of a module, or a `partial` of one. Its code and all
            that this calls are part of the key (`identity/program.py`); its arguments are not.
        inputs: What the value depends on: see `key_of`.
        of: Type of the value; `eyas.engine.core.cache.flat` must be able to flatten it.
        folder: The cache; None: the user's. The cache only saves time: one that cannot be written
            to is not used, and a damaged entry is made anew.

    Raises:
        ConfigError: `EYAS_CACHE_LIMIT` is not a size.
    """
    with _without_collection():
        return _found_or_made(kind, make, inputs, of, folder)


@contextmanager
def _without_collection() -> Iterator[None]:
    """Let Python not look for garbage meanwhile.

    Plans, meshes and scenes are a million small objects that stay; to go through all of them again
    and again takes a tenth of the time in which they are made.
    """
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def _found_or_made(
    kind: EntryKind,
    make: Callable[[], Thing],
    inputs: tuple[object, ...],
    of: type[Thing],
    folder: Path | None,
) -> Thing:
    """Return what `cached` does."""
    limit = cache_limit()
    try:
        path = (folder or cache_folder()) / kind / f"eyas-{key_of(make, inputs)}.npy"
    except UnknownCodeError as error:  # typed in by the user, for example
        _LOG.debug("%s is made at each start: %s", kind, error)
        path = None
    found = None if path is None else _found(path, of)
    if found is None:
        found = _made_and_kept(kind, make, of, path, limit)
        # Making leaves tens of megabytes free, in pieces that glibc gives back only if it is asked.
        getattr(ctypes.CDLL(None), "malloc_trim", bool)(0)
    return found


def _made_and_kept(
    kind: EntryKind, make: Callable[[], Thing], of: type[Thing], path: Path | None, limit: int
) -> Thing:
    """Return what is made, and keep it as an entry if that has a path."""
    with reported(kind):
        made = make()
    flat, arrays = flatten(made)
    content = Content(flat, [np.asarray(array, order="C") for array in arrays])
    found = None
    if path is not None:
        try:
            write_entry(path, array_file(content, path.name), limit)
        except OSError as error:
            not_kept(error)
        else:
            # The file takes the place of what was made: of that a process needs a part only.
            found = _found(path, of, written=True)
    # A value just made is restored like one read from the file, so that both have the same types.
    return restore(of, *content) if found is None else found


def _found(path: Path, of: type[Thing], *, written: bool = False) -> Thing | None:
    """Return the value of an entry; None if there is none, or it is damaged.

    If this process has just written it, it is not read to see whether it is whole.
    """
    try:
        found = restore(of, *map_arrays(path, checked=not written))
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        return None  # if it cannot be replaced either, that is told
    except (OSError, ValueError):
        _LOG.warning("%s: damaged or unreadable, so it is made anew", path)
        return None
    touch(path)
    return found


def key_of(make: Callable[..., object], inputs: tuple[object, ...]) -> str:
    """Return what identifies a value: 32 hexadecimal digits.

    Args:
        make: See `cached`.
        inputs: Arrays; functions, which stand for their code; records, tuples and dicts of such;
            and values that differ in their `repr`.

    Raises:
        UnknownCodeError: The code of something cannot be found, or an input has no `repr` that
            would be the same in another process.
    """
    digest = blake2b(code_of(make).encode(), digest_size=16)
    for value in inputs:
        _add(value, digest.update)
        digest.update(b"\0")
    return digest.hexdigest()


def _add(value: object, add: Callable[[bytes | memoryview], None]) -> None:
    """Add to a digest what tells a value from others."""
    if type(value) in _PLAIN:  # nearly all are, and the questions below take longer
        add(repr(value).encode())
    elif isinstance(value, np.ndarray):
        add(repr((value.dtype.descr, value.shape)).encode())
        add(np.ascontiguousarray(value).reshape(-1).view(np.uint8).data)
    elif isinstance(value, tuple | list | dict):
        add(f"{type(value).__name__} {len(value)}".encode())
        for part in value.items() if isinstance(value, dict) else value:
            _add(part, add)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        add(type(value).__name__.encode())
        for field in dataclasses.fields(value):
            _add(getattr(value, field.name), add)
    elif callable(value) and not isinstance(value, Enum):
        add(code_of(value).encode())
        if isinstance(value, functools.partial):
            _add((value.args, value.keywords), add)
    else:
        text = repr(value)
        if " at 0x" in text:
            raise UnknownCodeError(f"{text}: its `repr` is another one in each process")
        add(text.encode())
