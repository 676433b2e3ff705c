"""Sojourner, the rover of the Mars Pathfinder mission."""

from art.jointed.figure import Figure, Joint
from art.jointed.model import robot
from art.jointed.outlines import bar, block, matt, wheel
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit

_FOIL, _PANEL, _CELL = matt(0.80, 0.55, 0.20), matt(0.07, 0.10, 0.27), matt(0.14, 0.19, 0.42)
_ARM, _WHEEL, _HUB, _WHITE = (
    matt(0.60, 0.57, 0.50), matt(0.52, 0.52, 0.53), matt(0.32, 0.32, 0.33), matt(0.86, 0.85, 0.82)
)  # fmt: skip
_LENS = Material(tint=(0.06, 0.06, 0.08), surface=Surface.GLASS)
_RADIUS, _WIDTH = 0.065, 0.075
_CORNER, _SIDE = 0.26, 0.20


def _body(shell: Shell, detail: int) -> None:
    shell.box((-0.18, -0.135, 0.12), (0.17, 0.135, 0.255), _FOIL, taper=0.015)
    # The panel on top, with its rows of cells.
    block(shell, (-0.03, 0.0, 0.283), (0.50, 0.40, 0.022), _PANEL)
    shell.box((-0.29, -0.21, 0.268), (0.24, 0.21, 0.275), _WHITE)
    if detail:
        for k in range(5):
            block(shell, (-0.23 + 0.1 * k, 0.0, 0.296), (0.085, 0.38, 0.004), _CELL)
        for y in (-0.05, 0.05):
            block(shell, (0.18, y, 0.20), (0.04, 0.035, 0.035), _LENS)
        block(shell, (-0.19, 0.0, 0.19), (0.05, 0.09, 0.09), _ARM)
    rocker, bogie = (-0.02, 0.155, 0.19), (0.13, _SIDE - 0.05, 0.13)
    bar(shell, rocker, (-_CORNER, _SIDE - 0.05, 0.10), 0.011, _ARM, both_sides=True)
    bar(shell, rocker, bogie, 0.011, _ARM, both_sides=True)
    for x in (0.0, _CORNER):
        bar(shell, bogie, (x, _SIDE - 0.05, 0.09), 0.01, _ARM, both_sides=True)
    if detail:
        for x in (-_CORNER, _CORNER):
            block(shell, (x, _SIDE - 0.052, 0.10), (0.035, 0.03, 0.08), _ARM, both_sides=True)


def _antenna(shell: Shell, detail: int) -> None:
    if detail:
        bar(shell, (0.0, 0.0, 0.0), (0.0, 0.0, 0.52), 0.007, _WHITE)
    else:
        bar(shell, (0.0, 0.0, 0.0), (0.0, 0.0, 0.52), 0.007, _WHITE, sides=3)


def _single(shell: Shell, detail: int) -> None:
    wheel(shell, _RADIUS, _WIDTH, (0.0,), (_WHEEL, _HUB), detail)
    if detail == 2:
        block(shell, (0.0, 0.0, 0.0), (2.02 * _RADIUS, 0.8 * _WIDTH, 0.012), _HUB)
        block(shell, (0.0, 0.0, 0.0), (0.012, 0.8 * _WIDTH, 2.02 * _RADIUS), _HUB)


def _pair(shell: Shell, detail: int) -> None:
    wheel(shell, _RADIUS, _WIDTH, (-_SIDE, _SIDE), (_WHEEL, _HUB), detail)


def _corner(x: float, y: float) -> Joint:
    return Joint(
        name=f"wheel at {x}, {y}", shape=_single, pivot=(x, y, _RADIUS), spins=True, steers=x
    )


_FIGURE = Figure(
    joints=(
        Joint(name="body", shape=_body),
        Joint(name="middle wheels", shape=_pair, pivot=(0.0, 0.0, _RADIUS), spins=True),
        *(_corner(x, y) for x in (_CORNER, -_CORNER) for y in (_SIDE, -_SIDE)),
        Joint(name="antenna", shape=_antenna, pivot=(-0.22, 0.15, 0.28)),
    ),
    wheel_radius=_RADIUS,
)

MODEL = robot(
    TargetName.SOJOURNER,
    size=(0.65, 0.48, 0.30),
    colour=(0.80, 0.55, 0.20),
    words="a gold robot rover under a solar panel",
    motion="straight",
    habit=Habit(Behaviour.STRAIGHT, speed=0.04, acceleration=0.1, yaw_rate=0.2, radius=0.3),
    figure=_FIGURE,
)
