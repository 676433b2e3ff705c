"""The people of the catalogue, and how they walk."""

from eyas.targets.colour_names import colour_name
from eyas.targets.config import TargetName
from eyas.targets.habit import Behaviour, Habit
from eyas.targets.jointed.figure import Figure, Gait, Joint, Leg, Swing
from eyas.targets.jointed.model import JointedModel
from eyas.targets.jointed.people.person import (
    ANKLE,
    HEEL,
    HIP,
    SHANK,
    SHOULDER,
    THIGH,
    TOES,
    UPPER_ARM,
    Garment,
    Hair,
    Person,
    PersonShapes,
    shapes_of_person,
)
from eyas.targets.kind import Colour

__all__ = ["PEDESTRIANS", "PEOPLE"]

_COLOURS: tuple[Colour, ...] = (
    (0.25, 0.55, 0.20),
    (0.72, 0.12, 0.11),
    (0.13, 0.27, 0.62),
    (0.90, 0.88, 0.84),
    (0.13, 0.13, 0.15),
    (0.88, 0.72, 0.14),
    (0.86, 0.42, 0.12),
    (0.45, 0.20, 0.50),
    (0.55, 0.56, 0.58),
    (0.12, 0.50, 0.52),
)
"""Colours of shirts and coats, sRGB; the first is the original's green."""

_BLACK, _BROWN, _BLOND, _GREY = (
    (0.09, 0.08, 0.08), (0.26, 0.17, 0.11), (0.78, 0.62, 0.36), (0.62, 0.61, 0.60)
)  # fmt: skip
_PALE, _TAN, _DARK, _DEEP = (
    (0.93, 0.74, 0.64), (0.78, 0.58, 0.44), (0.52, 0.35, 0.25), (0.34, 0.22, 0.16)
)  # fmt: skip
_JEANS, _BEIGE, _CHARCOAL, _OLIVE = (
    (0.22, 0.29, 0.45), (0.66, 0.58, 0.45), (0.17, 0.17, 0.19), (0.33, 0.34, 0.22)
)  # fmt: skip
_LEATHER, _WHITE = (0.30, 0.19, 0.12), (0.85, 0.85, 0.84)

PEOPLE: tuple[Person, ...] = (
    Person("Pedestrian", 1.80, 1.0, Garment.SHIRT, Hair.SHORT,
           skin=(1.0, 0.75, 0.7), hair_colour=_BROWN, trousers=(0.24, 0.25, 0.50),
           shoes=(0.35, 0.22, 0.13)),
    Person("Pedestrian2", 1.68, 0.94, Garment.COAT, Hair.LONG,
           skin=_PALE, hair_colour=_BROWN, trousers=_CHARCOAL, shoes=_LEATHER,
           length=0.43),
    Person("Pedestrian3", 1.77, 1.2, Garment.JACKET, Hair.SHORT,
           skin=_DARK, hair_colour=_BLACK, trousers=_BEIGE, shoes=_LEATHER),
    Person("Pedestrian4", 1.66, 0.92, Garment.DRESS, Hair.LONG,
           skin=_TAN, hair_colour=_BLOND, trousers=_TAN, shoes=_WHITE),
    Person("Pedestrian5", 1.86, 0.97, Garment.T_SHIRT, Hair.CAP,
           skin=_PALE, hair_colour=(0.16, 0.18, 0.24), trousers=_JEANS, shoes=_WHITE,
           length=0.5, bag=(0.20, 0.21, 0.23)),
    Person("Pedestrian6", 1.70, 0.98, Garment.T_SHIRT, Hair.BUN,
           skin=_DEEP, hair_colour=_BLACK, trousers=_BEIGE, shoes=_WHITE),
    Person("Pedestrian7", 1.74, 1.08, Garment.COAT, Hair.HAT,
           skin=_PALE, hair_colour=(0.25, 0.22, 0.19), trousers=_CHARCOAL, shoes=_LEATHER,
           length=0.48),
    Person("Pedestrian8", 1.72, 1.02, Garment.JACKET, Hair.SHORT,
           skin=_TAN, hair_colour=_GREY, trousers=_OLIVE, shoes=_LEATHER),
)  # fmt: skip
"""The first is the original's; the others differ in build, clothes, skin and hair."""

_STRIDE = 1.56
"""Of a person of 1.80 m [m]: 1.3 strides a second at the original's 2 m/s."""


