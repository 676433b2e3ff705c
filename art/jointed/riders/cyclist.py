"""Cyclists: bicycles whose riders pedal.

A rider's hips rest on the saddle, hands on the grips, and feet go round with the pedals: one turn
of the cranks is 2.2 turns of the wheels (a chain of 40 to 18 teeth), so at 5 m/s 64 in a minute.
"""

from dataclasses import dataclass
from functools import partial

from art.cars.bicycle import AXLES, CRANK, PAINTS, SADDLE, WHEEL_RADIUS, add_frame, add_wheel
from art.jointed.figure import Figure, Gait, Joint, Leg, Swing
from art.jointed.model import JointedModel
from art.jointed.outlines import block, limb, matt, stack
from art.parts import Shape
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.targets.colour_names import colour_name
from eyas.engine.targets.habit import Behaviour, Habit
from eyas.engine.targets.kind import Colour

_NAME = "Cyclist"

_PEDAL = 0.165  # Length of the cranks [m]
_STRIDE = 2.2 * 2.0 * 3.141592653589793 * WHEEL_RADIUS
_HIP = (SADDLE[0] + 0.02, 0.0, SADDLE[1] + 0.10)
_LEAN = 0.5  # How far the trunk leans forward [rad]
_SHOULDER = (-0.01, 0.19, 0.43)  # The left one in the frame of the trunk [m]
_THIGH, _SHANK, _ANKLE = 0.44, 0.435, 0.085
_UPPER_ARM, _FOREARM = 0.30, 0.26
_WRIST = (0.27, 0.30, 1.10)  # The left one on its grip, in the model frame [m]
_BESIDE = 0.105  # From the middle of the bicycle to a foot [m]

_CLOTH = Material(texture="cloth", surface=Surface.PAINT)
_SHOE = matt(0.12, 0.11, 0.11)


@dataclass(frozen=True, slots=True)
class _Look:
    """What distinguishes a cyclist."""

    skin: Colour
    hair: Colour
    trousers: Colour
    paint: Colour  # Of the bicycle
    helmet: Colour | None = None
    bag: Colour | None = None


_PALE, _TAN, _DARK = (0.93, 0.74, 0.64), (0.78, 0.58, 0.44), (0.52, 0.35, 0.25)
_LOOKS = (
    _Look(_PALE, (0.26, 0.17, 0.11), (0.22, 0.29, 0.45), PAINTS[0], helmet=(0.85, 0.85, 0.83)),
    _Look(_TAN, (0.09, 0.08, 0.08), (0.17, 0.17, 0.19), PAINTS[1], bag=(0.15, 0.16, 0.20)),
    _Look(_DARK, (0.09, 0.08, 0.08), (0.66, 0.58, 0.45), PAINTS[2]),
    _Look(_PALE, (0.78, 0.62, 0.36), (0.12, 0.12, 0.13), PAINTS[3], helmet=(0.70, 0.12, 0.10)),
)
_COLOURS: tuple[Colour, ...] = (
    *((0.13, 0.27, 0.62), (0.72, 0.12, 0.11), (0.90, 0.88, 0.84), (0.13, 0.13, 0.15)),
    *((0.88, 0.72, 0.14), (0.34, 0.36, 0.21), (0.86, 0.42, 0.12), (0.45, 0.46, 0.48)),
)
"""Colours of jackets, sRGB."""

_HABIT = Habit(Behaviour.RIDE, speed=5.0, acceleration=2.5, yaw_rate=2.4, radius=2.5)


def _bicycle(shell: Shell, detail: int, look: _Look) -> None:
    add_frame(shell, matt(*look.paint), detail)


def _wheel(shell: Shell, detail: int) -> None:
    add_wheel(shell, detail)


def _trunk(shell: Shell, detail: int, look: _Look) -> None:
    """Add hips, chest and head; the origin is between the hips."""
    sides, rows = (5, 8, 12)[detail], (3, 5, 8)[detail]
    trousers, skin = matt(*look.trousers), matt(*look.skin)
    stack(shell, [(-0.1, 0.1, 0.13, 0.0), (0.02, 0.13, 0.18, 0.0)], trousers, sides, box=0.25)
    chest = [
        *((-0.03, 0.135, 0.185, 0.0), (0.16, 0.125, 0.18, -0.01), (0.34, 0.14, 0.2, 0.0)),
        *((0.44, 0.115, 0.2, -0.005), (0.5, 0.09, 0.15, 0.0), (0.53, 0.06, 0.07, 0.01)),
    ]
    stack(shell, chest if detail else chest[::2], _CLOTH, sides, box=0.25)
    neck = [(0.02, 0.0, 0.5), (0.07, 0.0, 0.62)]
    shell.tube(neck, (0.055, 0.052), skin, sides=max(sides - 2, 4))
    middle = (0.115, 0.0, 0.705)
    shell.ball(middle, (0.098, 0.078, 0.12), skin, rows=rows, sides=sides)
    top, size = look.helmet or look.hair, 1.13 if look.helmet else 1.0
    crown = (middle[0] - 0.015, 0.0, middle[2] + 0.035)
    half = (0.108 * size, 0.088 * size, 0.105 * size)
    shell.ball(crown, half, matt(*top), rows=rows, sides=sides)
    if look.bag is not None:
        shell.box((-0.30, -0.15, 0.06), (-0.12, 0.15, 0.46), matt(*look.bag), taper=0.03)


