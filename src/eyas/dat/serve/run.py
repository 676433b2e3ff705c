"""Serve clients of the original, in the place of its simulator."""

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from eyas.dat.serve.agreement import tell_disagreements
from eyas.dat.serve.source import SettingsSource
from eyas.dat.settings.adapter import save_legacy
from eyas.dat.settings.start_time import AGENT_STEPS, started_later
from eyas.dat.wire.config import WireConfig
from eyas.dat.wire.exchange import SETTINGS_FILE, Exchange
from eyas.dat.wire.server import Server, Service
from eyas.engine.core.clock import physics_steps
from eyas.engine.core.files import refusals
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import originals_named
from eyas.engine.sim.serving import serve
from eyas.engine.world.maps import MAPS

if TYPE_CHECKING:
    from eyas.dat.wire.tracker_group import TrackerGroup

__all__ = ["run"]


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
        config: The settings.
        root: Folder with the original's `Webots_Simulation` and `Alg_Base`.
        load: Reads the settings again where `env_config.json` holds them, as programs of clients
            change it before they announce themselves; None: they do not change.
        until_idle: Time without a client after which it ends [s].

    Raises:
        EyasError: Something cannot be built, read or written, or the folder or the port is in use.
        KeyboardInterrupt: The user stopped it.
    """
    exchange = Exchange(root)
    with originals_named(config):
        MAPS.get(config.world.map).light(config.world.weather)  # raises before anyone waits
        if not exchange.settings.exists():
            with refusals(exchange.settings):
                exchange.settings.parent.mkdir(parents=True, exist_ok=True)
            save_legacy(config, exchange.settings)
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
        config: The settings as they are.
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
