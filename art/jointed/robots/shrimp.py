"""Shrimp, a rover on six wheels: one on a fork ahead, one behind, and two on a bogie each side."""

import math

from art.jointed.figure import Figure, Joint
from art.jointed.model import robot
from art.jointed.outlines import bar, block, matt, wheel
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit

_BLUE = Material(tint=(0.19, 0.69, 1.0), surface=Surface.PAINT)
_ROD, _TYRE, _HUB, _DARK = (
    matt(0.62, 0.64, 0.67), matt(0.09, 0.09, 0.10), matt(0.55, 0.57, 0.6), matt(0.16, 0.17, 0.19)
)  # fmt: skip
_RADIUS, _WIDTH = 0.058, 0.05
_END, _BOGIE, _SIDE = 0.262, 0.105, 0.18
"""Forward of the end wheels; forward and left of the bogies' wheels [m]."""


def _body(shell: Shell, detail: int) -> None:
    profile = [(-0.15, 0.10), (0.11, 0.10), (0.16, 0.15), (0.12, 0.21), (-0.10, 0.22),
               (-0.17, 0.17)]  # fmt: skip
    shell.prism(profile, (-0.075, 0.075), _BLUE)
    # The fork ahead: two bars to the front wheel, as a parallelogram.
    bar(shell, (0.13, 0.038, 0.19), (_END, 0.038, _RADIUS), 0.008, _ROD, both_sides=True)
    bar(shell, (-0.14, 0.038, 0.16), (-_END, 0.038, _RADIUS), 0.01, _ROD, both_sides=True)
    for x in (-_BOGIE, _BOGIE):
        knee = (0.35 * x, _SIDE - 0.045, 0.145)
        bar(shell, knee, (x, _SIDE - 0.045, _RADIUS), 0.009, _ROD, both_sides=True)
    block(shell, (0.0, 0.105, 0.145), (0.09, 0.06, 0.03), _ROD, both_sides=True)
    if detail:
        block(shell, (-0.01, 0.0, 0.222), (0.16, 0.11, 0.012), _DARK)
        block(shell, (0.06, 0.0, 0.232), (0.02, 0.02, 0.016), _TYRE)
        bar(shell, (0.13, 0.038, 0.135), (_END - 0.04, 0.038, 0.1), 0.006, _ROD, both_sides=True)
        block(shell, (0.19, 0.0, 0.165), (0.02, 0.09, 0.02), _ROD)


def _single(shell: Shell, detail: int) -> None:
    wheel(shell, _RADIUS, _WIDTH, (0.0,), (_TYRE, _HUB), detail)


def _pair(shell: Shell, detail: int) -> None:
    wheel(shell, _RADIUS, _WIDTH, (-_SIDE, _SIDE), (_TYRE, _HUB), detail)


def _wheel_at(name: str, x: float, *, steers: bool) -> Joint:
    return Joint(
        name=name,
        shape=_single if steers else _pair,
        pivot=(x, 0.0, _RADIUS),
        spins=True,
        steers=x if steers else 0.0,
    )


_FIGURE = Figure(
    joints=(
        Joint(name="body", shape=_body),
        _wheel_at("front wheel", _END, steers=True),
        _wheel_at("rear wheel", -_END, steers=True),
        _wheel_at("front bogie wheels", _BOGIE, steers=False),
        _wheel_at("rear bogie wheels", -_BOGIE, steers=False),
    ),
    wheel_radius=_RADIUS,
)

MODEL = robot(
    TargetName.SHRIMP,
    size=(0.64, 0.41, 0.24),
    colour=(0.19, 0.69, 1.0),
    words="a blue robot rover on six wheels",
    motion="straight, turns, then stops",
    habit=Habit(
        Behaviour.STOP,
        speed=0.26,
        acceleration=0.5,
        yaw_rate=0.35,
        radius=0.75,
        distance=4.6,
        turn=math.radians(-75),
    ),
    figure=_FIGURE,
)
