"""Serve trackers as vehicles of MAVLink."""

import logging
from collections.abc import Sequence
from contextlib import ExitStack

from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.serving import serve
from eyas.engine.world.maps import MAPS
from eyas.robotics.mavlink.config import MavlinkConfig
from eyas.robotics.mavlink.endpoint import Endpoint, dialect

_LOG = logging.getLogger("eyas")

AS_FLOWN = updated(
    EyasConfig(),
    {
        "tracker": {"supervised": False, "ground_contact": True},
        "control": {"frequency": 100},
        "camera": {"width": 640, "height": 360},
    },
)
"""Settings of `eyas serve --mavlink` without a file: a flight controller flies the drone, which can
stand on the ground."""


def run(config: EyasConfig, addresses: Sequence[str]) -> None:
    """Fly vehicles until the user stops it.

    Args:
        addresses: Where to send and to listen, see `Endpoint`.

    Raises:
        EyasError: An address or a setting cannot be used, or pymavlink is missing.
        KeyboardInterrupt: The user stopped it.
    """
    dialect()
    MAPS.get(config.world.map).light(config.world.weather)  # raises before anything is built
    config = updated(config, {"start": {"velocity": "rest"}})
    with ExitStack() as stack:
        endpoints = [Endpoint(address) for address in addresses]
        for endpoint in endpoints:
            stack.callback(endpoint.close)

        # Slow to import, so only when all else is right.
        from eyas.engine.sim.build import build_simulation
        from eyas.engine.sim.worlds import together
        from eyas.robotics.mavlink.fleet import Fleet
        from eyas.robotics.mavlink.readings import equipped

        settings = MavlinkConfig.of(config)
        config = equipped(config, settings)
        fleet = Fleet(build_simulation(config, together(settings.vehicles)), settings, endpoints)
        _LOG.info("flying %s: %s", _named(settings), ", ".join(addresses))
        serve(fleet)


def _named(settings: MavlinkConfig) -> str:
    first, count = settings.first_system, settings.vehicles
    if count == 1:
        return f"a vehicle of system id {first}"
    return f"{count} vehicles of system ids {first} to {first + count - 1}"
