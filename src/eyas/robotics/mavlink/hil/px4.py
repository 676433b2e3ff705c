"""PX4's end for simulators: MAVLink over TCP, in lock-step.

As in PX4's src/modules/simulation/simulator_mavlink/SimulatorMavlink.cpp: PX4 connects to the
simulator, tells a `HEARTBEAT`, and takes its time from `HIL_SENSOR`. Once its outputs run it
answers each of them with `HIL_ACTUATOR_CONTROLS`, for which time waits here.
"""

import logging
import math
import select
import socket
import time
from typing import Any

from eyas.lanes import exact
from eyas.robotics.mavlink.dialect import Packer, StreamParser
from eyas.robotics.mavlink.hil.drone import DrivenDrone
from eyas.robotics.mavlink.hil.pace import Pace
from eyas.robotics.mavlink.telemetry import degrees_e7

__all__ = ["Px4"]

_LOG = logging.getLogger("eyas")

STEPS = 2
"""Physics steps between two `HIL_SENSOR`: PX4 wants them 250 times a second."""
_SLOW, _GPS = 5, 25
"""Steps of 4 ms between readings of compass and barometer, 50 Hz, and of the GPS, 10 Hz."""
_INERTIAL, _COMPASS, _BAROMETER = 0b111_111, 0b111_000_000, 0b1_1010_0000_0000
"""`fields_updated` as PX4 tells sensors apart (SimulatorMavlink.hpp, `SensorSource`)."""
_STANDARD_GRAVITY = 9.80665
_SETTLING = 0.1
"""How long answers are on the way at most [s]."""
_SILENCE = 10.0
"""After this time without an answer it is said that one is waited for [s]."""


class Px4:
    """Lets one PX4 after the other fly.

    Args:
        drone: What it flies.
        speed: See `HilConfig.speed`.
    """

    def __init__(self, drone: DrivenDrone, speed: float) -> None:
        self._drone, self._speed = drone, speed
        self._packer = Packer(1, 51)

    def serve(self, server: socket.socket) -> None:
        """Fly until the user stops it."""
        while True:
            try:
                connection, peer = server.accept()
            except ConnectionError:  # it had gone before it was let in
                continue
            _LOG.info("PX4 has connected from %s port %d", *peer[:2])
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._drone.begin()
            with connection:
                try:
                    self._fly(connection)
                except (OSError, EOFError):  # whatever has ended the connection
                    _LOG.info("PX4 has gone; waiting for another")

    def _fly(self, connection: socket.socket) -> None:
        """Fly until the connection ends.

        Raises:
            ConnectionError: It has ended.
            EOFError: It has been closed.
        """
        parser, pace = StreamParser(), Pace(self._speed)
        outputs, number = [0.0] * 16, 0
        lockstep = False
        while True:
            connection.sendall(b"".join(self._readings(number)))
            told = _outputs(connection, parser, wait=lockstep)
            if told is not None and not lockstep:
                # What it still answers to earlier readings must not be taken for later answers.
                time.sleep(_SETTLING)
                told = _outputs(connection, parser, wait=False) or told
                lockstep = True
            outputs = told or outputs
            self._drone.step(outputs, STEPS)
            number += 1
            # Until PX4's outputs run, time is the clock's: it starts its parts by it.
            pace.keep(self._drone.now, least=0.0 if lockstep else 1.0)

    def _readings(self, number: int) -> list[bytes]:
        """Return the packets of an instant, the `number`-th."""
        found = []
        if number % 250 == 0:
            found.append(self._packer.pack("heartbeat", **_HEARTBEAT))
        found.append(self._packer.pack("hil_state_quaternion", **self._state()))
        if number % _GPS == 0:
            found.append(self._packer.pack("hil_gps", **self._gps()))
        # The last: it is what lets PX4's time go on.
        found.append(self._packer.pack("hil_sensor", **self._sensor(number)))
        return found

    @property
    def _microseconds(self) -> int:
        """Time of PX4's clock, which must not be 0 [us]."""
        return self._drone.instant.microseconds + 4_000

    def _sensor(self, number: int) -> dict[str, Any]:
        at = self._drone.instant
        felt, turn = at.imu()
        parts = {"acc": felt, "gyro": turn, "mag": at.magnetic()}
        axes = {
            f"{axis}{name}": value
            for name, vector in parts.items()
            for axis, value in zip("xyz", vector, strict=True)
        }
        slow = _COMPASS | _BAROMETER if number % _SLOW == 0 else 0
        return {
            **{"time_usec": self._microseconds, **axes, "abs_pressure": at.pressure()},
            **{"diff_pressure": 0.0, "pressure_alt": at.global_place[2], "temperature": 15.0},
            **{"fields_updated": _INERTIAL | slow, "id": 0},
        }

    def _gps(self) -> dict[str, Any]:
        at = self._drone.instant
        place, velocity = at.gps()
        latitude, longitude, altitude = at.global_of(place)
        north, east, down = (round(100.0 * part) for part in velocity)
        course = math.degrees(float(exact.atan2(velocity[1], velocity[0]))) % 360.0
        speed = math.sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1])
        return {
            **{"time_usec": self._microseconds, "fix_type": 3},
            **{"lat": degrees_e7(latitude), "lon": degrees_e7(longitude)},
            **{"alt": round(altitude * 1e3), "eph": 90, "epv": 150, "satellites_visible": 16},
            **{"vel": min(round(100.0 * speed), 65_534), "vn": north, "ve": east, "vd": down},
            **{"cog": round(course * 100.0) % 36_000, "id": 0, "yaw": 0},
        }

    def _state(self) -> dict[str, Any]:
        """What is true, which PX4 only logs."""
        at = self._drone.instant
        latitude, longitude, altitude = at.global_place
        vx, vy, vz = (round(100.0 * part) for part in at.velocity)
        xacc, yacc, zacc = (round(part * 1e3 / _STANDARD_GRAVITY) for part in at.felt())
        roll, pitch, yaw = at.rates
        return {
            **{"time_usec": self._microseconds, "attitude_quaternion": at.attitude},
            **{"rollspeed": roll, "pitchspeed": pitch, "yawspeed": yaw},
            **{"lat": degrees_e7(latitude), "lon": degrees_e7(longitude)},
            **{"alt": round(altitude * 1e3), "vx": vx, "vy": vy, "vz": vz},
            **{"ind_airspeed": 0, "true_airspeed": 0, "xacc": xacc, "yacc": yacc, "zacc": zacc},
        }


_HEARTBEAT = {
    **{"type": 0, "autopilot": 8, "base_mode": 0, "custom_mode": 0},
    **{"system_status": 0, "mavlink_version": 3},
}


def _outputs(connection: socket.socket, parser: StreamParser, *, wait: bool) -> list[float] | None:
    """Return the newest outputs that have come; if `wait`, some must come.

    Raises:
        EOFError: The connection has been closed.
    """
    found: list[float] | None = None
    since, told = time.monotonic(), False
    while True:
        patience = 0.5 if wait and found is None else 0.0
        if not select.select([connection], [], [], patience)[0]:
            if patience == 0.0:
                return found
            if not told and time.monotonic() - since > _SILENCE:
                told = True
                _LOG.warning("PX4 has not answered for %g s; time waits for it", _SILENCE)
            continue
        data = connection.recv(65_535)
        if not data:
            raise EOFError
        for message in parser.messages(data):
            if message.get_type() == "HIL_ACTUATOR_CONTROLS":
                found = list(message.controls)
