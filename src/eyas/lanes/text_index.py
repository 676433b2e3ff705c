"""What is read from the texts of files, kept by digests of the texts: each takes milliseconds.

A wheel brings it for all files of the package (`tools/build_hook.py`). In a clone, and of files
that were edited, it is read when it is wanted and kept in the cache, in one file for each reader.
It stays packed until it is asked for: a process needs a part of 200,000 names, which take 13 MiB.
"""

import json
import zlib
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

from eyas.lanes.container import packed, unpacked
from eyas.lanes.trusted import (
    cache_folder,
    made_folder,
    not_kept,
    read_trusted,
    secured,
    touch,
    write_trusted,
)

FOLDER = "definitions"  # Name of the folder in the cache

SUFFIX = ".eyi"

_MOST = 3000  # Texts that are kept, three times those of the package; the oldest go. They are 6 MB.

_Known = dict[str, bytes | memoryview]


def digest_of(text: str | bytes) -> str:
    """Return a digest of a text, 32 hexadecimal digits."""
    return sha256(text.encode() if isinstance(text, str) else text).hexdigest()[:32]


class TextIndex:
    """What a function reads from texts."""

    def __init__(self, source: Path, read: Callable[[bytes], object]) -> None:
        """Begin with what ships and what is kept.

        Args:
            source: The file of the function; what another version of it has read is passed over.
            read: The function; JSON must be able to hold what it returns.
        """
        self._source = source
        self._read = read
        self.shipped = source.with_suffix(SUFFIX)  # The file that comes with a wheel
        self._new: dict[str, bytes] = {}

    def of(self, text: bytes) -> Any:  # noqa: ANN401  # JSON
        """Return what is read from a text; what `read` raises passes through."""
        return json.loads(self.json_of(text))

    def json_of(self, text: bytes) -> bytes:
        """Return the same as JSON, which is the same wherever it comes from."""
        digest = digest_of(text)
        if digest in self._new:
            return self._new[digest]
        for known in (self._brought, self._kept):
            if digest in known:
                return zlib.decompress(known[digest])
        self._new[digest] = told = self._json_of(text)
        return told

    def keep(self) -> None:
        """Keep what was read since the last time, beside what other processes have kept."""
        if not self._new:
            return
        new = {digest: zlib.compress(told) for digest, told in self._new.items()}
        self._new = {}
        self._kept = dict([*{**self._in_cache(), **new}.items()][-_MOST:])
        try:
            made_folder(self._path.parent)
            secured(self._path.parent)
        except OSError as error:
            not_kept(error)
        else:
            write_trusted(self._path, [*self._kept], self._kept.values())

    def content(self, texts: Iterable[bytes]) -> bytes:
        """Return the content of the file that ships, for some texts."""
        found = {digest_of(text): self._json_of(text) for text in texts}
        names = sorted(found)
        return b"".join(packed([self._name, names], [zlib.compress(found[name]) for name in names]))

    def _json_of(self, text: bytes) -> bytes:
        # In the same order wherever it comes from: builds are digests of it.
        return json.dumps(self._read(text), separators=(",", ":"), sort_keys=True).encode()

    @cached_property
    def _name(self) -> str:
        # Earlier builds have kept it as it is, under a name without the word.
        return f"eyas-{digest_of(b'zlib' + self._source.read_bytes())}{SUFFIX}"

    @property
    def _path(self) -> Path:
        return cache_folder() / FOLDER / self._name

    @cached_property
    def _brought(self) -> _Known:
        """What came with the package; nothing if that is of another version of the function."""
        try:
            (name, digests), pieces = unpacked(self.shipped.read_bytes())
        except (OSError, TypeError, ValueError):
            return {}  # a clone
        return dict(zip(digests, pieces, strict=True)) if name == self._name else {}

    @cached_property
    def _kept(self) -> _Known:
        touch(self._path)
        return self._in_cache()

    def _in_cache(self) -> _Known:
        found = read_trusted(self._path)
        if found is None:
            with suppress(OSError):  # told once, if it is there
                self._path.unlink(missing_ok=True)
            return {}
        return dict(zip(found.header, found.pieces, strict=True))
