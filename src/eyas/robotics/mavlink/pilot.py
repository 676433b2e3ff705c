"""The pilot of one vehicle: modes, arming, what happens when a link is lost, and from all that the
velocity that is commanded. Eyas' frames; nothing of MAVLink.
"""

import math
import struct
from enum import Enum
from typing import Any, NamedTuple

from eyas.lanes import exact
from eyas.robotics.mavlink.component import Component
from eyas.robotics.mavlink.frames import Vector
from eyas.robotics.mavlink.setpoints import Goal, SpeedLimits, Wanted, toward


class FlightMode(Enum):
    """A flight mode: PX4's main mode and sub mode."""

    POSITION = (3, 0)  # A stick moves it
    TAKEOFF = (4, 2)
    HOLD = (4, 3)
    RETURN = (4, 5)
    LAND = (4, 6)
    FOLLOW = (4, 8)  # It follows what `FOLLOW_TARGET` tells
    OFFBOARD = (6, 0)  # A program outside tells where or how fast to fly

    @property
    def custom(self) -> int:
        """The mode as `HEARTBEAT.custom_mode`."""
        main, sub = self.value
        return main << 16 | sub << 24

    @property
    def automatic(self) -> bool:
        """Whether it goes on without a ground station."""
        return self in (FlightMode.TAKEOFF, FlightMode.HOLD, FlightMode.RETURN, FlightMode.LAND)

    @classmethod
    def of(cls, main: int, sub: int) -> "FlightMode | None":
        """Return the mode of PX4's numbers; None if there is none here."""
        return next((mode for mode in cls if mode.value == (main, sub)), None)


class Landed(Enum):
    """Whether a vehicle stands or flies, by MAVLink's `MAV_LANDED_STATE`."""

    GROUND = 1
    AIR = 2
    TAKEOFF = 3
    LANDING = 4


DEFAULTS: dict[str, float | int] = {
    "COM_DISARM_LAND": 2.0,  # on the ground, after landing, it disarms [s]
    "COM_DISARM_PRFLT": 10.0,  # armed, without taking off, it disarms [s]
    "COM_DL_LOSS_T": 10,  # without a ground station's heartbeat, it holds [s]
    "COM_OF_LOSS_T": 1.0,  # without a set point in offboard mode, it holds [s]
    "FLW_TGT_ALT_M": 0,  # it, _FA, _MAX_VEL and _RS have no effect; MAVSDK sets them
    "FLW_TGT_DST": 8.0,  # distance kept from what it follows [m]
    "FLW_TGT_HT": 8.0,  # height over the place of take-off while it follows [m]
    "FLW_TGT_FA": 180.0,
    "FLW_TGT_MAX_VEL": 5.0,
    "FLW_TGT_RS": 0.1,
    "MIS_TAKEOFF_ALT": 2.5,  # height of take-off [m]
    "MPC_ACC_HOR": 5.0,  # [m/s^2]
    "MPC_LAND_SPEED": 0.7,  # [m/s]
    "MPC_TKO_SPEED": 1.5,  # [m/s]
    "MPC_XY_CRUISE": 5.0,  # on the way to a place [m/s]
    "MPC_XY_VEL_MAX": 12.0,  # [m/s]
    "MPC_Z_VEL_MAX_DN": 1.5,  # [m/s]
    "MPC_Z_VEL_MAX_UP": 3.0,  # [m/s]
    "RTL_RETURN_ALT": 30.0,  # least height on the way home [m]
    "SYS_AUTOSTART": 4001,  # a quadrotor
}
"""Whole numbers are of the type INT32, others of REAL32."""

_REAL, _WHOLE = 9, 6


