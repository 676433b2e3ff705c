"""What a model of a person or robot is.

Sizes, colours and speeds are those of the original's models in Webots. Model frame: x forward, y
left, z up, origin on the ground below the middle.
"""

from dataclasses import dataclass

from art.jointed.figure import Figure
from art.model import DrawnModel
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Habit
from eyas.engine.targets.kind import Colour


@dataclass(frozen=True, slots=True, kw_only=True)
class JointedModel(DrawnModel):
    """One model of a person or robot."""

    figure: Figure  # How it is built and how it moves
    habit: Habit  # How it moves by itself
    colours: tuple[Colour, ...]  # Colours that it may have, sRGB
    part_colours: tuple[Colour | None, ...] = ()
    """Colours of its drawn parts, sRGB, in the order of `cycle.shapes_of`; None, or none at all:
    the one that it has of `colours`."""


def robot(
    name: TargetName,  # The original's name
    *,
    size: tuple[float, float, float],  # Length, width and height without antennas [m]
    colour: Colour,  # Its main colour
    words: str,  # What it is, "a white robot dog"
    motion: str,  # What its habit is, in words
    habit: Habit,  # How it moves by itself
    figure: Figure,  # How it is built
) -> JointedModel:
    """Return a robot; its reference point is in the middle of its height."""
    return JointedModel(
        name=name.value,
        typename=name.value,
        kind=name.value,
        size=size,
        rise=size[2] / 2,
        words=(words, f"{words} ({name.value})"),
        motion=f"{motion}, {habit.speed:g} m/s",
        speed=habit.speed,
        stride=figure.period,
        figure=figure,
        habit=habit,
        colours=(colour,),
    )
