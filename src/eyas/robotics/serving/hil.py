"""Serve a drone to PX4 or ArduPilot, which fly it."""

import logging
import socket
from contextlib import ExitStack

from eyas.engine.core.addresses import parsed_address
from eyas.engine.core.config import shown, updated
from eyas.engine.core.errors import ConfigError, OutputError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.serving import serve
from eyas.engine.trackers.config import TrackerConfig, TrackerKind
from eyas.engine.world.maps import MAPS
from eyas.robotics.mavlink.config import MavlinkConfig
from eyas.robotics.mavlink.endpoint import dialect


def listening(text: str) -> socket.socket:
    """Return a socket that listens on `HOST:PORT`.

    Raises:
        ConfigError: It is of another form, or there is no such host.
        OutputError: The port is not free.
    """
    host, port = parsed_address(text, "--px4")
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family, backlog=1)
    except (socket.gaierror, UnicodeError) as error:
        raise ConfigError(f"--px4: {host!r} is not a network address: {error}") from None
    except OSError as error:
        raise OutputError(f"--px4 {text}: cannot listen: {error.strerror}") from None


def bound(text: str) -> socket.socket:
    """Return a socket that hears what comes to `HOST:PORT`.

    Raises:
        ConfigError: It is of another form, or there is no such host.
        OutputError: The port is not free.
    """
    host, port = parsed_address(text, "--ardupilot")
    try:
        family, _, _, _, place = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
    except (socket.gaierror, UnicodeError) as error:
        raise ConfigError(f"--ardupilot: {host!r} is not a network address: {error}") from None
    made = socket.socket(family, socket.SOCK_DGRAM)
    try:
        made.bind(place)
    except OSError as error:
        made.close()
        raise OutputError(f"--ardupilot {text}: cannot listen: {error.strerror}") from None
    return made


_TAKEN = {
    "kind", "supervised", "flight", "judged", "inertial_time_constant", "motor_time_constant",
    "drag_area", "ground_contact", "wind",
}  # fmt: skip
"""Settings of the tracker that hold for a driven drone, or do nothing to any flown one."""

_ALWAYS = {"start": {"velocity": "rest"}, "tracker": {"ground_contact": True}}
"""It begins on the ground, through which its body would fall while no rotor turns."""

_LOG = logging.getLogger("eyas")


def run(config: EyasConfig, *, px4: str | None = None, ardupilot: str | None = None) -> None:
    """Let an autopilot fly until the user stops it.

    Args:
        px4: Address on which PX4 is waited for, `HOST:PORT`.
        ardupilot: The same for ArduPilot; one of both is given.

    Raises:
        EyasError: An address or a setting cannot be used, or pymavlink is missing.
        KeyboardInterrupt: The user stopped it.
    """
    _check_tracker(config.tracker)
    if px4:
        dialect()
    MAPS.get(config.world.map).light(config.world.weather)  # raises before anything is built
    config = updated(config, _ALWAYS)
    with ExitStack() as stack:
        address = px4 or ardupilot or ""
        heard = stack.enter_context(listening(address) if px4 else bound(address))

        # Slow to import, so only when all else is right.
        from eyas.engine.sim.build import build_simulation, in_one_wind
        from eyas.engine.sim.worlds import together
        from eyas.engine.trackers.driven import driven_drone
        from eyas.robotics.mavlink.hil.ardupilot import ArduPilot
        from eyas.robotics.mavlink.hil.drone import DrivenDrone
        from eyas.robotics.mavlink.hil.px4 import Px4
        from eyas.robotics.mavlink.readings import equipped

        tracker = driven_drone(in_one_wind(config))
        config = equipped(config, MavlinkConfig.of(config), noisy=True)
        simulation = build_simulation(config, together(1), tracker=tracker)
        drone = DrivenDrone(simulation, MavlinkConfig.of(config))
        latitude, longitude, altitude = drone.home()
        place = f"{latitude:.7f},{longitude:.7f},{altitude:.1f},90"
        if px4:
            _LOG.info("waiting for PX4 on TCP %s; it stands at %s", address, place)
            serve(Px4(drone, MavlinkConfig.of(config).hil.speed, heard))
        else:
            _LOG.info("waiting for ArduPilot on UDP %s; start it with --home=%s", address, place)
            serve(ArduPilot(drone, MavlinkConfig.of(config).hil.speed, heard))


def _check_tracker(config: TrackerConfig) -> None:
    """Refuse a tracker without rotors, and what a driven drone does not have."""
    if config.supervised or config.kind is not TrackerKind.DRONE:
        raise ConfigError(
            "tracker: a supervised drone, a car or a tracker of one's own has no rotors that "
            "an autopilot could turn; allowed: tracker.kind 'drone' with tracker.supervised false"
        )
    if config.wind.buildings:
        raise ConfigError("tracker.wind.buildings: true is not allowed with --px4 or --ardupilot")
    usual = TrackerConfig()
    for name in sorted(TrackerConfig.model_fields.keys() - _TAKEN):
        if getattr(config, name) != getattr(usual, name):
            raise ConfigError(
                f"tracker.{name}: {shown(getattr(config, name))} is not allowed with --px4 or "
                f"--ardupilot; allowed: {shown(getattr(usual, name))}"
            )
