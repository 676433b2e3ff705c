"""ArduPilot's end for simulators: servo outputs in, sensors as a line of JSON out, over UDP.

As in ArduPilot's libraries/SITL/examples/JSON/readme.md and libraries/SITL/SIM_JSON.h. ArduPilot
waits for an answer to each packet, so that both are in lock-step.
"""

import json
import logging
import math
import socket
import struct
from contextlib import suppress
from typing import Any, NamedTuple

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.faults import FaultLog
from eyas.robotics.mavlink.hil.drone import DrivenDrone
from eyas.robotics.mavlink.hil.pace import Pace

__all__ = ["ArduPilot", "Servos", "servos_of"]

_LOG = logging.getLogger("eyas")

_FORMS = {18_458: struct.Struct("<HHI16H"), 29_569: struct.Struct("<HHI32H")}
"""Packets by their first number: magic, frame rate, frame count, pulse widths."""
_RATES = (25, PHYSICS_RATE)
"""Rates that can be had [Hz]; others are taken for the nearest."""
_FAR = 1e3
"""What the rangefinder reads where no ground is in sight [m]."""


class Servos(NamedTuple):
    """A packet of ArduPilot."""

    rate: int
    """Frames a second that it wants [Hz]."""
    frame: int
    """Number of the frame; again from 0 when ArduPilot has started anew."""
    outputs: tuple[float, ...]
    """Of each channel: 0 at 1000 us or less, 1 at 2000 us."""


def servos_of(packet: bytes) -> Servos | None:
    """Return what a packet holds; None if it is none of ArduPilot's."""
    magic = int.from_bytes(packet[:2], "little")
    form = _FORMS.get(magic)
    if form is None or len(packet) != form.size:
        return None
    _, rate, frame, *widths = form.unpack(packet)
    outputs = (min(max((width - 1000) / 1000.0, 0.0), 1.0) for width in widths)
    return Servos(rate, frame, tuple(outputs))


class ArduPilot:
    """Lets one ArduPilot fly; one that starts anew begins anew.

    Args:
        drone: What it flies.
        speed: See `HilConfig.speed`.
    """

    def __init__(self, drone: DrivenDrone, speed: float) -> None:
        self._drone, self._pace, self._speed = drone, Pace(speed), speed
        self._frame: int | None = None

    def serve(self, heard: socket.socket) -> None:
        """Fly until the user stops it."""
        faults = FaultLog()
        while True:
            try:
                packet, peer = heard.recvfrom(65_535)
            except ConnectionError:  # some systems tell so that nobody hears what was sent
                continue
            with faults.guard(f"packet from {peer[0]}"):
                servos = servos_of(packet)
                if servos is None:
                    continue
                answer = self.answer(servos)
                with suppress(OSError):  # it came from where nobody can be answered: port 0
                    heard.sendto(answer, peer)

    def answer(self, servos: Servos) -> bytes:
        """Fly for a frame, and return what is sensed then; for a packet that comes again, time
        stands still.
        """
        if self._frame is None or servos.frame < self._frame:
            _LOG.info("ArduPilot has started")
            self._drone.begin()
            self._pace = Pace(self._speed)
        if servos.frame != self._frame:
            rate = min(max(servos.rate, _RATES[0]), _RATES[1])
            self._drone.step(servos.outputs, round(PHYSICS_RATE / rate))
            self._pace.keep(self._drone.now)
        self._frame = servos.frame
        # Its reader wants no spaces behind colons, and a line between line feeds.
        return b"\n" + json.dumps(self._told(), separators=(",", ":")).encode() + b"\n"

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
