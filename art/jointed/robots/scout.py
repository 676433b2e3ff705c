"""Scout, a small walker on two legs that bend backwards."""

from art.jointed.figure import Figure, Gait, Joint, Leg, Swing
from art.jointed.model import robot
from art.jointed.outlines import block, cylinder, matt, stack
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit

_GREY, _RED, _MAGENTA, _GREEN, _FOOT = (
    matt(0.78, 0.78, 0.78), matt(0.67, 0.02, 0.02), matt(1.0, 0.05, 1.0), matt(0.10, 0.62, 0.16),
    matt(0.35, 0.35, 0.37),
)  # fmt: skip
_EYE = Material(tint=(0.05, 0.05, 0.07), surface=Surface.GLASS)
_HIP, _SIDE = 0.165, 0.05
_UPPER, _LOWER, _ANKLE = 0.085, 0.085, 0.022


def _body(shell: Shell, detail: int) -> None:
    block(shell, (0.0, 0.0, 0.0), (0.05, 0.06, 0.05), _MAGENTA)
    cylinder(shell, (0.0, 0.0, 0.005), 0.028, 0.15, _RED, 6 + 3 * detail)
    block(shell, (-0.02, 0.0, 0.035), (0.05, 0.05, 0.03), _MAGENTA)


def _head(shell: Shell, detail: int) -> None:
    rows, sides = 3 + 2 * detail, 6 + 3 * detail
    shell.ball((0.005, 0.0, 0.04), (0.056, 0.056, 0.05), _GREY, rows=rows, sides=sides)
    cylinder(shell, (0.0, 0.0, 0.04), 0.022, 0.122, _RED, 5 + 2 * detail)
    shell.ball((0.05, 0.0, 0.046), (0.016, 0.02, 0.016), _EYE, rows=3, sides=sides - 1)
    if detail:
        block(shell, (0.05, 0.024, 0.012), (0.05, 0.01, 0.01), _FOOT, both_sides=True)


def _upper(shell: Shell, detail: int) -> None:
    cylinder(shell, (0.0, 0.0, 0.0), 0.024, 0.036, _RED, 5 + 3 * detail)
    block(shell, (0.0, 0.0, -0.5 * _UPPER), (0.03, 0.024, 0.06), _MAGENTA)


def _lower(shell: Shell, detail: int) -> None:
    cylinder(shell, (0.0, 0.0, 0.0), 0.02, 0.034, _GREEN, 5 + 3 * detail)
    block(shell, (0.0, 0.0, -0.5 * _LOWER), (0.022, 0.02, 0.07), _GREY)


def _foot(shell: Shell, detail: int) -> None:
    cylinder(shell, (0.0, 0.0, 0.0), 0.016, 0.03, _GREEN, 5 + 2 * detail)
    low = -_ANKLE
    stack(shell, [(low, 0.05, 0.05, 0.0), (low + 0.008, 0.05, 0.05, 0.0),
                  (low + 0.016, 0.03, 0.03, 0.0)], _FOOT, (6, 9, 14)[detail])  # fmt: skip


def _leg(side: float) -> Leg:
    return Leg(
        hip=(0.0, side * _SIDE, _HIP),
        foot=(0.022 * side, side * _SIDE, _ANKLE),
        bones=(_UPPER, _LOWER),
        knee=(-1.0, 0.0, 0.0),
        phase=0.0 if side > 0 else 0.5,
        shapes=(_upper, _lower, _foot),
    )


_FIGURE = Figure(
    joints=(
        Joint(name="body", shape=_body, pivot=(0.0, 0.0, _HIP)),
        Joint(
            name="head",
            shape=_head,
            parent="body",
            pivot=(0.0, 0.0, 0.045),
            pitch=Swing(size=0.05, beats=2),
            roll=Swing(size=-0.08, phase=0.04),
        ),
    ),
    legs=(_leg(1.0), _leg(-1.0)),
    gait=Gait(
        stride=0.08,
        duty=0.62,
        lift=0.022,
        slowest=0.03,
        # Its weight moves over the foot that stands.
        y=Swing(size=0.022, phase=-0.06),
        z=Swing(lean=-0.008, size=0.003, beats=2),
        roll=Swing(size=0.10, phase=0.44),
    ),
)

MODEL = robot(
    TargetName.SCOUT,
    size=(0.15, 0.20, 0.30),
    colour=(0.67, 0.02, 0.02),
    words="a red and magenta robot walker with a grey head",
    motion="walks on two legs",
    habit=Habit(Behaviour.STRAIGHT, speed=0.08, acceleration=0.2, yaw_rate=0.4, radius=0.2),
    figure=_FIGURE,
)