def _limb(length: float, radii: tuple[float, ...], cover: Material) -> Shape:
    def shape(shell: Shell, detail: int) -> None:
        limb(shell, length, radii if detail else radii[::2], cover, (4, 6, 9)[detail])

    return shape


def _forearm(shell: Shell, detail: int, look: _Look) -> None:
    limb(shell, _FOREARM, (0.046, 0.036), _CLOTH, (3, 5, 8)[detail])
    hand = (0.0, 0.0, -_FOREARM - 0.06)
    shell.ball(hand, (0.04, 0.035, 0.065), matt(*look.skin), rows=2 + detail, sides=4 + detail)


def _shoe(shell: Shell, detail: int) -> None:
    """Add a shoe on its pedal; the frame is level, with the origin at the ankle."""
    low = -_ANKLE
    profile = [(-0.07, low), (0.18, low), (0.19, low + 0.03), (0.05, 0.0), (-0.07, 0.01)]
    shell.prism(profile, (-0.045, 0.045), _SHOE)
    if detail:
        block(shell, (0.10, 0.0, low - 0.02), (0.09, 0.1, 0.025), _SHOE)


def _figure(look: _Look) -> Figure:
    thigh = _limb(_THIGH, (0.098, 0.088, 0.066), matt(*look.trousers))
    shank = _limb(_SHANK, (0.064, 0.062, 0.045), matt(*look.trousers))
    upper_arm, forearm = (
        _limb(_UPPER_ARM, (0.062, 0.052, 0.045), _CLOTH),
        partial(_forearm, look=look),
    )
    legs = []
    for side in (1.0, -1.0):
        legs.append(
            Leg(
                hip=(_HIP[0], 0.095 * side, _HIP[2]),
                foot=(CRANK[0] - 0.1, _BESIDE * side, CRANK[1] + _ANKLE + 0.03),
                bones=(_THIGH, _SHANK),
                knee=(1.0, 0.05 * side, 0.2),
                phase=0.0 if side > 0 else 0.5,
                shapes=(thigh, shank, _shoe),
                circle=_PEDAL,
            )
        )
        legs.append(
            Leg(
                parent="trunk of the rider",
                hip=(_SHOULDER[0], _SHOULDER[1] * side, _SHOULDER[2]),
                foot=(_WRIST[0], _WRIST[1] * side, _WRIST[2]),
                bones=(_UPPER_ARM, _FOREARM),
                knee=(-0.4, 0.35 * side, -0.9),
                phase=0.0,
                shapes=(upper_arm, forearm, None),
                circle=0.0,
            )
        )
    wheels = [
        Joint(name=f"wheel {k}", shape=_wheel, pivot=(x, 0.0, WHEEL_RADIUS), parent="ground",
              spins=True, steers=AXLES[0] - AXLES[1] if x > 0 else 0.0)
        for k, x in enumerate(AXLES)
    ]  # fmt: skip
    return Figure(
        joints=(
            Joint(name="bicycle", shape=partial(_bicycle, look=look), parent="ground"),
            *wheels,
            Joint(
                name="trunk of the rider",
                shape=partial(_trunk, look=look),
                pivot=_HIP,
                roll=Swing(size=0.03),
                pitch=Swing(rest=_LEAN),
            ),
        ),
        legs=tuple(legs),
        gait=Gait(stride=_STRIDE, slowest=0.3),
        wheel_radius=WHEEL_RADIUS,
    )


def _cyclist(number: int, look: _Look) -> JointedModel:
    figure = _figure(look)
    on = f"on a {colour_name(look.paint)} bicycle"
    return JointedModel(
        name=f"{_NAME}{number or ''}",
        typename=_NAME,
        kind=_NAME,
        size=(1.72, 0.72, 1.73),
        rise=1.0,
        words=("a cyclist in a {} jacket", f"a cyclist in a {{}} jacket {on}"),
        motion=f"rides along the kerb, {_HABIT.speed:g} m/s",
        speed=_HABIT.speed,
        stride=figure.period,
        figure=figure,
        habit=_HABIT,
        colours=_COLOURS,
    )


CYCLISTS: tuple[JointedModel, ...] = tuple(_cyclist(k, look) for k, look in enumerate(_LOOKS))
"""Their models in the catalogue."""
