"""What an autopilot tells of itself: the fields of its messages."""

import math
from collections.abc import Callable, Iterable
from typing import Any

from eyas.lanes import exact
from eyas.robotics.mavlink.component import Component, Fields
from eyas.robotics.mavlink.pilot import FlightMode, Pilot
from eyas.robotics.mavlink.readings import Instant

RATES = {
    "heartbeat": 1.0,
    "sys_status": 1.0,
    "battery_status": 0.5,
    "system_time": 1.0,
    "extended_sys_state": 2.0,
    "home_position": 0.5,
    "gps_raw_int": 5.0,
    "vfr_hud": 5.0,
    "altitude": 10.0,
    "global_position_int": 20.0,
    "local_position_ned": 50.0,
    "attitude": 50.0,
    "attitude_quaternion": 50.0,
    "highres_imu": 50.0,
}
"""Messages a second [Hz]; `SET_MESSAGE_INTERVAL` changes them."""

_EPOCH = 1_767_225_600_000_000  # Simulated time begins with the year 2026 [us since 1970]
_UNKNOWN_CELL = 65535
_NO_TILT = (1.0, 0.0, 0.0, 0.0)


def degrees_e7(angle: float) -> int:
    """Return an angle in degrees in units of 1e-7 degrees."""
    return round(angle * 1e7)


_SENSORS = (
    "SENSOR_3D_GYRO SENSOR_3D_ACCEL SENSOR_3D_MAG SENSOR_ABSOLUTE_PRESSURE SENSOR_GPS "
    "SENSOR_ANGULAR_RATE_CONTROL SENSOR_ATTITUDE_STABILIZATION SENSOR_YAW_POSITION "
    "SENSOR_Z_ALTITUDE_CONTROL SENSOR_XY_POSITION_CONTROL SENSOR_MOTOR_OUTPUTS AHRS "
    "SENSOR_BATTERY PREARM_CHECK".split()
)
"""MAV_SYS_STATUS_*: what is there and well."""
_CAPABILITIES = (
    "MISSION_INT COMMAND_INT PARAM_ENCODE_BYTEWISE MAVLINK2 SET_POSITION_TARGET_LOCAL_NED "
    "SET_POSITION_TARGET_GLOBAL_INT COMPONENT_IMPLEMENTS_GIMBAL_MANAGER".split()
)
"""MAV_PROTOCOL_CAPABILITY_*: what the autopilot understands."""


