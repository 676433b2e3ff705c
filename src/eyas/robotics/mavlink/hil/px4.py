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
from collections.abc import Iterable
from typing import Any

from eyas.engine.sim.serving import Orders
from eyas.lanes import exact
from eyas.robotics.mavlink.endpoint import Packer, StreamParser
from eyas.robotics.mavlink.hil.drone import DrivenDrone, ExternalAutopilot
from eyas.robotics.mavlink.telemetry import degrees_e7

_LOG = logging.getLogger("eyas")

STEPS = 2  # Physics steps between two `HIL_SENSOR`: PX4 wants them 250 times a second
_SLOW, _GPS = 5, 25
"""Steps of 4 ms between readings of compass and barometer, 50 Hz, and of the GPS, 10 Hz."""
_INERTIAL, _COMPASS, _BAROMETER = 0b111_111, 0b111_000_000, 0b1_1010_0000_0000
"""`fields_updated` as PX4 tells sensors apart (SimulatorMavlink.hpp, `SensorSource`)."""
_STANDARD_GRAVITY = 9.80665
_SETTLING = 0.1  # Longest delay of an answer [s]
_SILENCE = 10.0  # After this time without an answer it is said that one is waited for [s]


class Px4(ExternalAutopilot):
    """Lets one PX4 after the other fly."""

    def __init__(
        self,
        drone: DrivenDrone,  # What it flies
        speed: float,  # See `HilConfig.speed`
        server: socket.socket,  # Where it connects
    ) -> None:
        super().__init__(drone, speed)
        self._server, self._packer = server, Packer(1, 51)
        self._connection: socket.socket | None = None
        self._parser, self._number = StreamParser(), 0
        self._outputs = [0.0] * 16
        self._newest: list[float] | None = None  # outputs that no step has used yet
        self._lockstep = False  # whether PX4's outputs run
        self._silent = False  # whether its silence has been reported

    @property
    def speed(self) -> float:
        """Factor on the clock's speed; 1 until PX4 sends outputs: it starts by the clock."""
        return self._speed or (0.0 if self._lockstep else 1.0)

    def receive(self, wait: float) -> Iterable[tuple[str, Any]]:
        """Return what comes within a time [s], if PX4 has connected; else wait for it."""
        if self._connection is None:
            self._accept(wait)
        elif select.select([self._connection], [], [], wait)[0]:
            try:
                data = self._connection.recv(65_535)
            except OSError:  # whatever has ended the connection
                data = b""
            if data:
                return [(m.get_type(), m) for m in self._parser.messages(data)]
            self._hang_up()
        return []

    def take(self, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        """Keep the newest outputs."""
        if message.get_type() == "HIL_ACTUATOR_CONTROLS":
            self._newest = list(message.controls)

    def orders(self) -> Orders | None:
        """Return PX4's outputs; once they run, time waits for them."""
        if self._newest is not None and not self._lockstep:
            # What it still answers to earlier readings must not be taken for later answers.
            time.sleep(_SETTLING)
            while found := self.receive(0.0):
                for _, message in found:
                    self.take(message)
            self._lockstep = True
        if self._connection is None or (self._lockstep and self._newest is None):
            return None
        self._outputs, self._newest = self._newest or self._outputs, None
        return self._drone.orders(self._outputs, STEPS)

    def answer(self, *, late: bool) -> None:
        """Send the readings of now."""
        self._drone.sense(STEPS)
        self._number += 1
        self._silent = False
        self._send()

    def idle(self, stood: float) -> None:
        """Report a PX4 that does not answer, once."""
        if self._connection is not None and stood > _SILENCE and not self._silent:
            self._silent = True
            _LOG.warning("PX4 has not answered for %g s; time waits for it", _SILENCE)

    def close(self) -> None:
        """End the connection, and the video."""
        if self._connection is not None:
            self._connection.close()
        super().close()

    def _accept(self, wait: float) -> None:
        self._server.settimeout(wait)
        try:
            connection, peer = self._server.accept()
        except (BlockingIOError, TimeoutError, ConnectionError):
            return  # of the last: it had gone before it was let in
        _LOG.info("PX4 has connected from %s port %d", *peer[:2])
        connection.settimeout(None)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._drone.begin()
        self._connection, self._parser = connection, StreamParser()
        self._outputs, self._newest = [0.0] * 16, None
        self._number, self._lockstep, self._silent = 0, False, False
        self._send()

    def _send(self) -> None:
        if self._connection is None:
            return
        try:
            self._connection.sendall(b"".join(self._readings(self._number)))
        except OSError:
            self._hang_up()

    def _hang_up(self) -> None:
        if self._connection is not None:
            self._connection.close()
        self._connection = None
        _LOG.info("PX4 has gone; waiting for another")

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
