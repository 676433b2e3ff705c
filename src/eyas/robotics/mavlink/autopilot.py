"""The autopilot of one vehicle: what its messages and commands let its pilot do."""

import math
from collections.abc import Callable
from typing import Any

from eyas.robotics.mavlink.component import Command, Component, Result
from eyas.robotics.mavlink.frames import Vector, compass, on_earth, swapped, usable
from eyas.robotics.mavlink.pilot import FlightMode, Landed, Pilot
from eyas.robotics.mavlink.readings import Instant
from eyas.robotics.mavlink.setpoints import Goal

_ACCEPTED, _UNSUPPORTED, _BAD_NUMBER = 0, 3, 13
_ALL = 255


def refuse_missions(component: Component) -> None:
    """Let a component answer MAVLink's mission protocol."""

    def to(message: Any) -> dict[str, int]:  # noqa: ANN401  # pymavlink's
        return {
            "target_system": message.get_srcSystem(),
            "target_component": message.get_srcComponent(),
            "mission_type": min(getattr(message, "mission_type", 0), _ALL),
        }

    def answer(kind: int) -> Any:  # noqa: ANN401  # a function of a message
        return lambda message: component.send("mission_ack", type=kind, **to(message))

    def tell_count(message: Any) -> None:  # noqa: ANN401  # pymavlink's
        component.send("mission_count", count=0, **to(message))

    component.handlers.update(
        {
            "MISSION_REQUEST_LIST": tell_count,
            "MISSION_CLEAR_ALL": answer(_ACCEPTED),
            "MISSION_COUNT": answer(_UNSUPPORTED),
            "MISSION_WRITE_PARTIAL_LIST": answer(_UNSUPPORTED),
            **{
                kind: answer(_BAD_NUMBER)
                for kind in ("MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_SET_CURRENT")
            },
        }
    )


COMPONENT = 1  # Component id of the autopilot

_NO_POSITION, _NO_VELOCITY = 0b111, 0b111_000
_NO_YAW, _NO_YAW_RATE = 1 << 10, 1 << 11
_LOCAL, _OFFSET, _BODY, _BODY_OFFSET, _BODY_FRD = 1, 7, 8, 9, 12
_RELATIVE = (3, 6, 10, 11)
"""`MAV_FRAME`s whose heights are those over the origin; in others they are above the sea."""
_CUSTOM = 1


