"""The models of people and robots: names, sizes, colours and typical motion.

Sizes, colours and speeds are those of the original's models in Webots. Model frame: x forward, y
left, z up, origin on the ground below the middle.
"""

from dataclasses import dataclass

from eyas.targets.config import TargetName
from eyas.targets.kind import Colour

__all__ = ["PEDESTRIAN_COLOURS", "JointedModel", "pedestrian", "robot"]

PEDESTRIAN_COLOURS: tuple[Colour, ...] = (
    (0.25, 0.55, 0.20),
    (0.72, 0.12, 0.11),
    (0.13, 0.27, 0.62),
    (0.90, 0.88, 0.84),
    (0.13, 0.13, 0.15),
    (0.88, 0.72, 0.14),
    (0.86, 0.42, 0.12),
    (0.45, 0.20, 0.50),
    (0.55, 0.56, 0.58),
    (0.12, 0.50, 0.52),
)
"""Colours of shirts and coats, sRGB; the first is the original's green."""


@dataclass(frozen=True, slots=True)
class JointedModel:
    """One model of a person or robot."""

    name: str
    """The original's name, with an addition where there are several models of a kind."""
    kind: str
    """Name of its kind; the original's name."""
    size: tuple[float, float, float]
    """Length, width and height, standing, without antennas [m]."""
    rise: float
    """Height of the reference point above the ground [m]."""
    speed: float
    """Typical speed [m/s]."""
    stride: float
    """Distance after which its motion repeats [m]: a stride, or a turn of its wheels."""
    motion: str
    """Typical motion, in words."""

    @property
    def typename(self) -> str:
        """The original's `typename`."""
        return self.kind


def pedestrian(name: str, size: tuple[float, float, float], stride: float) -> JointedModel:
    """Return a pedestrian; the original's is 1.80 m high, its reference point at 1.27 m."""
    rise = 1.27 / 1.8 * size[2]
    motion = "walks from point to point"
    return JointedModel(name, TargetName.PEDESTRIAN.value, size, rise, 2.0, stride, motion)


def robot(kind: TargetName, stride: float) -> JointedModel:
    """Return a robot; its reference point is in the middle of its height."""
    size, speed, motion = _ROBOTS[kind]
    return JointedModel(kind.value, kind.value, size, size[2] / 2, speed, stride, motion)


_ROBOTS: dict[TargetName, tuple[tuple[float, float, float], float, str]] = {
    TargetName.SHRIMP: ((0.64, 0.41, 0.24), 0.26, "straight, turns, then stops"),
    TargetName.CREATE: ((0.335, 0.335, 0.08), 0.5, "straight, turns away from obstacles"),
    TargetName.SOJOURNER: ((0.65, 0.48, 0.30), 0.04, "straight"),
    TargetName.MANTIS: ((4.6, 4.3, 2.0), 0.55, "walks on six legs, three at a time"),
    TargetName.BB_8: ((0.50, 0.50, 0.68), 1.0, "weaves"),
    TargetName.AIBO_ERS7: ((0.32, 0.18, 0.28), 0.1, "walks, then stands"),
    TargetName.BIOLOID_DOG: ((0.40, 0.35, 0.20), 0.35, "trots"),
    TargetName.FIRE_BIRD_6: ((0.32, 0.32, 0.22), 0.05, "straight, turns away from obstacles"),
    TargetName.SCOUT: ((0.15, 0.20, 0.30), 0.08, "walks on two legs"),
    TargetName.GHOST_DOG: ((0.80, 0.28, 0.50), 0.8, "gallops"),
    TargetName.HOAP_2: ((0.20, 0.25, 0.48), 0.05, "walks on two legs, then stops"),
}
"""Length, width and height without antennas [m], speed [m/s] and motion."""
