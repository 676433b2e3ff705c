"""Where autopilots are waited for."""

import socket

from eyas.engine.core.errors import ConfigError, OutputError
from eyas.robotics.mavlink.endpoint import parsed_address

__all__ = ["bound", "listening"]


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
