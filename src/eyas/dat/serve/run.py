"""Serve clients of the original, in the place of its simulator.

The settings are compared with those that clients read, and read anew when their file changes.
"""

import logging
import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eyas.dat.settings.adapter import original_key_of, save_original
from eyas.dat.settings.dialect import AGENT_STEPS, started_later
from eyas.dat.wire.config import WireConfig
from eyas.dat.wire.exchange import SETTINGS_FILE, ExchangeFolders
from eyas.dat.wire.server import Server, Service
from eyas.engine.core.clock import physics_steps
from eyas.engine.core.config import shown
from eyas.engine.core.errors import EyasError
from eyas.engine.core.files import refusals
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import originals_named
from eyas.engine.settings.file import read_settings
from eyas.engine.sim.serving import serve
from eyas.engine.world.maps import MAPS

if TYPE_CHECKING:
    from eyas.dat.wire.tracker_group import TrackerGroup

_LOG = logging.getLogger("eyas")

_CLIENT = Path("Alg_Base", "DAT_Benchmark", "config.json")

_SHARED = ("Tracker_Def", "Control_Frequence", "Train_Total_Steps", "Init_No_Done_Steps")
"""Keys of `env_config.json` that clients read."""

_ALIKE = {
    "port_process": "Config_Agen_Num_Port",
    "Control_Frequence": "Control_Frequence",
    "RewardParams": "Customized_Rewards",
    "CloudPoint": "Lidar_Enable",
}
"""Keys of the clients' `config.json`, and the keys of `env_config.json` that must be equal: with
others, a client is not heard, counts wrongly, or waits for ever."""


def tell_disagreements(
    config: EyasConfig,  # Settings of the server
    root: Path,  # Folder with the original's `Alg_Base`
    settings: Path,  # The `env_config.json` that clients read
) -> None:
    """Warn of each value in the clients' files that is not that of the server."""
    ours = _ours(config)
    for path, keys, group in (
        (settings, {key: key for key in _SHARED}, None),
        (root / _CLIENT, _ALIKE, "Benchmark"),
    ):
        for key, said, served in _disagreements(path, keys, group, ours):
            _LOG.warning(
                "%s: %s is %s, but is served as %s: clients that read this file go wrong",
                path,
                key,
                shown(said),
                shown(served),
            )


def _disagreements(
    path: Path, keys: dict[str, str], group: str | None, ours: dict[str, Any]
) -> Iterator[tuple[str, Any, Any]]:
    """Yield key, value in a file and value of the server, where they differ."""
    if not path.exists():
        return
    try:
        values = read_settings(path)
    except EyasError as error:
        _LOG.warning("%s; clients cannot read it either", error)
        return
    inside = values if group is None else values.get(group)
    for key, same in keys.items():
        if isinstance(inside, dict) and key in inside and inside[key] != ours[same]:
            yield key, inside[key], ours[same]


def _ours(config: EyasConfig) -> dict[str, Any]:
    """Return the values of the server by the original's keys."""
    wire, done = WireConfig.of(config), config.done
    return {
        "Tracker_Def": config.tracker.original_name,
        "Control_Frequence": config.control.frequency,
        "Train_Total_Steps": done.total_steps,
        "Init_No_Done_Steps": done.grace_steps,
        "Config_Agen_Num_Port": wire.port,
        "Customized_Rewards": wire.reward_packet,
        "Lidar_Enable": config.lidar.enabled,
    }


_TOLD = 8  # Largest number of differences in one line

Signature = tuple[int, int, int] | None


class SettingsSource:
    """Settings that are read anew when their file has changed."""

    def __init__(
        self,
        config: EyasConfig,
        path: Path | None = None,  # Their file; None: they never change
        load: Callable[[], EyasConfig] | None = None,  # Reads them again
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
            told = list(_changes(self._config, quietly(self._load)))
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


def _changes(old: EyasConfig, new: EyasConfig) -> Iterator[str]:
    """Yield what differs, by the original's keys where it has them."""
    before, now = (dict(_flat("", each.model_dump(mode="json"))) for each in (old, new))
    for path in before | now:
        if path != "original" and before.get(path) != now.get(path):
            key = original_key_of(path) or path
            yield f"{key} is {shown(now.get(path))} (was {shown(before.get(path))})"


def _flat(path: str, value: object) -> Iterator[tuple[str, Any]]:
    """Yield the fields of settings; what the original's file can tell is not taken apart."""
    if isinstance(value, dict) and not original_key_of(path) and path != "original":
        for name, inner in value.items():
            yield from _flat(f"{path}.{name}" if path else name, inner)
    else:
        yield path, value


def run(
    config: EyasConfig,
    root: Path,
    load: Callable[[], EyasConfig] | None = None,
    until_idle: float = math.inf,
) -> None:
    """Serve clients until the user stops it, or there is none for long.

    If `root` has no `env_config.json`, which clients read too, the settings are written there; an
    existing file is never changed.

    Args:
        root: Folder with the original's `Webots_Simulation` and `Alg_Base`.
        load: Reads the settings again where `env_config.json` holds them, as programs of clients
            change it before they announce themselves; None: they do not change.
        until_idle: Time without a client after which it ends [s].

    Raises:
        EyasError: Something cannot be built, read or written, or the folder or the port is in use.
        KeyboardInterrupt: The user stopped it.
    """
    exchange = ExchangeFolders(root)
    with originals_named(config):
        MAPS.get(config.world.map).light(config.world.weather)  # raises before anyone waits
        if not exchange.settings.exists():
            with refusals(exchange.settings):
                exchange.settings.parent.mkdir(parents=True, exist_ok=True)
            save_original(config, exchange.settings)
        tell_disagreements(config, root, exchange.settings)
        source = SettingsSource(config, exchange.settings if load else None, load)
        desk = _Desk(source, config, root)
        try:
            serve(Server(exchange, desk.ask, source.place), until_idle=until_idle)
        except KeyboardInterrupt as error:
            error.add_note("clients that still wait must be started again")
            raise


class _Desk:
    """Knows what to serve.

    Args:
        source: The settings, which may change.
        root: Folder with the original's files.
    """

    def __init__(self, source: SettingsSource, config: EyasConfig, root: Path) -> None:
        self._source, self._root = source, root
        self._config, self._service = config, _service(config)

    def ask(self) -> Service:
        """Return what to serve now; the same as before if the settings are."""
        new = self._source.read()
        if new != self._config:
            self._config, self._service = new, _service(new)
            tell_disagreements(new, self._root, self._root / SETTINGS_FILE)
        return self._service


def _service(config: EyasConfig) -> Service:
    return Service(
        WireConfig.of(config), config.tracker.original_name, partial(_crew, config), config.verbose
    )


def _crew(config: EyasConfig, count: int) -> "TrackerGroup":
    """Return the trackers of some agents."""
    # Slow to import, so only when the server listens.
    from eyas.dat.wire.tracker_group import TrackerGroup
    from eyas.engine.sim.build import build_simulation
    from eyas.engine.sim.worlds import together

    config = started_later(config, AGENT_STEPS * count)
    steps = physics_steps(config.control.frequency)
    with originals_named(config):
        return TrackerGroup(build_simulation(config, together(count)), steps)
