"""BB-8, a ball that rolls under a head that stays up."""

import numpy as np

from art.jointed.figure import Figure, Gait, Joint, Swing
from art.jointed.model import robot
from art.jointed.outlines import bar, block, matt, stack
from eyas.engine.mesh.shell import Shell
from eyas.engine.mesh.solids import sphere
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit
from eyas.lanes import exact

_WHITE, _ORANGE, _GREY = matt(0.90, 0.89, 0.86), matt(0.90, 0.45, 0.10), matt(0.50, 0.51, 0.53)
_EYE = Material(tint=(0.03, 0.03, 0.05), surface=Surface.GLASS)
_RADIUS = 0.25
_RINGS = ((0.20, _GREY), (0.30, _WHITE), (0.47, _ORANGE))
"""Angle from the middle of each of six panels up to which it has a colour [rad]."""


def _ball(shell: Shell, detail: int) -> None:
    mesh = sphere(1 + detail, _WHITE)
    corners = _RADIUS * mesh.positions[mesh.triangles].astype(np.float64)
    middle = corners.mean(axis=1)
    toward = np.abs(middle).max(axis=1) / np.linalg.norm(middle, axis=1)
    angle = exact.acos(np.clip(toward, 0.0, 1.0))
    inner = 0.0
    for outer, material in (*(_RINGS if detail else ((0.40, _ORANGE),)), (9.0, _WHITE)):
        chosen = (angle >= inner) & (angle < outer)
        if chosen.any():
            shell.triangles(corners[chosen], material)
        inner = outer


def _head(shell: Shell, detail: int) -> None:
    sides = (7, 12, 20)[detail]

    def rows(*of: tuple[float, float]) -> list[tuple[float, float, float, float]]:
        return [(z, radius, radius, 0.0) for z, radius in of]

    stack(shell, rows((-0.045, 0.10), (-0.01, 0.145)), _GREY, sides)
    stack(shell, rows((-0.01, 0.15), (0.022, 0.15)), _ORANGE, sides)
    dome = rows((0.022, 0.149), (0.07, 0.138), (0.115, 0.107), (0.146, 0.06), (0.155, 0.02))
    stack(shell, dome if detail else [dome[0], dome[2], dome[4]], _WHITE, sides)
    shell.ball((0.128, 0.0, 0.068), (0.035, 0.042, 0.042), _EYE, rows=3 + detail, sides=6)
    if detail:
        stack(shell, rows((0.100, 0.1235), (0.118, 0.109)), _ORANGE, sides, caps=False)
        block(shell, (0.14, -0.05, 0.035), (0.03, 0.024, 0.024), _EYE)


def _antenna(shell: Shell, detail: int) -> None:
    for y, top in ((0.03, 0.14), (-0.02, 0.07)):
        bar(shell, (0.0, y, 0.0), (0.0, y, top), 0.004, _GREY, sides=3 + (detail > 0))


_FIGURE = Figure(
    joints=(
        Joint(name="ball", shape=_ball, parent="ground", pivot=(0.0, 0.0, _RADIUS), spins=True),
        Joint(name="neck", shape=None, pivot=(0.0, 0.0, _RADIUS), pitch=Swing(lean=0.16)),
        Joint(name="head", shape=_head, parent="neck", pivot=(0.0, 0.0, 0.275)),
        Joint(name="antenna", shape=_antenna, parent="head", pivot=(-0.03, 0.0, 0.14)),
    ),
    gait=Gait(slowest=0.5),
    wheel_radius=_RADIUS,
)

MODEL = robot(
    TargetName.BB_8,
    size=(0.50, 0.50, 0.68),
    colour=(0.90, 0.89, 0.86),
    words="a white and orange robot that rolls on a ball",
    motion="weaves",
    habit=Habit(Behaviour.WEAVE, speed=1.0, acceleration=1.0, yaw_rate=1.5, radius=0.5),
    figure=_FIGURE,
)