class Autopilot:
    """Lets others fly a vehicle.

    Args:
        now: Returns the present instant.
    """

    def __init__(self, component: Component, pilot: Pilot, now: Callable[[], Instant]) -> None:
        self._component, self._pilot, self._now = component, pilot, now
        self._reported = pilot.mode, pilot.armed
        component.answers.update(
            {
                "COMPONENT_ARM_DISARM": self._arm,
                "NAV_TAKEOFF": self._take_off,
                "NAV_LAND": lambda _: self._enter(FlightMode.LAND),
                "NAV_RETURN_TO_LAUNCH": lambda _: self._enter(FlightMode.RETURN),
                "NAV_LOITER_UNLIM": lambda _: self._enter(FlightMode.HOLD),
                "DO_SET_MODE": self._set_mode,
                "DO_REPOSITION": self._reposition,
                "DO_CHANGE_SPEED": self._change_speed,
                "DO_SET_HOME": self._set_home,
                "REQUEST_AUTOPILOT_CAPABILITIES": self._tell_version,
            }
        )
        parameters = pilot.parameters
        component.handlers.update(
            {
                "HEARTBEAT": self._hear_heartbeat,
                "SET_MODE": self._hear_mode,
                "SET_POSITION_TARGET_LOCAL_NED": self._hear_local,
                "SET_POSITION_TARGET_GLOBAL_INT": self._hear_global,
                "FOLLOW_TARGET": self._hear_leader,
                "MANUAL_CONTROL": self._hear_stick,
                "TIMESYNC": self._hear_time,
                "PING": self._hear_ping,
                **{
                    kind: lambda message: parameters.answer(component, message)
                    for kind in ("PARAM_REQUEST_LIST", "PARAM_REQUEST_READ", "PARAM_SET")
                },
            }
        )
        refuse_missions(component)

    def report(self) -> None:
        """Send what the pilot has to say, and a heartbeat at once where that tells something."""
        state = self._pilot.mode, self._pilot.armed
        if state != self._reported:
            self._reported = state
            self._component.tell("heartbeat")
        for severity, text in self._pilot.notices:
            self._component.send("statustext", severity=severity, text=text.encode()[:50])
        self._pilot.notices.clear()

    def _arm(self, command: Command) -> Result:
        if command.p[0] == 1.0:
            self._pilot.arm()
            return Result.ACCEPTED
        done = command.p[0] == 0.0 and self._pilot.disarm()
        return Result.ACCEPTED if done else Result.DENIED

    def _take_off(self, command: Command) -> Result:
        pilot, at = self._pilot, self._now()
        if not pilot.armed:
            return Result.TEMPORARILY_REJECTED
        altitude = command.p[6]
        pilot.take_off(at.body, at.place_of(0.0, 0.0, altitude, relative=False)[2])
        return Result.ACCEPTED

    def _enter(self, mode: FlightMode) -> Result:
        at, pilot = self._now(), self._pilot
        if not pilot.armed and mode in (FlightMode.TAKEOFF, FlightMode.LAND, FlightMode.RETURN):
            return Result.TEMPORARILY_REJECTED
        if mode in (FlightMode.LAND, FlightMode.RETURN) and pilot.landed is Landed.GROUND:
            return Result.ACCEPTED
        done = pilot.enter(mode, at.seconds, at.body)
        return Result.ACCEPTED if done else Result.TEMPORARILY_REJECTED

    def _set_mode(self, command: Command) -> Result:
        base, main, sub = command.p[:3]
        if not all(math.isfinite(part) for part in (base, main, sub)) or not int(base) & _CUSTOM:
            return Result.DENIED
        mode = FlightMode.of(int(main), int(sub))
        return Result.UNSUPPORTED if mode is None else self._enter(mode)

    def _reposition(self, command: Command) -> Result:
        """Fly to a place and hold there; what is no number stays as it is."""
        at, pilot = self._now(), self._pilot
        if not pilot.armed or pilot.landed is Landed.GROUND:
            return Result.TEMPORARILY_REJECTED
        speed, yaw = command.p[0], command.p[3]
        latitude, longitude, altitude = command.p[4:7]
        place = at.body.commanded
        if on_earth(latitude, longitude, 0.0):
            east, north, _ = at.place_of(latitude, longitude, 0.0, relative=True)
            place = (east, north, place[2])
        if on_earth(0.0, 0.0, altitude):
            relative = command.frame in _RELATIVE
            place = (*place[:2], at.place_of(0.0, 0.0, altitude, relative=relative)[2])
        if speed > 0.0:
            pilot.cruise = speed
        pilot.go(place, compass(yaw) if usable(yaw) else None)
        return Result.ACCEPTED

    def _change_speed(self, command: Command) -> Result:
        kind, speed = command.p[:2]
        if kind not in (0.0, 1.0) or not speed > 0.0:
            return Result.DENIED
        self._pilot.cruise = speed
        return Result.ACCEPTED

    def _set_home(self, command: Command) -> Result:
        at = self._now()
        if command.p[0] == 1.0:
            self._pilot.home = at.body.position
        elif on_earth(*command.p[4:7]):
            relative = command.frame in _RELATIVE
            self._pilot.home = at.place_of(*command.p[4:7], relative=relative)
        else:
            return Result.DENIED
        self._component.tell("home_position")
        return Result.ACCEPTED

    def _tell_version(self, command: Command) -> Result:
        self._component.tell("autopilot_version")
        return Result.ACCEPTED

    def _hear_heartbeat(self, message: Any) -> None:  # noqa: ANN401  # pymavlink's, here and below
        if message.type == self._component.names.MAV_TYPE_GCS:
            self._pilot.hear_ground_station(self._now().seconds)

    def _hear_mode(self, message: Any) -> None:  # noqa: ANN401
        mode = FlightMode.of(message.custom_mode >> 16 & 255, message.custom_mode >> 24)
        if message.base_mode & _CUSTOM and mode is not None:
            self._enter(mode)

    def _hear_local(self, message: Any) -> None:  # noqa: ANN401
        """Take a set point in the local frame, or in that of the body."""
        frame, mask, at = message.coordinate_frame, message.type_mask, self._now()
        velocity = None
        body = frame in (_BODY, _BODY_OFFSET, _BODY_FRD)
        if mask & _NO_VELOCITY != _NO_VELOCITY:
            parts = _kept((message.vx, message.vy, message.vz), mask >> 3)
            velocity = (parts[0], -parts[1], -parts[2]) if body else swapped(parts)
        position = None
        if mask & _NO_POSITION != _NO_POSITION and frame in (_LOCAL, _OFFSET):
            start = at.body.position if frame == _OFFSET else at.origin
            x, y, z = swapped(_kept((message.x, message.y, message.z), mask))
            position = (start[0] + x, start[1] + y, start[2] + z)
        self._take(position, velocity, message, body=body)

    def _hear_global(self, message: Any) -> None:  # noqa: ANN401
        """Take a set point on the earth."""
        mask, at, velocity = message.type_mask, self._now(), None
        if mask & _NO_VELOCITY != _NO_VELOCITY:
            velocity = swapped(_kept((message.vx, message.vy, message.vz), mask >> 3))
        position = None
        if mask & _NO_POSITION != _NO_POSITION:
            relative = message.coordinate_frame in _RELATIVE
            place = message.lat_int * 1e-7, message.lon_int * 1e-7, message.alt
            position = at.place_of(*place, relative=relative)
        self._take(position, velocity, message, body=False)

    def _take(
        self,
        position: Vector | None,
        velocity: Vector | None,
        message: Any,  # noqa: ANN401
        *,
        body: bool,
    ) -> None:
        """Give the pilot a set point, unless it says nothing of place and velocity."""
        if position is None and velocity is None:
            return
        mask = message.type_mask
        yaw = compass(message.yaw) if not mask & _NO_YAW and usable(message.yaw) else None
        turns = not mask & _NO_YAW_RATE and usable(message.yaw_rate)
        rate = -message.yaw_rate if turns else None
        given = (*(position or ()), *(velocity or ()))
        if not all(math.isnan(part) or usable(part) for part in given):
            return
        self._pilot.set_point(Goal(position, velocity, yaw, rate, body), self._now().seconds)

    def _hear_leader(self, message: Any) -> None:  # noqa: ANN401
        at = self._now()
        degrees = message.lat * 1e-7, message.lon * 1e-7
        place = at.place_of(*degrees, message.alt, relative=False)
        if not on_earth(*degrees, message.alt):
            return
        knows = bool(message.est_capabilities & 2)
        velocity = swapped(message.vel) if knows else (0.0, 0.0, 0.0)
        if all(usable(part) for part in velocity):
            self._pilot.lead(place, velocity, at.seconds)

    def _hear_stick(self, message: Any) -> None:  # noqa: ANN401
        """Take a stick whose throttle is 0 to 1000, with 500 in the middle."""
        if message.target != self._component.system:
            return
        x, y, r = (_share(part) for part in (message.x, message.y, message.r))
        up = min(max(message.z / 500.0 - 1.0, -1.0), 1.0)
        self._pilot.stick((x, -y, 0.0 if abs(up) < 0.1 else up, -r), self._now().seconds)

    def _hear_time(self, message: Any) -> None:  # noqa: ANN401
        if message.tc1 == 0:
            self._component.send("timesync", tc1=self._now().microseconds * 1000, ts1=message.ts1)

    def _hear_ping(self, message: Any) -> None:  # noqa: ANN401
        if message.target_system == 0:
            self._component.send(
                "ping",
                time_usec=message.time_usec,
                seq=message.seq,
                target_system=message.get_srcSystem(),
                target_component=message.get_srcComponent(),
            )


def _kept(parts: Vector, mask: int) -> Vector:
    """Return three numbers; those that a mask leaves out are no numbers (NaN)."""
    first, second, third = (
        math.nan if mask >> k & 1 else float(part) for k, part in enumerate(parts)
    )
    return first, second, third


def _share(part: int) -> float:
    """Return how far a stick is held, -1 to 1; 0 if it is not there."""
    return min(max(part / 1000.0, -1.0), 1.0) if abs(part) <= 1000 else 0.0