class Parameters:
    """Answers MAVLink's parameter protocol; the values change in place."""

    def __init__(self) -> None:
        self.values = dict(DEFAULTS)

    def __getitem__(self, name: str) -> float:
        return float(self.values[name])

    def answer(self, component: Component, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        """Answer a request for one or all, or a change."""
        names = list(self.values)
        match message.get_type():
            case "PARAM_REQUEST_LIST":
                for name in names:
                    self._tell(component, name)
            case "PARAM_REQUEST_READ":
                at = message.param_index
                name = names[at] if 0 <= at < len(names) else message.param_id
                if name in self.values:
                    self._tell(component, name)
            case "PARAM_SET" if message.param_id in self.values:
                self._set(message.param_id, message.param_value, message.param_type)
                self._tell(component, message.param_id)

    def _set(self, name: str, value: float, kind: int) -> None:
        """Change a parameter; one of the wrong type, or below 0, stays, and is told as it is."""
        whole = isinstance(self.values[name], int)
        if kind != (_WHOLE if whole else _REAL):
            return
        new: float | int = value
        if whole:
            (new,) = struct.unpack("<i", struct.pack("<f", value))
        if 0.0 <= new <= 1e6:  # no for what is not a number
            self.values[name] = new

    def _tell(self, component: Component, name: str) -> None:
        value = self.values[name]
        whole = isinstance(value, int)
        if whole:  # its bits in the place of those of a float, as the capabilities say
            (value,) = struct.unpack("<f", struct.pack("<i", value))
        component.send(
            "param_value",
            param_id=name.encode(),
            param_value=value,
            param_type=_WHOLE if whole else _REAL,
            param_count=len(self.values),
            param_index=list(self.values).index(name),
        )


FEET = 0.183
"""Height of the middle of the body over its feet, see `eyas.engine.trackers.airframe` [m]."""
_STANDS = 0.1  # Height of the feet over the ground up to which a vehicle stands [m]
_NEAR = 0.3  # Distance at which a place is reached [m]
_CLIMB_ACCELERATION = 4.0  # [m/s^2]


class Body(NamedTuple):
    """What a pilot knows of its vehicle, world frame."""

    position: Vector  # [m]
    commanded: Vector  # Position that the commands so far should have reached [m]
    yaw: float  # [rad]
    commanded_yaw: float  # [rad]
    ground: float  # z of the ground below [m]

    @property
    def height(self) -> float:
        """Height of the feet over the ground [m]."""
        return self.position[2] - FEET - self.ground


class Pilot:
    """Flies one vehicle.

    Attributes:
        mode: The flight mode.
        armed: Whether it may fly.
        landed: Whether it stands or flies.
        parameters: Its parameters.
        home: Where it took off, world frame [m].
        set_points: How many set points it has taken.
        cruise: Speed on the way to a place [m/s]; None: as the parameters say.
        notices: What has happened since someone has looked, for people: severity (4 a warning, 6 an
            information) and text.

    Args:
        home: As above.
        parameters: As above.
    """

    def __init__(self, home: Vector, parameters: Parameters) -> None:
        self.mode, self.armed, self.landed = FlightMode.HOLD, False, Landed.GROUND
        self.parameters, self.home = parameters, home
        self.cruise: float | None = None
        self.set_points = 0
        self.notices: list[tuple[int, str]] = []
        self._velocity = [0.0, 0.0, 0.0]
        self._goal = Goal()
        self._offboard, self._offboard_at = Goal(), -math.inf
        self._stick, self._stick_at = (0.0, 0.0, 0.0, 0.0), -math.inf
        self._leader: Wanted | None = None
        self._stood = 0.0
        self._flown = False
        self._ground_station: float | None = None

    def hear_ground_station(self, now: float) -> None:
        """Note that a ground station is there [s]."""
        if self._ground_station is None:
            self.notices.append((6, "Ground station connected"))
        self._ground_station = now

    def arm(self) -> None:
        """Let it fly."""
        if not self.armed:
            self.armed, self._stood, self._flown = True, 0.0, False
            self.notices.append((6, "Armed"))

    def disarm(self) -> bool:
        """Stop the rotors; return whether that was possible: not in flight."""
        if self.landed is not Landed.GROUND:
            return False
        if self.armed:
            self.armed, self.mode = False, FlightMode.HOLD
            self._goal = Goal()
            self.notices.append((6, "Disarmed"))
        return True

    def enter(self, mode: FlightMode, now: float, body: Body) -> bool:
        """Change the mode; return whether that is possible now.

        Offboard mode and following need what they follow.
        """
        if (
            mode is FlightMode.OFFBOARD
            and self.set_point_age(now) > self.parameters["COM_OF_LOSS_T"]
        ):
            self.notices.append((4, "Offboard mode needs set points"))
            return False
        if mode is FlightMode.TAKEOFF:
            self.take_off(body, None)
            return True
        self.mode, self._goal = mode, Goal()
        if mode is FlightMode.RETURN:
            self._begin_return(body)
        return True

    def take_off(self, body: Body, height: float | None) -> None:
        """Climb to a height [m], world frame, at least to that of `MIS_TAKEOFF_ALT`."""
        least = body.ground + FEET + self.parameters["MIS_TAKEOFF_ALT"]
        top = max(least, height if height is not None and math.isfinite(height) else least)
        x, y, _ = body.commanded
        self.mode = FlightMode.TAKEOFF
        self._goal = Goal(position=(x, y, max(top, body.commanded[2])))
        if self.landed is Landed.GROUND:
            self.home = body.position

    def go(self, position: Vector, yaw: float | None) -> None:
        """Fly to a place [m], and hold there; a height that is no number is that of now."""
        self.mode, self._goal = FlightMode.HOLD, Goal(position=position, yaw=yaw)

    def set_point(self, goal: Goal, now: float) -> None:
        """Take a set point of offboard mode."""
        self._offboard, self._offboard_at = goal, now
        self.set_points += 1

    def set_point_age(self, now: float) -> float:
        """Return the time since the last set point [s]."""
        return now - self._offboard_at

    def stick(self, held: tuple[float, float, float, float], now: float) -> None:
        """Take a stick: forward, left, up, turn to the left, each from -1 to 1."""
        self._stick, self._stick_at = held, now

    def lead(self, position: Vector, velocity: Vector, now: float) -> None:
        """Take what is to be followed: place [m] and velocity [m/s]."""
        self._leader = Wanted(position, velocity, now)

    def fly(self, body: Body, now: float, dt: float) -> tuple[float, float, float, float]:
        """Return velocity east, north, up [m/s] and yaw rate [rad/s] for the next time `dt` [s]."""
        self._watch_links(now)
        goal = self._goal_of(body, now)
        velocity, rate = toward(goal, body, self._limits())
        if not self.armed:
            velocity, rate = (0.0, 0.0, 0.0), 0.0
        return *self._eased(velocity, body, dt), rate if self._flies(body, dt) else 0.0

    def _watch_links(self, now: float) -> None:
        """Hold, when whoever flies is no longer heard."""
        late = self.set_point_age(now) > self.parameters["COM_OF_LOSS_T"]
        if self.mode is FlightMode.OFFBOARD and late:
            self.hold("Offboard set points lost")
        if (
            self.mode is FlightMode.POSITION
            and now - self._stick_at > self.parameters["COM_OF_LOSS_T"]
        ):
            self._stick = (0.0, 0.0, 0.0, 0.0)
        heard = self._ground_station
        if heard is not None and now - heard > self.parameters["COM_DL_LOSS_T"]:
            self._ground_station = None
            self.notices.append((4, "Ground station lost"))
            if not self.mode.automatic:
                self.hold("Ground station lost")

    def hold(self, why: str) -> None:
        """Hold because something is lost."""
        self.mode, self._goal = FlightMode.HOLD, Goal()
        self.notices.append((4, f"{why}: holding"))

    def _goal_of(self, body: Body, now: float) -> Goal:
        """Return where to fly, or how fast, and go on to the next part of a mode."""
        match self.mode:
            case FlightMode.OFFBOARD:
                return self._offboard
            case FlightMode.POSITION:
                return self._moved_by_stick(body)
            case FlightMode.FOLLOW:
                return self._beside_leader(body, now)
            case FlightMode.LAND:
                return Goal(velocity=(0.0, 0.0, -self.parameters["MPC_LAND_SPEED"]))
            case FlightMode.TAKEOFF if self._reached(body):
                self.mode = FlightMode.HOLD
            case FlightMode.RETURN if self._reached(body):
                return self._next_of_return(body)
        return self._goal

    def _reached(self, body: Body) -> bool:
        goal = self._goal.position
        return goal is not None and _apart(goal, body.commanded) < _NEAR

    def _begin_return(self, body: Body) -> None:
        """Climb first, unless home is near."""
        x, y, z = body.commanded
        near = _apart((x, y, 0.0), (*self.home[:2], 0.0)) < 10.0
        high = self.home[2] + self.parameters["RTL_RETURN_ALT"]
        self._goal = Goal(position=(x, y, z if near else max(z, high)))

    def _next_of_return(self, body: Body) -> Goal:
        x, y, _ = body.commanded
        if _apart((x, y, 0.0), (*self.home[:2], 0.0)) < 2.0 * _NEAR:
            self.mode, self._goal = FlightMode.LAND, Goal()
        else:
            self._goal = Goal(position=(self.home[0], self.home[1], body.commanded[2]))
        return self._goal

    def _moved_by_stick(self, body: Body) -> Goal:
        forward, left, up, turn = self._stick
        fastest, limits = self.parameters["MPC_XY_CRUISE"], self._limits()
        climb = up * (limits.up if up > 0.0 else limits.down)
        return Goal(velocity=(forward * fastest, left * fastest, climb), yaw_rate=turn, body=True)

    def _beside_leader(self, body: Body, now: float) -> Goal:
        """Keep the distance from what is followed, on the side where the vehicle is, and look at
        it.
        """
        leader = self._leader
        if leader is None:
            return Goal()
        age = min(now - leader.time, 2.0)
        ahead = [p + v * age for p, v in zip(leader.position, leader.velocity, strict=True)]
        east, north = ahead[0] - body.commanded[0], ahead[1] - body.commanded[1]
        away = float(exact.hypot(east, north))
        yaw = float(exact.atan2(north, east)) if away > 0.5 else None
        share = (away - self.parameters["FLW_TGT_DST"]) / max(away, 0.5)
        height = self.home[2] + self.parameters["FLW_TGT_HT"]
        x, y, _ = body.commanded
        place = (x + share * east, y + share * north, height)
        return Goal(position=place, velocity=(*leader.velocity[:2], 0.0), yaw=yaw)

    def _limits(self) -> SpeedLimits:
        p = self.parameters
        cruise = p["MPC_XY_CRUISE"] if self.cruise is None else self.cruise
        up = p["MPC_TKO_SPEED"] if self.mode is FlightMode.TAKEOFF else p["MPC_Z_VEL_MAX_UP"]
        free = self.mode in (FlightMode.OFFBOARD, FlightMode.FOLLOW)
        most = p["MPC_XY_VEL_MAX"]
        cruise = most if free else min(cruise, most)
        return SpeedLimits(cruise, most, up, p["MPC_Z_VEL_MAX_DN"], p["MPC_ACC_HOR"])

    def _eased(self, wanted: Vector, body: Body, dt: float) -> Vector:
        """Change the velocity no faster than allowed, and stay over the ground."""
        v = self._velocity
        east, north = wanted[0] - v[0], wanted[1] - v[1]
        change, most = float(exact.hypot(east, north)), self.parameters["MPC_ACC_HOR"] * dt
        share = 1.0 if change <= most else most / change
        v[0], v[1] = v[0] + share * east, v[1] + share * north
        climb = _CLIMB_ACCELERATION * dt
        v[2] += min(max(wanted[2] - v[2], -climb), climb)
        least = (body.ground + FEET - body.commanded[2]) / dt
        v[2] = max(v[2], min(least, 0.0))
        if self.landed is Landed.GROUND and v[2] <= 0.0:
            v[0] = v[1] = 0.0
        return v[0], v[1], v[2]

    def _flies(self, body: Body, dt: float) -> bool:
        """Tell standing from flying, and disarm what has stood for long."""
        climbs = self.armed and self._velocity[2] > 0.05
        if body.height < _STANDS and not climbs:
            self.landed, self._stood = Landed.GROUND, self._stood + dt
        else:
            self._stood, self._flown = 0.0, True
            self.landed = {FlightMode.TAKEOFF: Landed.TAKEOFF, FlightMode.LAND: Landed.LANDING}.get(
                self.mode, Landed.AIR
            )
        patience = "COM_DISARM_LAND" if self._flown else "COM_DISARM_PRFLT"
        done = not self._flown or self.mode is FlightMode.LAND
        if self.armed and done and 0.0 < self.parameters[patience] < self._stood:
            self.disarm()
        return self.landed is not Landed.GROUND


def _apart(a: Vector, b: Vector) -> float:
    """Return the distance of two places [m]."""
    return exact.length([first - second for first, second in zip(a, b, strict=True)])
