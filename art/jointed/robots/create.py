"""Create, a flat disc on two wheels: iRobot's platform without a vacuum cleaner."""

from itertools import pairwise

import numpy as np

from art.jointed.figure import Figure, Joint
from art.jointed.model import robot
from art.jointed.outlines import block, matt, stack, wheel
from eyas.engine.mesh.shell import Shell
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit
from eyas.lanes import exact

_RADIUS, _WHEEL = 0.1675, 0.031
_SHELL, _BUMPER, _BAY = matt(0.88, 0.88, 0.87), matt(0.42, 0.43, 0.45), matt(0.16, 0.16, 0.17)
_KEY, _TYRE, _HUB = matt(0.25, 0.62, 0.28), matt(0.10, 0.10, 0.11), matt(0.6, 0.6, 0.6)


def _body(shell: Shell, detail: int) -> None:
    sides = (8, 14, 26)[detail]
    radius = _RADIUS - 0.004
    stack(shell, [(0.012, 0.94 * radius, 0.94 * radius, 0.0), (0.02, radius, radius, 0.0),
                  (0.062, radius, radius, 0.0), (0.08, 0.9 * radius, 0.9 * radius, 0.0)],
          _SHELL, sides)  # fmt: skip
    # The bumper goes round the front half.
    angle = np.linspace(-np.pi / 2, np.pi / 2, sides // 2 + 1)
    low, high = 0.018, 0.06
    rim = _RADIUS * np.column_stack([exact.cos(angle), exact.sin(angle)])
    for a, b in pairwise(rim):
        shell.quads([(*a, low), (*b, low), (*b, high), (*a, high)], _BUMPER)
        shell.quads([(*(0.9 * a), high), (*a, high), (*b, high), (*(0.9 * b), high)], _BUMPER)
    block(shell, (-0.085, 0.0, 0.08), (0.10, 0.15, 0.006), _BAY)
    if detail:
        block(shell, (0.03, 0.0, 0.0805), (0.02, 0.02, 0.004), _KEY)
        for y in (-0.05, 0.05):
            block(shell, (0.03, y, 0.0805), (0.014, 0.03, 0.004), _BUMPER)
        stack(shell, [(0.07, 0.012, 0.012, 0.14), (0.084, 0.01, 0.01, 0.14)], _BAY, 8)


def _wheels(shell: Shell, detail: int) -> None:
    wheel(shell, _WHEEL, 0.022, (-0.13, 0.13), (_TYRE, _HUB), detail)


_FIGURE = Figure(
    joints=(
        Joint(name="body", shape=_body),
        Joint(name="wheels", shape=_wheels, pivot=(0.0, 0.0, _WHEEL), spins=True),
    ),
    wheel_radius=_WHEEL,
)

MODEL = robot(
    TargetName.CREATE,
    size=(0.335, 0.335, 0.08),
    colour=(0.88, 0.88, 0.87),
    words="a white disc-shaped robot",
    motion="straight, turns away from obstacles",
    habit=Habit(Behaviour.WANDER, speed=0.5, acceleration=1.0, yaw_rate=2.0, radius=0.2),
    figure=_FIGURE,
)
