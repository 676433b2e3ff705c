"""The settings of a server, whose file its clients' programs may change before each training."""

import logging
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from eyas.dat.settings.adapter import legacy_key_of
from eyas.dat.wire.config import WireConfig
from eyas.engine.core.config import shown
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.config import EyasConfig

__all__ = ["SettingsSource", "quietly"]

_LOG = logging.getLogger("eyas")

_TOLD = 8  # Largest number of differences in one line

Signature = tuple[int, int, int] | None


class SettingsSource:
    """Settings that are read anew when their file has changed.

    Args:
        config: The settings as they are now.
        path: Their file; None: they never change.
        load: Reads them again.
    """

    def __init__(
        self,
        config: EyasConfig,
        path: Path | None = None,
        load: Callable[[], EyasConfig] | None = None,
    ) -> None:
        self._config = config
        self._path, self._load = path, load
        # The file may have changed since it was read.
        self._seen: Signature = None
        self._peeked: Signature = None
        self._place = (WireConfig.of(config).address, WireConfig.of(config).port)

    def read(self) -> EyasConfig:
        """Return the settings as they are now, and tell in a line how they differ from the last.

        A file that cannot be read is told too, and the last settings hold.
        """
        signature = self._signature()
        if self._load is None or signature == self._seen:
            return self._config
        self._seen = signature
        try:
            told = list(_differences(self._config, quietly(self._load)))
            if told:
                more = f" and {len(told) - _TOLD} more" if len(told) > _TOLD else ""
                _LOG.info("%s has changed: %s%s", self._path, ", ".join(told[:_TOLD]), more)
                self._config = self._load()  # with what it warns of
        except EyasError as error:
            _LOG.warning("%s; the settings read before still hold", error)
        return self._config

    def place(self) -> tuple[str, int]:
        """Return the address and port to listen on now; silent, as it is asked all the time."""
        signature = self._signature()
        if self._load is not None and signature != self._peeked:
            with suppress(EyasError):  # written just now; told when agents announce themselves
                wire = WireConfig.of(quietly(self._load))
                self._place, self._peeked = (wire.address, wire.port), signature
        return self._place

    def _signature(self) -> Signature:
        if self._path is None:
            return None
        try:
            found = self._path.stat()
        except OSError:
            return None
        return found.st_mtime_ns, found.st_size, found.st_ino


def quietly(load: Callable[[], EyasConfig]) -> EyasConfig:
    """Return settings without what loading them warns of."""
    before, _LOG.disabled = _LOG.disabled, True
    try:
        return load()
    finally:
        _LOG.disabled = before


def _differences(old: EyasConfig, new: EyasConfig) -> Iterator[str]:
    """Yield what differs, by the original's keys where it has them."""
    before, now = (dict(_flat("", each.model_dump(mode="json"))) for each in (old, new))
    for path in before | now:
        if path != "original" and before.get(path) != now.get(path):
            key = legacy_key_of(path) or path
            yield f"{key} is {shown(now.get(path))} (was {shown(before.get(path))})"


def _flat(path: str, value: object) -> Iterator[tuple[str, Any]]:
    """Yield the fields of settings; what the original's file can tell is not taken apart."""
    if isinstance(value, dict) and not legacy_key_of(path) and path != "original":
        for name, inner in value.items():
            yield from _flat(f"{path}.{name}" if path else name, inner)
    else:
        yield path, value
