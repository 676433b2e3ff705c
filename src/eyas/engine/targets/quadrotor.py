"""A quadrotor: a target, and what the trackers of a shared world look like to each other."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.habit import Behaviour, Habit
from eyas.engine.targets.kind import Group, Kind, Looks, Model
from eyas.engine.targets.shapes import flier_levels
from eyas.lanes import exact

_MIDDLE = 0.055  # Height of its middle over its lowest point, where it is as an actor [m]


def quadrotor_levels() -> tuple[Mesh, ...]:
    """Return the levels of detail, the finest first; x is forward, the origin in the middle."""
    (levels,) = flier_levels("quadrotor")
    return levels


class QuadrotorRig:
    """One part, at the heading of its actor; `eyas.engine.sim.views.additions` poses
    trackers, which may tilt.
    """

    slots = 1
    part_count = 1

    def part_levels(self) -> Sequence[tuple[Mesh, ...]]:
        """Return the meshes, see `Rig`."""
        return [quadrotor_levels()]

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of it is from its middle, see `Rig` [m]."""
        return float(parts.max())

    def pose(self, group: Group, actors: ActorState, looks: Looks, out: DrawList) -> None:
        """Write the slots of all actors, see `Rig`."""
        actor, slot = group.actor, group.slot
        present = actors.present[:, actor]
        cosine, sine = exact.cos(actors.yaw[:, actor]), exact.sin(actors.yaw[:, actor])
        pose = np.zeros((*present.shape, 3, 4), np.float32)
        pose[..., 0, 0], pose[..., 1, 1], pose[..., 2, 2] = cosine, cosine, 1.0
        pose[..., 0, 1], pose[..., 1, 0] = -sine, sine
        pose[..., 3] = actors.position[:, actor]
        pose[..., 2, 3] += _MIDDLE
        out.part[:, slot] = np.where(present, group.first_part, -1)
        out.pose[:, slot], out.colour[:, slot] = pose, looks.colour[:, actor]


QUADROTOR = Kind(
    name="Quadrotor",
    models=(
        Model(
            name="Quadrotor",
            typename="Quadrotor",
            kind="Quadrotor",
            size=(0.405, 0.445, 0.11),  # with its rotors, as a DJI Mavic 2
            rise=_MIDDLE,
            words=("a grey drone", "a grey drone (Quadrotor)"),
            motion="flies",
            speed=6.0,
            stride=1.0,
        ),
    ),
    colours=((1.0, 1.0, 1.0),),
    object_class=ObjectClass.ROBOT,
    rig=QuadrotorRig,
    keeps_colours=True,
    flies=True,
    habit=Habit(Behaviour.CRUISE, speed=6.0, acceleration=3.0, yaw_rate=2.0, radius=6.0),
)
"""The kind in the catalogue."""
