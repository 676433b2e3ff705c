"""GhostDog, a galloping robot with a back that bends."""

from art.jointed.figure import Figure, Gait, Joint, Leg, Swing
from art.jointed.model import robot
from art.jointed.outlines import block, cylinder, matt
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit

_WHITE, _AMBER, _RED, _GREY = (
    matt(0.94, 0.94, 0.94), matt(1.0, 0.70, 0.02), matt(0.82, 0.06, 0.05), matt(0.45, 0.46, 0.48)
)  # fmt: skip
_LENS = Material(tint=(0.05, 0.05, 0.07), surface=Surface.GLASS)
_HIP, _SIDE = 0.285, 0.108
_BONE = 0.14
_FRONT, _REAR = 0.22, -0.24  # Forward of the hips of the legs [m]


def _chest(shell: Shell, detail: int) -> None:
    block(shell, (0.12, 0.0, 0.03), (0.30, 0.15, 0.12), _WHITE)
    _hips(shell, _FRONT - 0.02, detail)


def _croup(shell: Shell, detail: int) -> None:
    block(shell, (-0.15, 0.0, 0.02), (0.24, 0.14, 0.11), _WHITE)
    block(shell, (-0.01, 0.0, 0.03), (0.07, 0.07, 0.07), _GREY)
    _hips(shell, _REAR - 0.02 + 0.04, detail)


def _hips(shell: Shell, x: float, detail: int) -> None:
    cylinder(shell, (x, 0.0, 0.0), 0.035, 0.23, _AMBER, 5 + 3 * detail)


def _head(shell: Shell, detail: int) -> None:
    shell.prism([(-0.03, -0.12), (0.03, -0.12), (0.06, 0.0), (-0.01, 0.0)], (-0.035, 0.035), _WHITE)
    block(shell, (0.07, 0.0, 0.04), (0.16, 0.11, 0.09), _WHITE, taper=0.008)
    block(shell, (0.15, 0.0, 0.045), (0.02, 0.09, 0.05), _GREY)
    if detail:
        cylinder(shell, (0.16, 0.025, 0.045), 0.016, 0.03, _LENS, 5 + 2 * detail, axis=0)
        cylinder(shell, (0.16, -0.025, 0.045), 0.016, 0.03, _LENS, 5 + 2 * detail, axis=0)
        block(shell, (0.02, 0.04, 0.10), (0.03, 0.025, 0.04), _GREY, both_sides=True)


def _tail(shell: Shell, detail: int) -> None:
    shell.tube([(0.0, 0.0, 0.0), (-0.07, 0.0, 0.035)], (0.018, 0.008), _WHITE, sides=3 + detail)


def _upper(shell: Shell, detail: int) -> None:
    cylinder(shell, (0.0, 0.0, 0.0), 0.034, 0.06, _AMBER, 5 + 3 * detail)
    block(shell, (0.0, 0.0, -0.5 * _BONE), (0.06, 0.05, 0.11), _WHITE)


def _lower(shell: Shell, detail: int) -> None:
    cylinder(shell, (0.0, 0.0, 0.0), 0.028, 0.056, _AMBER, 5 + 3 * detail)
    block(shell, (0.0, 0.0, -0.5 * _BONE), (0.042, 0.04, 0.10), _WHITE)
    shell.ball((0.0, 0.0, -_BONE), (0.025, 0.028, 0.025), _RED, rows=2 + detail,
               sides=5 + 2 * detail)  # fmt: skip


def _leg(side: float, phase: float, *, front: bool) -> Leg:
    x = _FRONT - 0.0 if front else _REAR
    pivot = 0.04 if front else -0.04
    return Leg(
        parent="chest" if front else "croup",
        hip=(x - pivot, side * _SIDE, 0.0),
        foot=(x - 0.01, side * _SIDE, 0.025),
        bones=(_BONE, _BONE),
        knee=(-1.0 if front else 1.0, 0.0, 0.0),
        phase=phase,
        shapes=(_upper, _lower, None),
    )


_FIGURE = Figure(
    joints=(
        # The two halves of the body turn about joints in the back.
        Joint(name="chest", shape=_chest, pivot=(0.04, 0.0, _HIP), pitch=Swing(size=0.13)),
        Joint(
            name="croup", shape=_croup, pivot=(-0.04, 0.0, _HIP), pitch=Swing(size=0.13, phase=0.5)
        ),
        Joint(
            name="head",
            shape=_head,
            parent="chest",
            pivot=(0.22, 0.0, 0.10),
            pitch=Swing(size=0.12, phase=0.5),
        ),
        Joint(
            name="tail",
            shape=_tail,
            parent="croup",
            pivot=(-0.27, 0.0, 0.05),
            pitch=Swing(size=0.3),
        ),
    ),
    legs=(
        _leg(1.0, 0.02, front=False),
        _leg(-1.0, 0.90, front=False),
        _leg(1.0, 0.52, front=True),
        _leg(-1.0, 0.40, front=True),
    ),
    gait=Gait(
        stride=0.47,
        duty=0.4,
        lift=0.06,
        slowest=0.25,
        z=Swing(lean=-0.034, size=0.015, phase=0.55),
        pitch=Swing(size=0.08, phase=0.2),
    ),
)
"""It gallops: first the hind feet land, then the front feet, and it flies in between."""

MODEL = robot(
    TargetName.GHOST_DOG,
    size=(0.80, 0.28, 0.50),
    colour=(0.94, 0.94, 0.94),
    words="a white robot dog with red feet",
    motion="gallops",
    habit=Habit(Behaviour.STRAIGHT, speed=0.8, acceleration=1.0, yaw_rate=1.0, radius=0.8),
    figure=_FIGURE,
)
