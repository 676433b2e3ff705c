"""Bioloid dog, built of servo motors and brackets."""

from art.jointed.figure import Figure, Gait, Joint, Leg, Swing
from art.jointed.model import robot
from art.jointed.outlines import block, matt
from eyas.engine.mesh.shell import Shell
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit

_BRACKET, _SERVO, _WHITE, _HORN = (
    matt(0.72, 0.73, 0.74), matt(0.10, 0.10, 0.11), matt(0.90, 0.90, 0.90), matt(0.50, 0.51, 0.53)
)  # fmt: skip
_HIP = 0.145
_UPPER, _LOWER = 0.09, 0.085


def _body(shell: Shell, detail: int) -> None:
    block(shell, (-0.01, 0.0, 0.0), (0.17, 0.09, 0.05), _WHITE)
    for x in (-0.11, 0.10):
        block(shell, (x, 0.06, -0.005), (0.052, 0.05, 0.044), _SERVO, both_sides=True)
        block(shell, (x, 0.0, -0.005), (0.03, 0.08, 0.03), _BRACKET)
    if detail:
        block(shell, (-0.01, 0.0, 0.028), (0.10, 0.06, 0.012), _SERVO)
        for x in (-0.11, 0.10):
            block(shell, (x, 0.11, -0.005), (0.04, 0.05, 0.05), _BRACKET, both_sides=True)


def _head(shell: Shell, detail: int) -> None:
    block(shell, (0.02, 0.0, 0.025), (0.05, 0.036, 0.046), _SERVO)
    block(shell, (0.058, 0.0, 0.03), (0.03, 0.06, 0.034), _WHITE)
    if detail:
        block(shell, (0.074, 0.018, 0.036), (0.006, 0.014, 0.014), _SERVO, both_sides=True)


def _tail(shell: Shell, detail: int) -> None:
    block(shell, (-0.03, 0.0, 0.01), (0.07, 0.016, 0.016), _BRACKET)


def _upper(shell: Shell, detail: int) -> None:
    block(shell, (0.0, 0.0, -0.005), (0.036, 0.05, 0.05), _SERVO)
    block(shell, (0.0, 0.0, -0.055), (0.028, 0.046, 0.05), _BRACKET)
    if detail:
        block(shell, (0.0, 0.0, -0.01), (0.02, 0.056, 0.02), _HORN)


def _lower(shell: Shell, detail: int) -> None:
    block(shell, (0.0, 0.0, 0.0), (0.034, 0.046, 0.04), _SERVO)
    shell.box((-0.013, -0.018, -_LOWER), (0.013, 0.018, -0.02), _BRACKET)
    foot = 0.02
    shell.ball((0.0, 0.0, -_LOWER), (foot, foot, foot), _SERVO, rows=2 + detail, sides=5 + detail)


def _leg(x: float, side: float, phase: float) -> Leg:
    return Leg(
        hip=(x, side * 0.125, _HIP - 0.004),
        foot=(x - 0.005, side * 0.148, 0.02),
        bones=(_UPPER, _LOWER),
        knee=(-1.0 if x > 0 else 1.0, 0.0, 0.0),
        phase=phase,
        shapes=(_upper, _lower, None),
    )


_FIGURE = Figure(
    joints=(
        Joint(name="body", shape=_body, pivot=(0.0, 0.0, _HIP)),
        Joint(name="head", shape=_head, parent="body", pivot=(0.13, 0.0, 0.0)),
        Joint(name="tail", shape=_tail, parent="body", pivot=(-0.135, 0.0, 0.0)),
    ),
    legs=(
        _leg(0.10, 1.0, 0.0),
        _leg(0.10, -1.0, 0.5),
        _leg(-0.11, 1.0, 0.5),
        _leg(-0.11, -1.0, 0.0),
    ),
    gait=Gait(
        stride=0.17, duty=0.5, lift=0.03, slowest=0.08, z=Swing(lean=-0.006, size=0.004, beats=2)
    ),
)
"""It trots: diagonal legs step together."""

MODEL = robot(
    TargetName.BIOLOID_DOG,
    size=(0.40, 0.35, 0.20),
    colour=(0.10, 0.10, 0.11),
    words="a robot dog of black motors and grey brackets",
    motion="trots",
    habit=Habit(Behaviour.STRAIGHT, speed=0.35, acceleration=0.7, yaw_rate=0.8, radius=0.5),
    figure=_FIGURE,
)