def _figure(person: Person) -> Figure:
    """Return a person who walks."""
    s, g = person.scale, person.girth * person.scale
    shapes = shapes_of_person(person)
    return Figure(
        upright=True,
        joints=(
            Joint(
                name="torso",
                shape=shapes.torso,
                pivot=(0.0, 0.0, HIP * s),
                pitch=Swing(lean=0.04),
                yaw=Swing(size=0.07, phase=0.25),
            ),
            *_arm(shapes, s, g, 1.0),
            *_arm(shapes, s, g, -1.0),
        ),
        legs=(_leg(shapes, s, g, 1.0), _leg(shapes, s, g, -1.0)),
        gait=Gait(
            stride=_STRIDE * s,
            duty=0.58,
            lift=0.05 * s,
            shift=-0.05 * s,
            slowest=0.4,
            y=Swing(size=0.015 * s, phase=-0.04),
            # The body is lowest when both feet are on the ground.
            z=Swing(lean=-0.03 * s, size=0.02 * s, phase=-0.33, beats=2),
        ),
    )


def _arm(shapes: PersonShapes, s: float, g: float, side: float) -> tuple[Joint, Joint]:
    """Return upper arm and forearm of a side, 1 left, -1 right; they swing against the leg."""
    name = "left" if side > 0 else "right"
    phase = 0.25 if side > 0 else 0.75
    x, y, z = SHOULDER
    return (
        Joint(
            name=f"{name} arm",
            shape=shapes.upper_arm,
            parent="torso",
            pivot=(x, side * y * g, z * s),
            roll=Swing(rest=0.13 * side),
            pitch=Swing(rest=0.05, size=0.42, phase=phase),
        ),
        Joint(
            name=f"{name} forearm",
            shape=shapes.forearm,
            parent=f"{name} arm",
            pivot=(0.0, 0.0, -UPPER_ARM * s),
            roll=Swing(rest=-0.08 * side),
            pitch=Swing(rest=-0.22, lean=-0.2, size=0.2, phase=phase),
        ),
    )


def _leg(shapes: PersonShapes, s: float, g: float, side: float) -> Leg:
    hip = 0.095 * side * g
    # One foot stands a little ahead of the other.
    return Leg(
        hip=(0.0, hip, HIP * s),
        foot=(0.045 * side * s, 0.85 * hip, ANKLE * s),
        bones=(THIGH * s, SHANK * s),
        knee=(1.0, 0.1 * side, 0.0),
        phase=0.0 if side > 0 else 0.5,
        shapes=(shapes.thigh, shapes.shank, shapes.shoe),
        sole=(HEEL * s, TOES * s),
        roll=(0.35, 0.85),
    )


_HABIT = Habit(Behaviour.POLYLINE, speed=2.0, acceleration=2.0, yaw_rate=2.5, radius=1.0)

_HEADS = {
    Hair.SHORT: "short {} hair",
    Hair.LONG: "long {} hair",
    Hair.BUN: "a bun of {} hair",
    Hair.CAP: "a {} cap",
    Hair.HAT: "a {} hat",
}

_HAIR = {"beige": "blond"}
"""Colours that have another name on a head."""


def _words(person: Person) -> tuple[str, ...]:
    """Return what one wears, then also the rest of one's looks."""
    worn = f"a pedestrian in a {{}} {person.garment.value}"
    hair = colour_name(person.hair_colour)
    head = f"with {_HEADS[person.hair].format(_HAIR.get(hair, hair))}"
    if person.garment is Garment.DRESS:
        return worn, f"{worn}, {head}"
    below = f"{worn} and {colour_name(person.trousers)} trousers"
    return worn, below, f"{below}, {head}"


def _pedestrian(person: Person) -> JointedModel:
    """Return a pedestrian; the original's is 1.80 m high, its reference point at 1.27 m."""
    figure, name = _figure(person), TargetName.PEDESTRIAN.value
    return JointedModel(
        name=person.name,
        typename=name,
        kind=name,
        size=person.size,
        rise=1.27 / 1.8 * person.height,
        words=_words(person),
        motion=f"walks from point to point, {_HABIT.speed:g} m/s",
        speed=_HABIT.speed,
        stride=figure.period,
        figure=figure,
        habit=_HABIT,
        colours=_COLOURS,
    )


PEDESTRIANS: tuple[JointedModel, ...] = tuple(map(_pedestrian, PEOPLE))
"""Their models in the catalogue."""
