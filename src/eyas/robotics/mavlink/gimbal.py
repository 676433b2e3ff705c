"""The gimbal: its manager, which is a part of the autopilot, and the gimbal device.

As in MAVLink's gimbal protocol v2. Angles are those of MAVLink: pitch up, yaw clockwise.
"""

import math
from collections.abc import Callable
from typing import Any

from eyas.lanes import exact
from eyas.robotics.mavlink.component import Command, Component, Fields, Result
from eyas.robotics.mavlink.frames import Vector, camera_angles, of_angles, on_earth, usable, wrapped
from eyas.robotics.mavlink.readings import Instant

DEVICE = 154  # Component id of the gimbal

_PITCH = (-1.5, 0.5)  # Limits of the pitch [rad]
_YAW = (-1.7, 1.7)  # Limits of the yaw from the vehicle's heading [rad]
_LOCK, _NEUTRAL, _RETRACT = 16, 2, 1
_LEVEL = 4 | 8  # Roll and pitch are always those against the horizon
_IN_VEHICLE_FRAME, _IN_EARTH_FRAME = 32, 64
_CAN = 0x1 | 0x2 | 0x20 | 0x80 | 0x100 | 0x200 | 0x400 | 0x1000 | 0x20000
"""Retract, neutral; pitch: axis, lock; yaw: axis, follow, lock, in earth frame; look at places."""
_LEAVE, _SELF, _NOBODY = -1, -2, -3


