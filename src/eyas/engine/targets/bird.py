"""A bird, which flies between camera and street: a body and two wings that beat."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.shell import Shell
from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.kind import Group, Kind, Looks, Model
from eyas.lanes import exact

_FEATHERS = Material(surface=Surface.PAINT)
_TIPS = Material(tint=(0.20, 0.20, 0.21), surface=Surface.PAINT)
_BILL = Material(tint=(0.55, 0.38, 0.10))

_MIDDLE = 0.35
"""Height of the body's middle over the reference point, below which wings do not beat [m]."""
_SHOULDER = (0.04, 0.035, 0.02)  # Forward, left and up of the left one, from the middle [m]
_BEAT = 0.62  # Largest angle of the wings over the horizontal [rad]
_STRIDE = 3.2
"""Way in one beat [m]: at 11 m/s they beat 3.4 times a second, as gulls do (Pennycuick, Wingbeat
frequency of birds in steady cruising flight, Journal of Experimental Biology 199, 1996)."""
_GLIDING = 11.0  # Beats from a glide to the next
_GRAVITY = 9.81

_HULL = (
    (-0.26, 0.045, -0.005, 0.010),
    (-0.16, 0.025, -0.020, 0.025),
    (-0.02, 0.055, -0.055, 0.050),
    (0.12, 0.050, -0.050, 0.045),
    (0.19, 0.030, -0.025, 0.040),
    (0.235, 0.020, -0.010, 0.025),
)
"""Sections from the tail to the head: forward, half width, bottom, top [m]."""

_WING = ((0.0, 0.075, -0.065), (0.25, 0.085, -0.045), (0.42, 0.03, -0.075), (0.56, -0.075, -0.105))
"""Sections of a wing: left of the shoulder, leading and trailing edge forward of it [m]."""


def _body() -> Mesh:
    shell = Shell()
    shell.rings([_section(*section) for section in _HULL], _FEATHERS)
    shell.box((0.235, -0.008, 0.0), (0.27, 0.008, 0.014), _BILL)
    return shell.mesh()


def _section(x: float, half: float, low: float, high: float) -> list[tuple[float, float, float]]:
    """Return an outline, counter-clockwise as seen from ahead."""
    middle, edge = 0.5 * (low + high), 0.6 * half
    outline = [(-edge, high), (-half, middle), (-edge, low), (edge, low), (half, middle)]
    return [(x, y, z) for y, z in [*outline, (edge, high)]]


def _wing(side: float) -> Mesh:
    """Return the left wing (side 1) or the right one (-1), from its shoulder."""
    shell = Shell()
    for inner, outer in pairwise(_WING):
        (y, front, back), (over, front_over, back_over) = inner, outer
        colour = _TIPS if outer is _WING[-1] else _FEATHERS
        for up in (1.0, -1.0):
            z = 0.004 * up
            corners = [
                (front, side * y, z),
                (front_over, side * over, z),
                (back_over, side * over, z),
                (back, side * y, z),
            ]
            shell.quads(corners[::-1] if side * up < 0.0 else corners, colour)
    return shell.mesh()


class BirdRig:
    """Three parts: the body and the wings. It banks in turns, and glides now and then."""

    slots = 3
    part_count = 3

    def part_levels(self) -> Sequence[tuple[Mesh, ...]]:
        """Return the meshes, see `Rig`."""
        return [(_body(),), (_wing(1.0),), (_wing(-1.0),)]

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
