"""What a tracker does and what is told of it: the original's rules, as Eyas has them.

The body follows its filtered commands exactly, always level, and its camera keeps its pitch.
"""

import math
import random
from typing import Any, NamedTuple

STEP = 0.002  # Step of the physics [s]

_GRAVITY = 9.81
_YAW = (0.13, -0.00469654, -0.013)
_PITCH = (0.000625212, -0.00530346, -0.0207448)
_ROLL = (0.00754686, 0.0160388, -0.00586401)
"""Joints of the gimbal, each in the frame of the one before [m]; the camera is in the last."""
_LEAST, _MOST = 0.5, 1.5  # Limits of the camera's pitch, positive down [rad]
_TURNING, _SLOWEST = 1e-4, 0.5
"""Change of heading in a step above which a target turns [rad], speed below which it stands."""

Vector = tuple[float, float, float]


class Camera(NamedTuple):
    """The camera's picture."""

    width: int
    height: int
    field_of_view: float  # Horizontal [rad]


class Target(NamedTuple):
    """What is followed, at an instant."""

    position: Vector  # Position of the node [m]
    yaw: float  # Counter-clockwise from east [rad]
    ground: float  # z of the ground below it [m]
    typename: str


class LowPass:
    """The original's filter of second order, Butterworth, by the bilinear transform."""

    _K = 2.0 * math.pi * 20.0 * STEP
    _D = _K * _K + math.sqrt(2.0) * _K + 1.0
    _B = _K * _K / _D
    _A1 = 2.0 * (_K * _K - 1.0) / _D
    _A2 = (_K * _K - math.sqrt(2.0) * _K + 1.0) / _D

    def __init__(self) -> None:
        self._first = self._second = 0.0

    def __call__(self, value: float) -> float:
        """Return the filtered value of a step."""
        result = self._B * value + self._first
        self._first = 2.0 * self._B * value - self._A1 * result + self._second
        self._second = self._B * value - self._A2 * result
        return result


def line(numbers: list[float], *words: str) -> str:
    """Return a packet as a line; whole numbers have no decimal point."""
    return ",".join([*(repr(float(number)).removesuffix(".0") for number in numbers), *words])


