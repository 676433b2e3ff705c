"""AIBO ERS-7, a robot puppy."""

from art.jointed.figure import Figure, Gait, Joint, Leg, Swing
from art.jointed.model import robot
from art.jointed.outlines import limb, matt
from art.parts import Shape
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit

_WHITE, _BLACK, _BLUE, _GREY = (
    matt(0.93, 0.93, 0.94), matt(0.09, 0.09, 0.10), matt(0.55, 0.74, 0.90), matt(0.66, 0.67, 0.69)
)  # fmt: skip
_FACE = Material(tint=(0.04, 0.04, 0.05), surface=Surface.GLASS)
_HIP = 0.135
_UPPER, _LOWER = 0.070, 0.077


def _body(shell: Shell, detail: int) -> None:
    rows, sides = 3 + 2 * detail, 6 + 3 * detail
    shell.ball((0.0, 0.0, 0.0), (0.105, 0.052, 0.045), _WHITE, rows=rows, sides=sides)
    shell.ball((0.0, 0.0, 0.016), (0.085, 0.034, 0.038), _BLUE, rows=rows, sides=sides)
    if detail:
        shell.tube([(0.07, 0.0, 0.01), (0.10, 0.0, 0.075)], (0.025, 0.02), _GREY, sides=sides - 2)


def _head(shell: Shell, detail: int) -> None:
    rows, sides = 3 + 2 * detail, 6 + 3 * detail
    shell.ball((0.0, 0.0, 0.02), (0.045, 0.042, 0.038), _WHITE, rows=rows, sides=sides)
    shell.ball((0.028, 0.0, 0.008), (0.034, 0.034, 0.027), _FACE, rows=rows, sides=sides)
    # The ears hang from the sides.
    path = [(-0.01, 0.042, 0.035), (-0.02, 0.058, -0.005), (-0.022, 0.058, -0.03)]
    shell.tube(path, (0.012, 0.015, 0.006), _BLACK, sides=3 + detail, both_sides=True)


def _tail(shell: Shell, detail: int) -> None:
    shell.tube([(0.0, 0.0, 0.0), (-0.04, 0.0, 0.055)], (0.008, 0.004), _BLACK, sides=3 + detail)


def _upper(shell: Shell, detail: int) -> None:
    limb(shell, _UPPER, (0.03, 0.024), _WHITE, (4, 6, 9)[detail])


def _lower(shell: Shell, detail: int) -> None:
    limb(shell, _LOWER - 0.02, (0.021, 0.017), _WHITE, (4, 6, 9)[detail])
    paw = 0.024
    shell.ball((0.0, 0.0, -_LOWER), (paw, paw, paw), _BLACK, rows=2 + detail,
               sides=5 + 2 * detail)  # fmt: skip


def _leg(x: float, side: float, phase: float) -> Leg:
    shapes: tuple[Shape, Shape, None] = (_upper, _lower, None)
    # Elbows point back, knees forward.
    return Leg(
        hip=(x, side * 0.058, _HIP),
        foot=(x - 0.012, side * 0.065, 0.024),
        bones=(_UPPER, _LOWER),
        knee=(-1.0 if x > 0 else 1.0, 0.0, 0.0),
        phase=phase,
        shapes=shapes,
    )


_FIGURE = Figure(
    joints=(
        Joint(name="body", shape=_body, pivot=(0.0, 0.0, 0.15)),
        Joint(
            name="head",
            shape=_head,
            parent="body",
            pivot=(0.105, 0.0, 0.072),
            pitch=Swing(size=0.06, beats=2),
            yaw=Swing(size=0.12),
        ),
        Joint(
            name="tail",
            shape=_tail,
            parent="body",
            pivot=(-0.098, 0.0, 0.015),
            yaw=Swing(size=0.5),
            roll=Swing(size=0.4, beats=2),
        ),
    ),
    legs=(
        _leg(0.075, 1.0, 0.75),
        _leg(0.075, -1.0, 0.25),
        _leg(-0.075, 1.0, 0.0),
        _leg(-0.075, -1.0, 0.5),
    ),
    gait=Gait(
        stride=0.085,
        duty=0.72,
        lift=0.02,
        slowest=0.03,
        y=Swing(size=0.006, phase=0.1),
        z=Swing(lean=-0.008, size=0.002, beats=2),
        roll=Swing(size=0.05, phase=0.1),
    ),
)
"""It walks one foot after the other: each hind foot before the front foot of its side."""

MODEL = robot(
    TargetName.AIBO_ERS7,
    size=(0.32, 0.18, 0.28),
    colour=(0.93, 0.93, 0.94),
    words="a white robot puppy with a black face",
    motion="walks, then stands",
    habit=Habit(
        Behaviour.STOP, speed=0.1, acceleration=0.3, yaw_rate=0.6, radius=0.3, distance=2.5
    ),
    figure=_FIGURE,
)
