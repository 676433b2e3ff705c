"""Mantis, a hexapod that carries its driver."""

import numpy as np

from art.jointed.figure import Figure, Gait, Joint, Leg, Swing
from art.jointed.model import robot
from art.jointed.outlines import bar, block, cylinder, matt, stack
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit

_DARK, _SILVER, _STEEL, _SEAT = (
    matt(0.25, 0.26, 0.28), matt(0.74, 0.75, 0.77), matt(0.46, 0.48, 0.50), matt(0.08, 0.08, 0.09)
)  # fmt: skip
_GLASS = Material(tint=(0.14, 0.16, 0.18), surface=Surface.GLASS)
_COXA, _FEMUR, _TIBIA = 0.3, 1.5, 1.6
_HIP = 0.95  # Height of the hips [m]


def _body(shell: Shell, detail: int) -> None:
    sides = (6, 6, 12)[detail]
    stack(shell, [(-0.22, 0.55, 0.42, 0.0), (0.0, 0.78, 0.62, 0.0), (0.14, 0.70, 0.55, 0.0)],
          _DARK, sides)  # fmt: skip
    # The cab: an open frame with a seat, and the engine behind it.
    block(shell, (0.18, 0.0, 0.30), (0.5, 0.5, 0.34), _SEAT)
    block(shell, (-0.02, 0.0, 0.62), (0.14, 0.48, 0.6), _SEAT)
    block(shell, (-0.48, 0.0, 0.38), (0.48, 0.72, 0.5), _STEEL, taper=0.05)
    shell.prism([(0.52, 0.12), (0.72, 0.12), (0.60, 0.66), (0.54, 0.66)], (-0.32, 0.32), _GLASS)
    roof = 1.0
    block(shell, (0.08, 0.0, roof), (0.86, 0.72, 0.06), _DARK)
    for x, foot in ((-0.30, -0.24), (0.46, 0.62)):
        bar(shell, (foot, 0.34, 0.12), (x, 0.34, roof), 0.035, _SILVER, both_sides=True)
    if detail:
        for y in (-0.2, 0.2):
            cylinder(shell, (-0.5, y, 0.68), 0.05, 0.4, _SILVER, 7, axis=0)
        block(shell, (0.56, 0.22, 0.20), (0.24, 0.06, 0.06), _SILVER, both_sides=True)
        block(shell, (0.52, 0.24, 1.02), (0.06, 0.12, 0.10), _SILVER, both_sides=True)


def _coxa(shell: Shell, detail: int) -> None:
    block(shell, (0.5 * _COXA, 0.0, 0.0), (_COXA, 0.2, 0.26), _STEEL)
    cylinder(shell, (_COXA, 0.0, 0.0), 0.15, 0.3, _SILVER, (5, 7, 10)[detail])


def _femur(shell: Shell, detail: int) -> None:
    _beam(shell, _FEMUR, (0.13, 0.10), detail)


def _tibia(shell: Shell, detail: int) -> None:
    _beam(shell, _TIBIA - 0.1, (0.11, 0.05), detail)
    tip = _TIBIA - 0.06
    shell.ball((0.0, 0.0, -tip), (0.1, 0.1, 0.1), _SEAT, rows=2 + detail, sides=5 + 2 * detail)


def _beam(shell: Shell, length: float, half: tuple[float, float], detail: int) -> None:
    """Add a bone: a tapered beam with the cylinder that moves it."""
    ends = []
    for z, size in ((-length, half[1]), (-0.55 * length, half[0]), (0.05, half[0])):
        across = 0.75 * size
        ends.append(
            [(size, -across, z), (size, across, z), (-size, across, z), (-size, -across, z)]
        )
    shell.rings(np.array(ends), _DARK)
    if detail:
        aside = half[0] + 0.06
        start, middle, end = (
            (aside, 0.0, -0.10),
            (aside, 0.0, -0.4 * length),
            (0.7 * aside, 0.0, -0.8 * length),
        )
        bar(shell, start, middle, 0.05, _SILVER, sides=4 + 2 * detail)
        bar(shell, middle, end, 0.028, _SILVER, sides=3 + detail)


def _leg(side: float, row: int) -> Leg:
    """Return a leg: side 1 left, -1 right; row 0 ahead, 1, or 2 behind."""
    x = (0.52, 0.0, -0.52)[row]
    foot = (2.14, 0.0, -2.14)[row]
    out = (1.5, 1.93, 1.5)[row]
    odd = (row + (side > 0)) % 2
    return Leg(
        hip=(x, side * (0.42 if row != 1 else 0.58), _HIP),
        foot=(foot, side * out, 0.1),
        bones=(_FEMUR, _TIBIA - 0.06),
        knee=(0.0, 0.0, 1.0),
        phase=0.5 * odd,
        shapes=(_femur, _tibia, None),
        coxa=(_COXA, _coxa),
    )


_FIGURE = Figure(
    joints=(Joint(name="body", shape=_body, pivot=(0.0, 0.0, _HIP)),),
    legs=tuple(_leg(side, row) for side in (1.0, -1.0) for row in range(3)),
    gait=Gait(
        stride=1.1,
        duty=0.53,
        lift=0.38,
        slowest=0.2,
        z=Swing(size=0.015, beats=2),
        roll=Swing(size=0.012),
    ),
)
"""It walks on three legs at a time: the first and last of one side, and the middle of the other."""

MODEL = robot(
    TargetName.MANTIS,
    size=(4.6, 4.3, 2.0),
    colour=(0.25, 0.26, 0.28),
    words="a dark grey walking machine on six legs",
    motion="walks on six legs, three at a time",
    habit=Habit(Behaviour.STRAIGHT, speed=0.55, acceleration=0.5, yaw_rate=0.4, radius=2.0),
    figure=_FIGURE,
)
