"""A quadrotor: what the trackers of a shared world look like to each other."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.shell import Shell
from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.kind import Group, Kind, Looks, Model
from eyas.lanes import exact

_BODY = Material(tint=(0.46, 0.47, 0.49))
_DARK = Material(tint=(0.17, 0.17, 0.18))
_BLADE = Material(tint=(0.30, 0.30, 0.31))
_LENS = Material(tint=(0.08, 0.08, 0.10), surface=Surface.GLASS)

_FRONT, _REAR = (0.118, 0.134), (-0.118, 0.130)
"""Forward and left of a motor, the other side mirrored: 0.35 m from corner to corner [m]."""
_FRONT_TOP, _REAR_TOP = 0.045, 0.03  # Height of the rotors [m]
_FRONT_TURN, _REAR_TURN = 0.5, 2.2
"""Where their blades stand [rad]. Discs, as blurred by the turning, hide four times too much."""
_TIP = 0.11  # Length of a blade [m]

_ACROSS, _LIFT = np.array([-1.0, 1.0, 1.0, -1.0]), np.array([0.0, -0.004, 0.001, 0.005])
"""Corners of a section of a blade: aside, in half chords, and up [m]; it is pitched."""

_MIDDLE = 0.055  # Height of its middle over its lowest point, where it is as an actor [m]

_HULL = (
    (-0.105, 0.026, -0.030, 0.012),
    (-0.085, 0.042, -0.040, 0.030),
    (0.050, 0.046, -0.042, 0.036),
    (0.100, 0.040, -0.030, 0.024),
    (0.116, 0.026, -0.018, 0.008),
)
"""Sections of the hull: forward, half width, bottom, top [m]."""


def quadrotor_levels() -> tuple[Mesh, Mesh, Mesh]:
    """Return the levels of detail, the finest first; x is forward, the origin in the middle."""
    return _mesh(8), _mesh(5), _mesh(3)


def _mesh(sides: int) -> Mesh:
    """Return the mesh with so many sides of its rods."""
    shell = Shell()
    shell.rings([_section(*section) for section in _HULL], _BODY)
    shell.box((0.112, -0.02, -0.055), (0.146, 0.02, -0.015), _DARK)
    shell.ball((0.146, 0.0, -0.036), (0.014, 0.014, 0.014), _LENS, rows=4, sides=sides + 1)
    _arm(shell, (0.085, 0.035, 0.0), (*_FRONT, _FRONT_TOP), _FRONT_TURN, sides)
    _arm(shell, (-0.07, 0.035, 0.0), (*_REAR, _REAR_TOP), _REAR_TURN, sides)
    x, y = _FRONT
    leg = [(x, y, _FRONT_TOP - 0.04), (x + 0.01, y, -0.06)]
    shell.tube(leg, (0.010, 0.006), _DARK, sides=sides, both_sides=True)
    return shell.mesh()


def _section(x: float, half: float, low: float, high: float) -> list[tuple[float, float, float]]:
    """Return an outline with bevelled edges, counter-clockwise as seen from ahead."""
    edge, rim = 0.65 * half, 0.3 * (high - low)
    right = [(-edge, high), (-half, high - rim), (-half, low + rim), (-edge, low)]
    left = [(-y, z) for y, z in reversed(right)]
    return [(x, y, z) for y, z in right + left]


def _arm(
    shell: Shell,
    root: tuple[float, float, float],
    hub: tuple[float, float, float],
    turn: float,
    sides: int,
) -> None:
    """Add an arm on both sides, with its motor and its rotor of two blades."""
    x, y, top = hub
    shell.tube([root, (x, y, top - 0.03)], (0.017, 0.012), _BODY, sides=sides, both_sides=True)
    motor = [(x, y, top - 0.045), (x, y, top - 0.005)]
    shell.tube(motor, (0.016, 0.016), _DARK, sides=sides + 1, both_sides=True)
    for angle in (turn, turn + math.pi):
        along = np.array([exact.cos(angle), exact.sin(angle), 0.0])
        aside, up = np.array([-along[1], along[0], 0.0]), np.array([0.0, 0.0, 1.0])
        rings = [
            np.array(hub) + reach * along + np.outer(half * _ACROSS, aside) + np.outer(_LIFT, up)
            for reach, half in ((0.0, 0.006), (0.35 * _TIP, 0.013), (_TIP, 0.006))
        ]
        shell.rings(rings, _BLADE, both_sides=True)


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
    name="quadrotor",
    models=(
        Model(
            name="Quadrotor",
            typename="Quadrotor",
            kind="quadrotor",
            size=(0.405, 0.445, 0.11),  # with its rotors, as a DJI Mavic 2
            rise=_MIDDLE,
            words=("a grey drone", "a grey drone (Quadrotor)"),
            motion="flies",
            speed=0.0,
            stride=1.0,
        ),
    ),
    colours=((1.0, 1.0, 1.0),),
    object_class=ObjectClass.ROBOT,
    rig=QuadrotorRig,
    keeps_colours=True,
)
"""The kind in the catalogue."""
