"""Baked arrays that are kept from run to run, by a hash of all that went into them."""

import io
import logging
import time
import zipfile
from collections.abc import Callable, Iterable
from hashlib import blake2b
from pathlib import Path

import numpy as np
import platformdirs
from numpy.typing import NDArray

from eyas.core.errors import OutputError
from eyas.core.files import write_atomic

__all__ = ["baked", "content_hash", "shadow_folder"]

_log = logging.getLogger("eyas")


def shadow_folder() -> Path:
    """Return where baked arrays are kept."""
    return Path(platformdirs.user_cache_dir("eyas")) / "shadows"


def content_hash(name: bytes, arrays: Iterable[NDArray[np.generic]]) -> str:
    """Return a hash of a format's name and of arrays."""
    digest = blake2b(name, digest_size=16)
    for array in arrays:
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()


def baked(
    what: str,
    folder: Path | None,
    name: str,
    shape: tuple[int, ...],
    make: Callable[[], NDArray[np.uint16]],
) -> NDArray[np.uint16]:
    """Return an array from the cache; made anew only if the cache has none.

    Args:
        what: What it is, for the log.
        folder: The cache, or None to use none. A file in it that cannot be read is made anew; a
            folder that cannot be written to is left alone.
        name: Of the file, without its ending: what `content_hash` returned.
        shape: Of the array.
        make: Makes the array.
    """
    path = folder / f"{name}.npz" if folder else None
    kept = _load(path, shape) if path else None
    if kept is not None:
        return kept
    start = time.perf_counter()
    made = make()
    _log.info("baked %s in %.1f s, once for this map and sun", what, time.perf_counter() - start)
    if path:
        _save(path, made)
    return made


def _load(path: Path, shape: tuple[int, ...]) -> NDArray[np.uint16] | None:
    """Return a kept array, or None if there is none or it is damaged (zip files carry a CRC)."""
    try:
        with np.load(path) as archive:
            kept: NDArray[np.uint16] = archive["heights"]
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    return kept if kept.shape == shape and kept.dtype == np.uint16 else None


def _save(path: Path, made: NDArray[np.uint16]) -> None:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, heights=made)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(path, buffer.getvalue())
    except (OSError, OutputError):
        return  # the cache saves time only