class Tracker:
    """A drone that follows one target.

    Attributes:
        position: Centre of its body [m].
        yaw: Its heading [rad].
        pitch: Of its camera, positive down [rad].

    Args:
        settings: `env_config.json`, whole.
        floor: z of the land [m].
        chance: Where random starts come from.
    """

    def __init__(
        self, settings: dict[str, Any], camera: Camera, floor: float, chance: random.Random
    ) -> None:
        self._settings, self._camera, self._floor, self._chance = settings, camera, floor, chance
        self._ahead = -1.0 if settings["Tracking_Object"] == "SUMO_VEHICLE" else 0.0
        self.position, self.yaw, self.pitch = (0.0, 0.0, 0.0), 0.0, 1.0
        self._forget()

    def _forget(self) -> None:
        self._filters = LowPass(), LowPass(), LowPass()
        self._velocity, self._acceleration, self._turning = (0.0,) * 3, (0.0,) * 3, 0.0
        self._count = self._unrewarded = 0
        self._reward, self._done, self._crash, self._lost = 0.0, False, False, False
        self._relative: list[Vector] = [(0.0,) * 3] * 3
        self._seen = -1
        self._way = 0

    def begin(self, target: Target) -> None:
        """Start an episode behind a target, as the settings have it."""
        self._forget()
        drawn = {
            name: self._drawn(name)
            for name in ("view_pitch", "horizon_bias", "verticle_bias", "height", "direction")
        }
        pitch, height = drawn["view_pitch"], drawn["height"]
        self._direction = drawn["direction"]
        back = -math.tan(abs(0.5 * math.pi - pitch)) * height
        forward = back + self._ahead + drawn["verticle_bias"]
        yaw = target.yaw + self._direction
        c, s = math.cos(yaw), math.sin(yaw)
        x, y, z = target.position
        left = drawn["horizon_bias"]
        self.position = (x + c * forward - s * left, y + s * forward + c * left, z + height)
        self.yaw, self.pitch = _wrapped(yaw), min(max(pitch, _LEAST), _MOST)
        self._observe(target, target)

    def _drawn(self, name: str) -> float:
        given = self._settings["Drone_Random_Config"]
        if not given[f"{name}_random"]:
            return float(given[f"{name}_fixed"])
        low, high = given[f"{name}_random_min"], given[f"{name}_random_max"]
        if given.get(f"{name}_multilateral", given.get(f"{name}_random_multilateral", False)):
            side = self._chance.choice((-1.0, 1.0))
            return side * self._chance.uniform(abs(low), abs(high))
        return self._chance.uniform(low, high)

    def advance(
        self, command: tuple[float, float, float, float], before: Target, target: Target | None
    ) -> None:
        """Move by one step of 2 ms, and judge it.

        Args:
            command: See `exchange.Request`.
            target: The target now; None: it is gone.
        """
        forward, left, turn = (
            filtered(value)
            for filtered, value in zip(
                self._filters, (command[0], command[1], command[3]), strict=True
            )
        )
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        x, y, z = self.position
        new = (
            x + (c * forward - s * left) * STEP,
            y + (s * forward + c * left) * STEP,
            z + command[2],
        )
        speed = _scaled(_less(new, self.position), 1.0 / STEP)
        self._acceleration = _scaled(_less(speed, self._velocity), 1.0 / STEP)
        self.position, self._velocity, self._turning = new, speed, turn
        self.yaw = _wrapped(self.yaw + turn * STEP)
        self._count += 1
        self._lost |= target is None
        self._observe(before, before if target is None else target)
        self._judge()

    def _observe(self, before: Target, target: Target) -> None:
        self._target = target
        c, s = math.cos(target.yaw), math.sin(target.yaw)
        x, y, z = target.position
        self._centre = (x + self._ahead * c, y + self._ahead * s, z)
        axes, place = self._axes(), self._eye()
        height, sinking = place[2] - target.ground, -axes[0][2]
        depth = height / sinking if 0.0 < height < 1e12 * sinking else 0.0
        self._looked = (place[0] + depth * axes[0][0], place[1] + depth * axes[0][1], target.ground)
        self._reward = self._rewarded(axes, place, depth)
        self._follow()
        turned = _wrapped(target.yaw - before.yaw)
        way = math.dist(target.position[:2], before.position[:2])
        self._way = 0 if way < _SLOWEST * STEP else 1
        if abs(turned) > _TURNING:
            self._way = 2 if turned > 0.0 else 3

    def _follow(self) -> None:
        """Keep where the target is in the frame of the body, and how that changes."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        dx, dy, dz = _less(self._centre, self.position)
        now = (c * dx + s * dy, c * dy - s * dx, dz)
        place, speed, _ = self._relative
        fresh = self._seen < 0
        new = (0.0,) * 3 if fresh else _scaled(_less(now, place), 1.0 / STEP)
        change = (0.0,) * 3 if self._seen < 1 else _scaled(_less(new, speed), 1.0 / STEP)
        self._relative = [now, new, change]
        self._seen += 1

    def _rewarded(self, axes: tuple[Vector, Vector, Vector], place: Vector, depth: float) -> float:
        """Return the built-in reward: 1 in the middle of the view, 0 at the edge of its part."""
        given, width = self._settings["Reward_Config"], self._camera
        if not depth > 0.0:
            return 0.0
        point = (self._centre[0], self._centre[1], self._target.ground)
        away = _less(point, place)
        forward, left, up = (sum(a * b for a, b in zip(axis, away, strict=True)) for axis in axes)
        if given["reward_type"] == "distance":
            distance = math.dist(point[:2], self._looked[:2])
            inside = distance < float(given["distance_range"])
            if given["reward_mode"] == "discrete":
                return float(inside)
            return max(inside - math.tanh(float(given["distance_scale"]) * distance**3), 0.0)
        half = given["view_range"] * math.tan(0.5 * width.field_of_view)
        margin = forward - max(abs(left), abs(up) * width.width / width.height) / half
        share = min(max(margin / depth, 0.0), 1.0)
        if given["reward_mode"] == "discrete":
            return float(share > 0.0)
        return math.tanh(float(given["view_scale"]) * share**3)

    def _judge(self) -> None:
        settings, limits = self._settings, self._settings["Done_Range"]
        height = self.position[2] - (self._target.ground - self._floor)
        speed = math.hypot(self._velocity[0], self._velocity[1])
        self._crash = abs(self._turning) > limits["omiga"]
        broken = (
            not limits["min_height"] <= height <= limits["max_height"]
            or speed >= limits["velocity"]
            or self._crash
        )
        if self._reward > settings["Reward_Config"]["reward_cut_off"]:
            self._unrewarded = 0
        else:
            self._unrewarded += 1
        ended = (
            broken
            or self._lost
            or self._unrewarded > settings["No_Reward_Done_Steps"]
            or self._count >= settings["Train_Total_Steps"]
        )
        self._done = ended and self._count >= settings["Init_No_Done_Steps"]

    def _axes(self) -> tuple[Vector, Vector, Vector]:
        """Return the camera's forward, left and up axes."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        cp, sp = math.cos(self.pitch), math.sin(self.pitch)
        return (c * cp, s * cp, -sp), (-s, c, 0.0), (c * sp, s * sp, cp)

    def _eye(self) -> Vector:
        """Return where the camera is [m]."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        cp, sp = math.cos(self.pitch), math.sin(self.pitch)
        ahead = _YAW[0] + _PITCH[0] + cp * _ROLL[0] + sp * _ROLL[2]
        left = _YAW[1] + _PITCH[1] + _ROLL[1]
        up = _YAW[2] + _PITCH[2] - sp * _ROLL[0] + cp * _ROLL[2]
        x, y, z = self.position
        return x + c * ahead - s * left, y + s * ahead + c * left, z + up

    def basic(self) -> str:
        """Return the basic packet, 22 numbers."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        ax, ay, az = self._acceleration
        felt = (c * ax + s * ay, c * ay - s * ax, az + _GRAVITY)
        turn = (math.cos(0.5 * self.yaw), 0.0, 0.0, math.sin(0.5 * self.yaw))
        numbers = [
            self._count, *self.position, *self._velocity, *felt, 0.0, 0.0, self._turning,
            *turn, 0.0, 0.0, self.yaw, self._reward, float(self._done),
        ]  # fmt: skip
        return line(numbers)

    def custom(self) -> str:
        """Return the reward packet, 60 numbers and the target's type."""
        camera, floor = self._camera, self._floor
        focal = 0.5 * camera.width / math.tan(0.5 * camera.field_of_view)
        axes, eye = self._axes(), _raised(self._eye(), -floor)
        centre = _raised(self._centre, -floor)
        c, s = math.cos(self._target.yaw), math.sin(self._target.yaw)
        numbers = [
            camera.width, camera.height, camera.field_of_view, focal, self.pitch,
            self.position[2], self._direction,
            *_pose(axes, eye), *_pose(((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)), centre),
            *self._looked, *centre, *eye, _wrapped(self._target.yaw - self.yaw),
            *(part for vector in self._relative for part in vector),
            float(self._crash), self._way,
        ]  # fmt: skip
        return line(numbers, self._target.typename)


def _pose(axes: tuple[Vector, Vector, Vector], place: Vector) -> list[float]:
    """Return a pose as a matrix of 4 by 4, row by row."""
    rows = [[*(axis[row] for axis in axes), place[row]] for row in range(3)]
    return [*(part for row in rows for part in row), 0.0, 0.0, 0.0, 1.0]


def _less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _scaled(a: Vector, factor: float) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor


def _raised(a: Vector, by: float) -> Vector:
    return a[0], a[1], a[2] + by


def _wrapped(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)
