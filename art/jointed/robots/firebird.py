"""FireBird6, a round research robot: plates on two wheels and a caster, ringed by sensors."""

import numpy as np

from art.jointed.figure import Figure, Joint
from art.jointed.model import robot
from art.jointed.outlines import block, cylinder, matt, stack, wheel
from eyas.engine.mesh.shell import Shell
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit
from eyas.lanes import exact

_SALMON, _PLATE, _BLUE = matt(0.80, 0.40, 0.40), matt(0.22, 0.22, 0.24), matt(0.16, 0.28, 0.72)
_TYRE, _SONAR, _SCREEN = matt(0.10, 0.10, 0.11), matt(0.70, 0.60, 0.30), matt(0.35, 0.62, 0.38)
_RADIUS = 0.05


def _body(shell: Shell, detail: int) -> None:
    sides = (8, 12, 20)[detail]

    def disc(low: float, high: float, radius: float) -> list[tuple[float, float, float, float]]:
        return [(low, radius, radius, 0.0), (high, radius, radius, 0.0)]

    stack(shell, disc(0.035, 0.05, 0.155), _PLATE, sides)
    stack(shell, disc(0.05, 0.135, 0.16), _SALMON, sides)
    stack(shell, disc(0.135, 0.148, 0.128), _PLATE, sides)
    stack(shell, disc(0.148, 0.175, 0.105), _SALMON, sides)
    stack(shell, disc(0.175, 0.187, 0.082), _PLATE, sides)
    cylinder(shell, (-0.11, 0.0, 0.02), 0.02, 0.03, _TYRE, 6)
    block(shell, (-0.03, 0.0, 0.204), (0.10, 0.06, 0.032), _PLATE)
    if detail:
        block(shell, (-0.025, 0.0, 0.2205), (0.06, 0.045, 0.001), _SCREEN)
        block(shell, (0.06, 0.0, 0.20), (0.03, 0.10, 0.03), _SALMON)
        for angle in np.arange(8) * (np.pi / 4):
            c, s = exact.cos(angle), exact.sin(angle)
            path = [(0.145 * c, 0.145 * s, 0.095), (0.165 * c, 0.165 * s, 0.095)]
            shell.tube(path, (0.019, 0.017), _SONAR, sides=4 + 3 * (detail - 1))


def _wheels(shell: Shell, detail: int) -> None:
    wheel(shell, _RADIUS, 0.03, (-0.148, 0.148), (_BLUE, _TYRE), detail)


_FIGURE = Figure(
    joints=(
        Joint(name="body", shape=_body),
        Joint(name="wheels", shape=_wheels, pivot=(0.0, 0.0, _RADIUS), spins=True),
    ),
    wheel_radius=_RADIUS,
)

MODEL = robot(
    TargetName.FIRE_BIRD_6,
    size=(0.32, 0.32, 0.22),
    colour=(0.80, 0.40, 0.40),
    words="a round salmon robot on blue wheels",
    motion="straight, turns away from obstacles",
    habit=Habit(Behaviour.WANDER, speed=0.05, acceleration=0.1, yaw_rate=0.5, radius=0.1),
    figure=_FIGURE,
)
