"""Serve clients of the original, in the place of its simulator."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from eyas.core.clock import physics_steps
from eyas.core.files import refusals
from eyas.modes.serve.agreement import tell_disagreements
from eyas.settings.config import EyasConfig
from eyas.settings.legacy.adapter import save_legacy
from eyas.settings.legacy.messages import originals_named
from eyas.wire.exchange import Exchange
from eyas.wire.server import Server
from eyas.world.maps import MAPS

if TYPE_CHECKING:
    from eyas.wire.crew import Crew

__all__ = ["run"]


def run(config: EyasConfig, root: Path) -> None:
    """Serve clients until the user stops it.

    If `root` has no `env_config.json`, which clients read too, the settings are written there; an
    existing file is never changed.

    Args:
        config: The settings.
        root: Folder with the original's `Webots_Simulation` and `Alg_Base`.

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
        tracker = config.tracker.original_name
        crew = partial(_crew, config)
        server = Server(config.wire, exchange, tracker, crew, verbose=config.verbose)
        try:
            server.run()
        except KeyboardInterrupt as error:
            error.add_note("clients that still wait must be started again")
            raise


def _crew(config: EyasConfig, count: int) -> "Crew":
    """Return the trackers of some agents."""
    # Slow to import, so only when the server listens.
    from eyas.sim.build import build_simulation
    from eyas.sim.worlds import together
    from eyas.wire.crew import Crew

    steps = physics_steps(config.control.frequency)
    return Crew(build_simulation(config, together(count)), steps)