class Gimbal:
    """Turns the camera of one vehicle.

    Attributes:
        pitch: Commanded pitch up [rad].
        device: The component of the gimbal itself.
    """

    def __init__(
        self,
        manager: Component,
        device: Component,  # As above
        now: Callable[[], Instant],  # Returns the present instant
        pitch: float,  # As above, at the beginning
    ) -> None:
        self._manager, self.device, self._now = manager, device, now
        self.pitch, self._yaw, self._locked = pitch, 0.0, False
        self._rates = (0.0, 0.0)
        self._look: Vector | None = None
        self._pilot = (0, 0)
        manager.producers["gimbal_manager_information"] = lambda: (self._information(),)
        manager.producers["gimbal_manager_status"] = lambda: (self._status(),)
        manager.stream("gimbal_manager_status", 5.0)
        manager.answers.update(
            {
                "DO_GIMBAL_MANAGER_PITCHYAW": self._turn,
                "DO_GIMBAL_MANAGER_CONFIGURE": self._configure,
                "DO_SET_ROI_LOCATION": self._look_at,
                "DO_SET_ROI_NONE": self._look_at_nothing,
            }
        )
        manager.handlers.update(
            {
                "GIMBAL_MANAGER_SET_PITCHYAW": self._hear_pitch_yaw,
                "GIMBAL_MANAGER_SET_ATTITUDE": self._hear_attitude,
            }
        )
        device.producers["heartbeat"] = lambda: (self._heartbeat(),)
        device.producers["gimbal_device_information"] = lambda: (self._device_information(),)
        device.producers["gimbal_device_attitude_status"] = lambda: (self._attitude(),)
        device.stream("heartbeat", 1.0)
        device.stream("gimbal_device_attitude_status", 20.0)

    def aim(self, dt: float) -> tuple[float, float]:
        """Return the pitch, positive down, and the yaw to the left of the body [rad] to command.

        Args:
            dt: Time since the last call [s].
        """
        self.pitch += self._rates[0] * dt
        self._yaw += self._rates[1] * dt
        heading = self._now().angles[2]
        if self._look is not None:
            self._face(self._look)
        self.pitch = min(max(self.pitch, _PITCH[0]), _PITCH[1])
        yaw = wrapped(self._yaw - heading) if self._locked else self._yaw
        yaw = min(max(yaw, _YAW[0]), _YAW[1])
        if not self._locked:
            self._yaw = yaw
        return -self.pitch, -yaw

    def _face(self, place: Vector) -> None:
        """Point at a place of the world."""
        east, north, up = (
            to - at for to, at in zip(place, self._now().camera()[0].tolist(), strict=True)
        )
        self.pitch = float(exact.atan2(up, exact.hypot(east, north)))
        self._yaw, self._locked = float(exact.atan2(east, north)), True

    def _command(self, flags: int, angles: tuple[float, float], rates: tuple[float, float]) -> None:
        """Take angles or rates; those that are no numbers are left free."""
        self._look = None
        locked = bool(flags & (_LOCK | _IN_EARTH_FRAME)) and not flags & _IN_VEHICLE_FRAME
        if locked != self._locked:
            heading = self._now().angles[2]
            self._yaw = wrapped(self._yaw + (heading if locked else -heading))
        self._locked = locked
        if flags & (_NEUTRAL | _RETRACT):
            angles, rates, self._locked = (0.0, 0.0), (0.0, 0.0), False
        if usable(angles[0]):
            self.pitch = angles[0]
        if usable(angles[1]):
            self._yaw = angles[1]
        finite = [rate if usable(rate) else 0.0 for rate in rates]
        self._rates = (
            0.0 if usable(angles[0]) else finite[0],
            0.0 if usable(angles[1]) else finite[1],
        )

    def _in_control(self, sender: tuple[int, int]) -> bool:
        """Return whether someone may turn it: who has taken it, or anyone if nobody has."""
        return self._pilot in ((0, 0), sender)

    def _turn(self, command: Command) -> Result:
        if not self._in_control(command.sender):
            return Result.DENIED
        pitch, yaw, pitch_rate, yaw_rate = (math.radians(part) for part in command.p[:4])
        flags = int(command.p[4]) if math.isfinite(command.p[4]) else 0
        self._command(flags, (pitch, yaw), (pitch_rate, yaw_rate))
        return Result.ACCEPTED

    def _configure(self, command: Command) -> Result:
        """Let someone take the gimbal, or give it back."""
        wanted = [int(part) if math.isfinite(part) else _LEAVE for part in command.p[:2]]
        if _SELF in wanted:
            self._pilot = command.sender
        elif _NOBODY in wanted or wanted == [0, 0]:
            if not self._in_control(command.sender):
                return Result.DENIED
            self._pilot = (0, 0)
        elif _LEAVE not in wanted:
            self._pilot = wanted[0] & 255, wanted[1] & 255
        return Result.ACCEPTED

    def _look_at(self, command: Command) -> Result:
        """Keep looking at a place on the earth.

        Its altitude is above the sea in any frame: so PX4 takes it, and so MAVSDK means it, which
        names another frame.
        """
        if not self._in_control(command.sender):
            return Result.DENIED
        latitude, longitude, altitude = command.p[4:7]
        if not on_earth(latitude, longitude, altitude):
            return Result.DENIED
        self._look = self._now().place_of(latitude, longitude, altitude, relative=False)
        self._rates = (0.0, 0.0)
        return Result.ACCEPTED

    def _look_at_nothing(self, command: Command) -> Result:
        if not self._in_control(command.sender):
            return Result.DENIED
        self._command(_NEUTRAL, (0.0, 0.0), (0.0, 0.0))
        return Result.ACCEPTED

    def _hear_pitch_yaw(self, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        if self._in_control((message.get_srcSystem(), message.get_srcComponent())):
            rates = (message.pitch_rate, message.yaw_rate)
            self._command(message.flags, (message.pitch, message.yaw), rates)

    def _hear_attitude(self, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        if not self._in_control((message.get_srcSystem(), message.get_srcComponent())):
            return
        w, x, y, z = message.q
        angles = (math.nan, math.nan)
        if all(math.isfinite(part) for part in message.q):
            sine = min(max(2.0 * (w * y - z * x), -1.0), 1.0)
            yaw = exact.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
            angles = float(exact.asin(sine)), float(yaw)
        rates = (message.angular_velocity_y, message.angular_velocity_z)
        self._command(message.flags, angles, rates)

    def _flags(self) -> int:
        return _LEVEL | (_LOCK | _IN_EARTH_FRAME if self._locked else _IN_VEHICLE_FRAME)

    def _limits(self) -> Fields:
        return {
            **{"roll_min": 0.0, "roll_max": 0.0, "pitch_min": _PITCH[0], "pitch_max": _PITCH[1]},
            **{"yaw_min": _YAW[0], "yaw_max": _YAW[1], "gimbal_device_id": DEVICE},
        }

    def _information(self) -> Fields:
        return {"time_boot_ms": self._now().milliseconds, "cap_flags": _CAN, **self._limits()}

    def _status(self) -> Fields:
        return {
            **{"time_boot_ms": self._now().milliseconds, "flags": self._flags()},
            **{"gimbal_device_id": DEVICE, "primary_control_sysid": self._pilot[0]},
            **{"primary_control_compid": self._pilot[1], "secondary_control_sysid": 0},
            "secondary_control_compid": 0,
        }

    def _heartbeat(self) -> Fields:
        n = self.device.names
        return {
            **{"type": n.MAV_TYPE_GIMBAL, "autopilot": n.MAV_AUTOPILOT_INVALID, "base_mode": 0},
            **{"custom_mode": 0, "system_status": n.MAV_STATE_ACTIVE, "mavlink_version": 3},
        }

    def _device_information(self) -> Fields:
        name = {"vendor_name": b"Eyas", "model_name": b"gimbal", "custom_name": b""}
        at = {"time_boot_ms": self._now().milliseconds, "uid": self.device.system}
        zero = {"firmware_version": 0, "hardware_version": 0, "custom_cap_flags": 0}
        own = self._limits() | {"gimbal_device_id": 0}
        return {**at, **name, **zero, "cap_flags": _CAN & 0xFFFF, **own}

    def _attitude(self) -> Fields:
        at = self._now()
        roll, pitch, north = camera_angles(at.camera()[1])
        yaw = north if self._locked else at.turned_from_heading(north)
        return {
            **{"target_system": 0, "target_component": 0, "time_boot_ms": at.milliseconds},
            **{"flags": self._flags(), "q": of_angles(roll, pitch, yaw)},
            **{f"angular_velocity_{axis}": math.nan for axis in "xyz"},
            **{"failure_flags": 0, "delta_yaw": at.angles[2], "delta_yaw_velocity": math.nan},
        }
