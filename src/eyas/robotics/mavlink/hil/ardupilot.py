"""ArduPilot's end for simulators: servo outputs in, sensors as a line of JSON out, over UDP.

As in ArduPilot's libraries/SITL/examples/JSON/readme.md and libraries/SITL/SIM_JSON.h. ArduPilot
waits for an answer to each packet, so that both are in lock-step.
"""

import json
import logging
import math
import socket
import struct
from collections.abc import Iterable
from contextlib import suppress
from typing import Any, NamedTuple

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.sim.serving import Orders
from eyas.robotics.mavlink.hil.drone import DrivenDrone, ExternalAutopilot

_LOG = logging.getLogger("eyas")

_FORMS = {18_458: struct.Struct("<HHI16H"), 29_569: struct.Struct("<HHI32H")}
"""Packets by their first number: magic, frame rate, frame count, pulse widths."""
_RATES = (25, PHYSICS_RATE)  # Rates that can be had [Hz]; others are taken for the nearest
_FAR = 1e3  # What the rangefinder reads where no ground is in sight [m]


class Servos(NamedTuple):
    """A packet of ArduPilot."""

    rate: int  # Frames a second that it wants [Hz]
    frame: int  # Number of the frame; again from 0 when ArduPilot has started anew
    outputs: tuple[float, ...]  # Output of each channel: 0 at 1000 us or less, 1 at 2000 us


def servos_of(packet: bytes) -> Servos | None:
    """Return what a packet holds; None if it is none of ArduPilot's."""
    magic = int.from_bytes(packet[:2], "little")
    form = _FORMS.get(magic)
    if form is None or len(packet) != form.size:
        return None
    _, rate, frame, *widths = form.unpack(packet)
    outputs = (min(max((width - 1000) / 1000.0, 0.0), 1.0) for width in widths)
    return Servos(rate, frame, tuple(outputs))


class ArduPilot(ExternalAutopilot):
    """Lets one ArduPilot fly; one that starts anew begins anew."""

    def __init__(
        self,
        drone: DrivenDrone,  # What it flies
        speed: float,  # See `HilConfig.speed`
        heard: socket.socket,  # Where its packets come
    ) -> None:
        super().__init__(drone, speed)
        self._socket = heard
        self._asked: tuple[Servos, Any] | None = None  # the packet to be answered, and from where
        self._frame: int | None = None
        self._steps = 0

    def receive(self, wait: float) -> Iterable[tuple[str, Any]]:
        """Return the packet that comes within a time [s], with its sender."""
        self._socket.settimeout(wait)
        try:
            packet, peer = self._socket.recvfrom(65_535)
        except (BlockingIOError, TimeoutError, ConnectionError):
            return []  # of the last, some systems tell so that nobody hears what was sent
        return [(f"packet from {peer[0]}", (packet, peer))]

    def take(self, message: tuple[bytes, Any]) -> None:
        """Note what is asked for; for a packet that comes again, time stands still."""
        packet, peer = message
        servos = servos_of(packet)
        if servos is None:
            return
        if self._frame is None or servos.frame < self._frame:
            _LOG.info("ArduPilot has started")
            self._drone.begin()
            self._frame = None
        self._asked = servos, peer

    def orders(self) -> Orders | None:
        """Return what the last packet asks for."""
        if self._asked is None:
            return None
        servos, _ = self._asked
        rate = min(max(servos.rate, _RATES[0]), _RATES[1])
        self._steps = round(PHYSICS_RATE / rate) if servos.frame != self._frame else 0
        self._frame = servos.frame
        return self._drone.orders(servos.outputs, self._steps)

    def answer(self, *, late: bool) -> None:
        """Send what is sensed now."""
        assert self._asked is not None  # there were orders
        (_, peer), self._asked = self._asked, None
        if self._steps:
            self._drone.sense(self._steps)
        # Its reader wants no spaces behind colons, and a line between line feeds.
        line = b"\n" + json.dumps(self._told(), separators=(",", ":")).encode() + b"\n"
        with suppress(OSError):  # it came from where nobody can be answered: port 0
            self._socket.sendto(line, peer)

    def _told(self) -> dict[str, Any]:
        at = self._drone.instant
        felt, turn = at.imu()
        _, x, y, _ = at.attitude
        upright = 1.0 - 2.0 * (x * x + y * y)
        reach = self._drone.height() / upright if upright > 0.1 else _FAR
        return {
            "timestamp": self._drone.now,
            "imu": {"gyro": turn, "accel_body": felt},
            "position": at.local,
            "attitude": at.angles,
            "quaternion": at.attitude,
            "velocity": at.velocity,
            "rng_1": min(reach, _FAR) if math.isfinite(reach) else _FAR,
        }
