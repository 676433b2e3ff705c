"""HOAP-2, a small humanoid."""

from art.jointed.figure import Figure, Gait, Joint, Leg, Swing
from art.jointed.model import robot
from art.jointed.outlines import block, cylinder, limb, matt, stack
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit

_SILVER, _DARK, _BLUE, _LIGHT = (
    matt(0.66, 0.67, 0.70), matt(0.22, 0.23, 0.25), matt(0.14, 0.26, 0.66), matt(0.84, 0.85, 0.87)
)  # fmt: skip
_VISOR = Material(tint=(0.05, 0.06, 0.09), surface=Surface.GLASS)
_HIP, _SIDE = 0.232, 0.038
_THIGH, _SHANK, _ANKLE = 0.1, 0.1, 0.035
_UPPER_ARM, _FOREARM = 0.08, 0.09


def _torso(shell: Shell, detail: int) -> None:
    sides = (6, 8, 12)[detail]
    block(shell, (0.0, 0.0, 0.012), (0.07, 0.11, 0.045), _DARK)
    stack(shell, [(0.03, 0.035, 0.04, 0.0), (0.06, 0.05, 0.062, 0.0), (0.13, 0.052, 0.07, 0.0),
                  (0.155, 0.04, 0.055, 0.0)], _SILVER, sides, box=0.6)  # fmt: skip
    block(shell, (-0.055, 0.0, 0.10), (0.035, 0.10, 0.10), _DARK)
    cylinder(shell, (0.0, 0.0, 0.13), 0.025, 0.17, _LIGHT, 5 + 2 * detail)


def _head(shell: Shell, detail: int) -> None:
    rows, sides = 3 + 2 * detail, 6 + 3 * detail
    shell.tube([(0.0, 0.0, -0.02), (0.0, 0.0, 0.02)], (0.018, 0.018), _DARK, sides=5)
    shell.ball((0.0, 0.0, 0.045), (0.048, 0.042, 0.046), _BLUE, rows=rows, sides=sides)
    shell.ball((0.026, 0.0, 0.042), (0.03, 0.034, 0.024), _VISOR, rows=rows, sides=sides)
    if detail:
        block(shell, (0.0, 0.042, 0.042), (0.03, 0.01, 0.03), _LIGHT, both_sides=True)


def _upper_arm(shell: Shell, detail: int) -> None:
    limb(shell, _UPPER_ARM, (0.021, 0.019), _SILVER, (4, 6, 9)[detail])


def _forearm(shell: Shell, detail: int) -> None:
    limb(shell, 0.06, (0.02, 0.015), _SILVER, (4, 6, 9)[detail])
    block(shell, (0.0, 0.0, -_FOREARM), (0.026, 0.016, 0.035), _DARK)


def _thigh(shell: Shell, detail: int) -> None:
    limb(shell, _THIGH, (0.03, 0.027), _SILVER, (4, 6, 9)[detail])


def _shank(shell: Shell, detail: int) -> None:
    limb(shell, _SHANK, (0.027, 0.024), _LIGHT, (4, 6, 9)[detail])
    if detail:
        block(shell, (0.02, 0.0, -0.045), (0.016, 0.03, 0.05), _DARK)


def _foot(shell: Shell, detail: int) -> None:
    low = -_ANKLE
    shell.box((-0.042, -0.029, low), (0.062, 0.029, low + 0.018), _DARK, taper=0.003)
    block(shell, (0.0, 0.0, -0.006), (0.036, 0.036, 0.03), _LIGHT)


def _leg(side: float) -> Leg:
    return Leg(
        hip=(0.0, side * _SIDE, _HIP),
        foot=(0.04 * side, side * _SIDE, _ANKLE),
        bones=(_THIGH, _SHANK),
        knee=(1.0, 0.0, 0.0),
        phase=0.0 if side > 0 else 0.5,
        shapes=(_thigh, _shank, _foot),
    )


def _arm(side: float) -> tuple[Joint, Joint]:
    name, phase = ("left", 0.25) if side > 0 else ("right", 0.75)
    return (
        Joint(
            name=f"{name} arm",
            shape=_upper_arm,
            parent="torso",
            pivot=(0.0, side * 0.095, 0.13),
            roll=Swing(rest=0.12 * side),
            pitch=Swing(rest=0.1, size=0.2, phase=phase),
        ),
        Joint(
            name=f"{name} forearm",
            shape=_forearm,
            parent=f"{name} arm",
            pivot=(0.0, 0.0, -_UPPER_ARM),
            roll=Swing(rest=-0.1 * side),
            pitch=Swing(rest=-0.45),
        ),
    )


_FIGURE = Figure(
    joints=(
        Joint(name="torso", shape=_torso, pivot=(0.0, 0.0, _HIP)),
        Joint(name="head", shape=_head, parent="torso", pivot=(0.0, 0.0, 0.17)),
        *_arm(1.0),
        *_arm(-1.0),
    ),
    legs=(_leg(1.0), _leg(-1.0)),
    gait=Gait(
        stride=0.06,
        duty=0.64,
        lift=0.02,
        slowest=0.02,
        # It sways over the foot that stands, with bent knees.
        y=Swing(size=0.024, phase=-0.07),
        z=Swing(lean=-0.012),
        roll=Swing(size=0.06, phase=0.43),
    ),
)

MODEL = robot(
    TargetName.HOAP_2,
    size=(0.20, 0.25, 0.48),
    colour=(0.66, 0.67, 0.70),
    words="a silver humanoid robot with a blue head",
    motion="walks on two legs, then stops",
    habit=Habit(
        Behaviour.STOP, speed=0.05, acceleration=0.1, yaw_rate=0.4, radius=0.2, distance=1.5
    ),
    figure=_FIGURE,
)