class Telemetry:
    """Makes the fields of messages, which become those of the autopilot's component."""

    def __init__(self, component: Component, pilot: Pilot, now: Callable[[], Instant]) -> None:
        self._names, self._system = component.names, component.system
        self._pilot, self._now = pilot, now
        made: dict[str, Callable[[], Fields]] = {
            "heartbeat": self.heartbeat,
            "sys_status": self.sys_status,
            "battery_status": self.battery_status,
            "system_time": self.system_time,
            "extended_sys_state": self.extended_sys_state,
            "home_position": self.home_position,
            "gps_global_origin": self.gps_global_origin,
            "gps_raw_int": self.gps_raw_int,
            "vfr_hud": self.vfr_hud,
            "altitude": self.altitude,
            "global_position_int": self.global_position_int,
            "local_position_ned": self.local_position_ned,
            "attitude": self.attitude,
            "attitude_quaternion": self.attitude_quaternion,
            "odometry": self.odometry,
            "highres_imu": self.highres_imu,
            "scaled_imu": self.scaled_imu,
            "autopilot_version": self.autopilot_version,
        }
        component.producers.update({name: _one(make) for name, make in made.items()})
        for name, rate in RATES.items():
            component.stream(name, rate)

    def heartbeat(self) -> Fields:
        """A quadrotor that speaks as PX4 does."""
        n, pilot = self._names, self._pilot
        mode = n.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | n.MAV_MODE_FLAG_STABILIZE_ENABLED
        if pilot.mode is FlightMode.POSITION:
            mode |= n.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
        else:
            mode |= n.MAV_MODE_FLAG_GUIDED_ENABLED | n.MAV_MODE_FLAG_AUTO_ENABLED
        if pilot.armed:
            mode |= n.MAV_MODE_FLAG_SAFETY_ARMED
        return {
            "type": n.MAV_TYPE_QUADROTOR,
            "autopilot": n.MAV_AUTOPILOT_PX4,
            "base_mode": mode,
            "custom_mode": pilot.mode.custom,
            "system_status": n.MAV_STATE_ACTIVE if pilot.armed else n.MAV_STATE_STANDBY,
            "mavlink_version": 3,
        }

    def sys_status(self) -> Fields:
        """All sensors are well."""
        n = self._names
        prefix = "MAV_SYS_STATUS_"
        bits = sum(getattr(n, prefix + sensor) for sensor in _SENSORS)
        sensed = {f"onboard_control_sensors_{what}": bits for what in ("present", "enabled")}
        errors = {f"errors_count{k}": 0 for k in range(1, 5)}
        return {
            **sensed,
            **errors,
            **{"onboard_control_sensors_health": bits, "load": 100, "voltage_battery": 16_800},
            **{"current_battery": -1, "battery_remaining": 100, "drop_rate_comm": 0},
            "errors_comm": 0,
        }

    def battery_status(self) -> Fields:
        """A battery that stays full: its discharge is not simulated."""
        n = self._names
        return {
            **{"id": 0, "battery_function": n.MAV_BATTERY_FUNCTION_ALL},
            **{"type": n.MAV_BATTERY_TYPE_LIPO, "temperature": 32767, "current_battery": -1},
            "voltages": [4_200] * 4 + [_UNKNOWN_CELL] * 6,
            **{"current_consumed": -1, "energy_consumed": -1, "battery_remaining": 100},
        }

    def system_time(self) -> Fields:
        """Simulated time."""
        at = self._now()
        return {"time_unix_usec": _EPOCH + at.microseconds, "time_boot_ms": at.milliseconds}

    def extended_sys_state(self) -> Fields:
        """Whether it stands or flies."""
        return {"vtol_state": 0, "landed_state": self._pilot.landed.value}

    def home_position(self) -> Fields:
        """Home position: the place of the take-off."""
        at, home = self._now(), self._pilot.home
        latitude, longitude, altitude = at.global_of(home)
        north, east = home[1] - at.origin[1], home[0] - at.origin[0]
        return {
            **{"latitude": degrees_e7(latitude), "longitude": degrees_e7(longitude)},
            **{"altitude": round(altitude * 1e3), "x": north, "y": east},
            **{"z": at.origin[2] - home[2], "q": _NO_TILT, "time_usec": at.microseconds},
            **{f"approach_{axis}": math.nan for axis in "xyz"},
        }

    def gps_global_origin(self) -> Fields:
        """The origin of the local frame."""
        at = self._now()
        latitude, longitude, altitude = at.global_of(at.origin)
        place = {"latitude": degrees_e7(latitude), "longitude": degrees_e7(longitude)}
        return {**place, "altitude": round(altitude * 1e3), "time_usec": at.microseconds}

    def gps_raw_int(self) -> Fields:
        """What the GPS tells, with its errors."""
        at = self._now()
        place, (north, east, _) = at.gps()
        latitude, longitude, altitude = at.global_of(place)
        course = math.degrees(exact.atan2(east, north)) % 360.0
        return {
            **{"time_usec": at.microseconds, "fix_type": self._names.GPS_FIX_TYPE_RTK_FIXED},
            **{"lat": degrees_e7(latitude), "lon": degrees_e7(longitude)},
            **{"alt": round(altitude * 1e3), "eph": 50, "epv": 70, "satellites_visible": 16},
            **{"vel": round(100.0 * math.sqrt(north * north + east * east))},
            "cog": round(course * 100.0) % 36_000,
        }

    def vfr_hud(self) -> Fields:
        """Speeds, heading and height for displays (VFR_HUD)."""
        at = self._now()
        north, east, down = at.velocity
        speed = math.sqrt(north * north + east * east)
        return {
            **{"airspeed": speed, "groundspeed": speed, "heading": int(at.heading)},
            **{"throttle": 50 if self._pilot.armed else 0, "alt": at.global_place[2]},
            "climb": -down,
        }

    def altitude(self) -> Fields:
        """Heights over several things."""
        at = self._now()
        above_sea, high = at.global_place[2], at.relative_height
        ground = at.global_of((0.0, 0.0, at.body.ground))[2]
        return {
            **{"time_usec": at.microseconds, "altitude_monotonic": above_sea},
            **{"altitude_amsl": above_sea, "altitude_local": high, "altitude_relative": high},
            **{"altitude_terrain": ground, "bottom_clearance": max(at.body.height, 0.0)},
        }

    def global_position_int(self) -> Fields:
        """Place and velocity on the earth."""
        at = self._now()
        latitude, longitude, altitude = at.global_place
        north, east, down = (round(part * 100.0) for part in at.velocity)
        return {
            **{"time_boot_ms": at.milliseconds, "lat": degrees_e7(latitude)},
            **{"lon": degrees_e7(longitude), "alt": round(altitude * 1e3)},
            **{"relative_alt": round((at.body.position[2] - self._pilot.home[2]) * 1e3)},
            **{"vx": north, "vy": east, "vz": down, "hdg": round(at.heading * 100.0) % 36_000},
        }

    def local_position_ned(self) -> Fields:
        """Place and velocity from the origin."""
        at = self._now()
        (x, y, z), (vx, vy, vz) = at.local, at.velocity
        place = {"time_boot_ms": at.milliseconds, "x": x, "y": y, "z": z}
        return {**place, "vx": vx, "vy": vy, "vz": vz}

    def attitude(self) -> Fields:
        """Attitude as angles."""
        at = self._now()
        angles = dict(zip(("roll", "pitch", "yaw"), at.angles, strict=True))
        return {"time_boot_ms": at.milliseconds, **angles, **_speeds(at)}

    def attitude_quaternion(self) -> Fields:
        """Attitude as a quaternion."""
        at = self._now()
        turned = {f"q{k + 1}": part for k, part in enumerate(at.attitude)}
        return {"time_boot_ms": at.milliseconds, **turned, **_speeds(at)}

    def odometry(self) -> Fields:
        """Place from the origin; velocity in the body's frame."""
        at, n = self._now(), self._names
        x, y, z = at.local
        vx, vy, vz = at.forward_velocity()
        unknown = [math.nan] + [0.0] * 20
        return {
            **{"time_usec": at.microseconds, "frame_id": n.MAV_FRAME_LOCAL_NED},
            **{"child_frame_id": n.MAV_FRAME_BODY_FRD, "x": x, "y": y, "z": z},
            **{"q": at.attitude, "vx": vx, "vy": vy, "vz": vz, **_speeds(at)},
            **{"pose_covariance": unknown, "velocity_covariance": unknown},
            "estimator_type": n.MAV_ESTIMATOR_TYPE_AUTOPILOT,
        }

    def highres_imu(self) -> Fields:
        """What the inertial sensors, compass and barometer read, with their errors."""
        at = self._now()
        felt, turn = at.imu()
        axes = {
            f"{what}{axis}": value
            for what, vector in (("acc", felt), ("gyro", turn), ("mag", at.magnetic()))
            for axis, value in zip("xyz", vector, strict=True)
        }
        named = {f"{axis[-1]}{axis[:-1]}": value for axis, value in axes.items()}
        altitude = at.global_place[2]
        return {
            **{"time_usec": at.microseconds, **named, "abs_pressure": at.pressure()},
            **{"diff_pressure": 0.0, "pressure_alt": altitude, "temperature": 15.0},
            "fields_updated": 0x1BFF,  # all but the difference of pressures
        }

    def scaled_imu(self) -> Fields:
        """Sensor readings in whole thousandths."""
        at = self._now()
        felt, turn = at.imu()
        found: Fields = {"time_boot_ms": at.milliseconds}
        for what, vector, scale in (
            *(("acc", felt, 1e3 / 9.80665), ("gyro", turn, 1e3)),
            ("mag", at.magnetic(), 1e3),
        ):
            for axis, value in zip("xyz", vector, strict=True):
                found[axis + what] = round(value * scale)
        return found

    def autopilot_version(self) -> Fields:
        """What the autopilot understands."""
        n = self._names
        blank = [0] * 8
        return {
            "capabilities": sum(
                getattr(n, f"MAV_PROTOCOL_CAPABILITY_{what}") for what in _CAPABILITIES
            ),
            **{"flight_sw_version": 0x010F_00FF, "middleware_sw_version": 0},
            **{"os_sw_version": 0, "board_version": 0, "flight_custom_version": blank},
            **{"middleware_custom_version": blank, "os_custom_version": blank},
            **{"vendor_id": 0, "product_id": 0, "uid": self._system},
        }


def _one(make: Callable[[], Fields]) -> Callable[[], Iterable[Fields]]:
    return lambda: (make(),)


def _speeds(at: Instant) -> dict[str, Any]:
    return dict(zip(("rollspeed", "pitchspeed", "yawspeed"), at.rates, strict=True))
