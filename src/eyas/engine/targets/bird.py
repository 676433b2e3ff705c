"""A bird, which flies between camera and street: a body and two wings that beat."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.kind import Group, Kind, Looks, Model
from eyas.engine.targets.shapes import flier_levels
from eyas.lanes import exact

_MIDDLE = 0.35
"""Height of the body's middle over the reference point, below which wings do not beat [m]."""
_SHOULDER = (0.04, 0.035, 0.02)  # Forward, left and up of the left one, from the middle [m]
_BEAT = 0.62  # Largest angle of the wings over the horizontal [rad]
_STRIDE = 3.2
"""Way in one beat [m]: at 11 m/s they beat 3.4 times a second, as gulls do (Pennycuick, Wingbeat
frequency of birds in steady cruising flight, Journal of Experimental Biology 199, 1996)."""
_GLIDING = 11.0  # Beats from a glide to the next
_GRAVITY = 9.81


class BirdRig:
    """Three parts: the body and the wings. It banks in turns, and glides now and then."""

    slots = 3
    part_count = 3

    def part_levels(self) -> Sequence[tuple[Mesh, ...]]:
        """Return the meshes, see `Rig`."""
        return flier_levels("bird")

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of it is from its reference point, see `Rig` [m]."""
        return float(parts.max()) + _MIDDLE + float(exact.length(_SHOULDER))

    def pose(self, group: Group, actors: ActorState, looks: Looks, out: DrawList) -> None:
        """Write the slots of all actors, see `Rig`."""
        actor = group.actor
        present = actors.present[:, actor]
        body = _turned(
            actors.yaw[:, actor],
            actors.slope[:, actor],
            _bank(actors.speed[:, actor], actors.yaw_rate[:, actor]),
        )
        middle = actors.position[:, actor] + np.array([0.0, 0.0, _MIDDLE])
        angle = _angle(actors.travelled[:, actor])
        for part, side in enumerate((0.0, 1.0, -1.0)):
            slot, pose = group.slot + part, np.zeros((*present.shape, 3, 4), np.float32)
            pose[..., :3], pose[..., 3] = body, middle
            if side != 0.0:
                cosine, sine = exact.cos(angle)[..., None], side * exact.sin(angle)[..., None]
                left, up = body[..., 1], body[..., 2]
                pose[..., 1], pose[..., 2] = cosine * left + sine * up, cosine * up - sine * left
                x, y, z = _SHOULDER
                pose[..., 3] += x * body[..., 0] + side * y * left + z * up
            out.part[:, slot] = np.where(present, group.first_part + part, -1)
            out.pose[:, slot], out.colour[:, slot] = pose, looks.colour[:, actor]


def _angle(travelled: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle of the wings over the horizontal [rad]."""
    turn = travelled * (2.0 * np.pi / _STRIDE)
    beating = np.clip(0.75 + 0.9 * exact.cos(turn / _GLIDING), 0.0, 1.0)
    angle: NDArray[np.float64] = 0.12 + (_BEAT - 0.12) * beating * exact.sin(turn)
    return angle


def _bank(speed: NDArray[np.float64], yaw_rate: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the roll of a turn without side slip [rad], positive to the left."""
    ratio = np.clip(speed * yaw_rate / _GRAVITY, -1.2, 1.2)
    bank: NDArray[np.float64] = exact.atan2(ratio, np.ones_like(ratio))
    return bank


def _turned(
    yaw: NDArray[np.float64], pitch: NDArray[np.float64], bank: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return body to world; columns forward, left, up, shape (..., 3, 3)."""
    cy, sy, cp, sp = exact.cos(yaw), exact.sin(yaw), exact.cos(pitch), exact.sin(pitch)
    cb, sb = exact.cos(bank)[..., None], exact.sin(bank)[..., None]
    forward = np.stack([cy * cp, sy * cp, sp], axis=-1)
    left = np.stack([-sy, cy, np.zeros_like(cy)], axis=-1)
    up = np.stack([-cy * sp, -sy * sp, cp], axis=-1)
    # To the left: the left side goes down.
    return np.stack([forward, cb * left - sb * up, cb * up + sb * left], axis=-1)


BIRD = Kind(
    name="bird",
    models=(
        Model(
            name="Bird",
            typename="Bird",
            kind="bird",
            size=(0.53, 1.2, 0.7),  # a gull's, with room for its wings' beat
            rise=_MIDDLE,
            words=("a {} bird",),
            motion="flies",
            speed=11.0,
            stride=_STRIDE,
        ),
    ),
    colours=((0.93, 0.93, 0.92), (0.62, 0.64, 0.66), (0.10, 0.10, 0.11), (0.30, 0.25, 0.20)),
    object_class=ObjectClass.ROBOT,
    rig=BirdRig,
    keeps_colours=True,
)
"""The kind in the catalogue; none can be followed. Its class is that of all that is neither vehicle
nor person, `ROBOT`: a class of its own would change the numbers of others' labels."""
