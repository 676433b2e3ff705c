"""The kinds of people and robots."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.mesh.shell import Shell
from eyas.state.draw import DrawList
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.motion import ActorState
from eyas.state.scene import ObjectClass
from eyas.targets.config import TargetName
from eyas.targets.jointed.models import PEDESTRIAN_COLOURS, ROBOTS, JointedModel, pedestrian
from eyas.targets.jointed.people.people import PEOPLE, figure_of
from eyas.targets.jointed.rig import JointedRig
from eyas.targets.kind import Colour, Group, Kind, Looks

__all__ = ["JOINTED_KINDS"]


class BlockRig:
    """One block of the right size, at the heading of its actor."""

    slots = 1
    part_count = 1

    def __init__(self, model: JointedModel) -> None:
        self._model = model

    def part_levels(self) -> Sequence[tuple[Mesh, ...]]:
        """Return the meshes, see `Rig`."""
        x, y, z = self._model.size
        shell = Shell()
        shell.box((-x / 2, -y / 2, 0.0), (x / 2, y / 2, z), Material(surface=Surface.PAINT))
        return [(shell.mesh(),)]

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of it is from its reference point, see `Rig` [m]."""
        return float(parts.max())

    def pose(self, group: Group, actors: ActorState, looks: Looks, out: DrawList) -> None:
        """Write the slots of all actors, see `Rig`."""
        actor, slot = group.actor, group.slot
        present = actors.present[:, actor]
        cosine, sine = np.cos(actors.yaw[:, actor]), np.sin(actors.yaw[:, actor])
        pose = np.zeros((*present.shape, 3, 4), np.float32)
        pose[..., 0, 0], pose[..., 1, 1], pose[..., 2, 2] = cosine, cosine, 1.0
        pose[..., 0, 1], pose[..., 1, 0] = -sine, sine
        pose[..., 3] = actors.position[:, actor]
        out.part[:, slot] = np.where(present, group.first_part, -1)
        out.pose[:, slot], out.colour[:, slot] = pose, looks.colour[:, actor]


_COLOURS: dict[str, Colour] = {
    TargetName.SHRIMP: (0.19, 0.69, 1.0),
    TargetName.CREATE: (0.86, 0.86, 0.85),
    TargetName.SOJOURNER: (0.80, 0.58, 0.22),
    TargetName.MANTIS: (0.35, 0.36, 0.38),
    TargetName.BB_8: (0.92, 0.91, 0.88),
    TargetName.AIBO_ERS7: (0.92, 0.92, 0.93),
    TargetName.BIOLOID_DOG: (0.75, 0.75, 0.76),
    TargetName.FIRE_BIRD_6: (0.8, 0.4, 0.4),
    TargetName.SCOUT: (0.75, 0.75, 0.75),
    TargetName.GHOST_DOG: (0.93, 0.93, 0.93),
    TargetName.HOAP_2: (0.70, 0.71, 0.73),
}


def _kind(
    models: tuple[JointedModel, ...], colours: tuple[Colour, ...], object_class: ObjectClass
) -> Kind:
    return Kind(
        name=models[0].kind,
        models=models,
        colours=colours,
        object_class=object_class,
        rig=lambda: BlockRig(models[0]),
        keeps_colours=object_class is ObjectClass.ROBOT,
    )


JOINTED_KINDS: tuple[Kind, ...] = (
    Kind(
        name=TargetName.PEDESTRIAN.value,
        models=tuple(pedestrian(p.name, p.height, p.girth) for p in PEOPLE),
        colours=PEDESTRIAN_COLOURS,
        object_class=ObjectClass.PERSON,
        rig=lambda: JointedRig([figure_of(person) for person in PEOPLE]),
        keeps_colours=True,
    ),
    *(_kind((robot,), (_COLOURS[robot.kind],), ObjectClass.ROBOT) for robot in ROBOTS),
)
"""The pedestrian, then the robots in the order of `TargetName`."""
