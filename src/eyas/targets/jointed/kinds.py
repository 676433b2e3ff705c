"""The kinds of people and robots."""

import numpy as np
from numpy.typing import NDArray

from eyas.state.scene import ObjectClass
from eyas.targets.config import TargetName
from eyas.targets.jointed.extent import extents_of
from eyas.targets.jointed.figure import Figure
from eyas.targets.jointed.models import PEDESTRIAN_COLOURS, pedestrian, robot
from eyas.targets.jointed.people.people import PEOPLE, figure_of
from eyas.targets.jointed.rig import JointedRig
from eyas.targets.jointed.robots.aibo import AIBO
from eyas.targets.jointed.robots.bb8 import BB8
from eyas.targets.jointed.robots.bioloid import BIOLOID_DOG
from eyas.targets.jointed.robots.create import CREATE
from eyas.targets.jointed.robots.firebird import FIRE_BIRD
from eyas.targets.jointed.robots.ghostdog import GHOST_DOG
from eyas.targets.jointed.robots.hoap import HOAP
from eyas.targets.jointed.robots.mantis import MANTIS
from eyas.targets.jointed.robots.scout import SCOUT
from eyas.targets.jointed.robots.shrimp import SHRIMP
from eyas.targets.jointed.robots.sojourner import SOJOURNER
from eyas.targets.kind import Colour, Kind

__all__ = ["FIGURES", "JOINTED_KINDS"]

_ROBOTS: dict[TargetName, tuple[Figure, Colour]] = {
    TargetName.SHRIMP: (SHRIMP, (0.19, 0.69, 1.0)),
    TargetName.CREATE: (CREATE, (0.88, 0.88, 0.87)),
    TargetName.SOJOURNER: (SOJOURNER, (0.80, 0.55, 0.20)),
    TargetName.MANTIS: (MANTIS, (0.25, 0.26, 0.28)),
    TargetName.BB_8: (BB8, (0.90, 0.89, 0.86)),
    TargetName.AIBO_ERS7: (AIBO, (0.93, 0.93, 0.94)),
    TargetName.BIOLOID_DOG: (BIOLOID_DOG, (0.10, 0.10, 0.11)),
    TargetName.FIRE_BIRD_6: (FIRE_BIRD, (0.80, 0.40, 0.40)),
    TargetName.SCOUT: (SCOUT, (0.67, 0.02, 0.02)),
    TargetName.GHOST_DOG: (GHOST_DOG, (0.94, 0.94, 0.94)),
    TargetName.HOAP_2: (HOAP, (0.66, 0.67, 0.70)),
}
"""Figure and main colour of each robot."""

FIGURES: dict[str, Figure] = {
    **{person.name: figure_of(person) for person in PEOPLE},
    **{name.value: figure for name, (figure, _) in _ROBOTS.items()},
}
"""The figure of each model, by its name."""


def _extent(name: str, travelled: float, speed: float) -> NDArray[np.float64]:
    return extents_of(FIGURES[name]).at(travelled, speed)


def _robot(name: TargetName) -> Kind:
    figure, colour = _ROBOTS[name]
    return Kind(
        name=name.value,
        models=(robot(name, figure.period),),
        colours=(colour,),
        object_class=ObjectClass.ROBOT,
        rig=lambda: JointedRig([figure]),
        extent=_extent,
        keeps_colours=True,
    )


_PEDESTRIAN = Kind(
    name=TargetName.PEDESTRIAN.value,
    models=tuple(pedestrian(one.name, one.size, FIGURES[one.name].period) for one in PEOPLE),
    colours=PEDESTRIAN_COLOURS,
    object_class=ObjectClass.PERSON,
    rig=lambda: JointedRig([FIGURES[one.name] for one in PEOPLE]),
    extent=_extent,
    keeps_colours=True,
)

JOINTED_KINDS: tuple[Kind, ...] = (_PEDESTRIAN, *map(_robot, _ROBOTS))
"""The pedestrian, then the robots in the order of `TargetName`."""
