"""Things that take long to make and always come out the same, kept on disk from run to run."""

import pickle
from collections.abc import Callable
from hashlib import blake2b
from pathlib import Path
from typing import TypeVar, cast

import numpy as np
import platformdirs

from eyas.core.errors import OutputError
from eyas.core.files import write_atomic

__all__ = ["kept"]

Thing = TypeVar("Thing")

_ROOT = Path(__file__).parent.parent
_DIGEST = 16
"""Bytes of the hash that each file begins with, of what follows: a damaged file is made anew."""


def kept(
    name: str,
    rooms: tuple[str, ...],
    inputs: tuple[object, ...],
    make: Callable[[], Thing],
    folder: Path | None = None,
) -> Thing:
    """Return a thing from the cache; made anew if its makers' sources or inputs are others.

    Args:
        name: What it is, the beginning of the file's name.
        rooms: Packages of Eyas, and files in them, whose sources make it.
        inputs: What they make it of; their `repr` must tell them apart.
        make: Makes it; what it returns must be picklable.
        folder: The cache; None: the user's. It saves time only: where it cannot be written to, it
            is left alone.
    """
    digest = blake2b(repr((np.__version__, inputs)).encode(), digest_size=_DIGEST)
    for room in rooms:
        place = _ROOT / room
        for path in [place] if place.is_file() else sorted(place.rglob("*.py")):
            digest.update(path.read_bytes())
    folder = folder or Path(platformdirs.user_cache_dir("eyas")) / "made"
    path = folder / f"{name}-{digest.hexdigest()}.pickle"
    try:
        data = path.read_bytes()
    except OSError:
        data = b""
    if data and blake2b(data[_DIGEST:], digest_size=_DIGEST).digest() == data[:_DIGEST]:
        return cast("Thing", pickle.loads(data[_DIGEST:]))  # our own file: its hash was checked
    made = make()
    payload = pickle.dumps(made, protocol=5)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_atomic(path, blake2b(payload, digest_size=_DIGEST).digest() + payload)
    except (OSError, OutputError):
        pass
    return made
