"""Poses of the parts of vehicles."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.motion import ActorState
from eyas.engine.targets.kind import Group, Looks
from eyas.engine.targets.posing import ActorFrame, Slots
from eyas.engine.traffic.trailer import folded
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos, tan

VEHICLE_AHEAD = -1.0
"""Distance of the middle of a vehicle, the point that the reward uses, ahead of the actor's
reference point [m]: the original rewards a point 1 m behind it; kernels read it."""

STEER_LIMIT = 0.6  # Largest steering angle [rad]

_SLOWEST = 1.0  # Smallest speed used to compute the curvature from the yaw rate [m/s]


SLOT: Final = np.dtype(
    [
        ("part", np.int64),
        ("x", np.float64),
        ("y", np.float64),
        ("z", np.float64),
        ("steered", "?"),
        ("towed", "?"),
    ],
    align=True,
)
"""A part in the frame of its model.

part: index among the parts of the kind, -1 for an unused slot; x, y, z: position [m]; steered:
whether it steers; towed: whether it belongs to the trailer.
"""

AXLES: Final = np.dtype(
    [("radius", np.float64), ("wheelbase", np.float64), ("lean", np.float64)], align=True
)
"""Dimensions of a model: radius of the wheels and wheelbase [m], largest lean in a curve [rad]."""


class RigTable(NamedTuple):
    """Data of M models with V variants of S slots each, for the kernel; slot 0 is the body."""

    slot: NDArray[np.void]  # Parts of dtype `SLOT`, shape (M, V, S)
    axles: NDArray[np.void]  # Dimensions of dtype `AXLES`, shape (M,)


@kernel
def _base_of(actors: ActorState, w: int, a: int, most_lean: float) -> ActorFrame:
    """Return the pose of vehicle a of world w, on its road and leaning into the curve."""
    yaw, slope = actors.yaw[w, a], actors.slope[w, a]
    s, c = sin_cos(yaw)
    # The shortcut for flat roads saves a fifth of the time.
    sp, cp = sin_cos(slope) if slope != 0.0 else (0.0, 1.0)
    lean = min(max(actors.yaw_rate[w, a], -most_lean), most_lean)
    sr, cr = sin_cos(-lean)  # a roll to the left is negative about x
    return ActorFrame(
        c * cp, -s * cr - c * sp * sr, s * sr - c * sp * cr,
        s * cp, c * cr - s * sp * sr, -c * sr - s * sp * cr,
        sp, cp * sr, cp * cr,
        actors.position[w, a, 0] + VEHICLE_AHEAD * c * cp,
        actors.position[w, a, 1] + VEHICLE_AHEAD * s * cp,
        actors.position[w, a, 2] + VEHICLE_AHEAD * sp,
    )  # fmt: skip


@kernel
def _carried(base: ActorFrame, hitch: float, towed: int) -> ActorFrame:
    """Return the pose of a truck or its trailer, see `folded`; `base` is that of the whole."""
    x, y, c, s = folded(hitch, towed)
    return ActorFrame(
        base.xx * c + base.xy * s, base.xy * c - base.xx * s, base.xz,
        base.yx * c + base.yy * s, base.yy * c - base.yx * s, base.yz,
        base.zx * c + base.zy * s, base.zy * c - base.zx * s, base.zz,
        base.x + base.xx * x + base.xy * y,
        base.y + base.yx * x + base.yy * y,
        base.z + base.zx * x + base.zy * y,
    )  # fmt: skip


@kernel
def _pose_slot(
    pose: NDArray[np.float32],  # Pose to write, shape (3, 4)
    base: ActorFrame,  # Pose of the vehicle
    offset: tuple[float, float, float],  # Position of the part in the model's frame [m]
    steer: tuple[float, float],  # Cosine and sine of the rotation about the part's upward axis
    # Cosine and sine of the rotation about the part's left axis, as turned by `steer`
    spin: tuple[float, float],
) -> None:
    """Write the pose of one part."""
    w00, w01, w02 = steer[0] * spin[0], -steer[1], steer[0] * spin[1]
    w10, w11, w12 = steer[1] * spin[0], steer[0], steer[1] * spin[1]
    w20, w22 = -spin[1], spin[0]
    x, y, z = offset
    pose[0, 0] = base.xx * w00 + base.xy * w10 + base.xz * w20
    pose[0, 1] = base.xx * w01 + base.xy * w11
    pose[0, 2] = base.xx * w02 + base.xy * w12 + base.xz * w22
    pose[0, 3] = base.xx * x + base.xy * y + base.xz * z + base.x
    pose[1, 0] = base.yx * w00 + base.yy * w10 + base.yz * w20
    pose[1, 1] = base.yx * w01 + base.yy * w11
    pose[1, 2] = base.yx * w02 + base.yy * w12 + base.yz * w22
    pose[1, 3] = base.yx * x + base.yy * y + base.yz * z + base.y
    pose[2, 0] = base.zx * w00 + base.zy * w10 + base.zz * w20
    pose[2, 1] = base.zx * w01 + base.zy * w11
    pose[2, 2] = base.zx * w02 + base.zy * w12 + base.zz * w22
    pose[2, 3] = base.zx * x + base.zy * y + base.zz * z + base.z


@kernel
def _wheels_of(
    radius: float, wheelbase: float, actors: ActorState, w: int, a: int
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return cosine and sine of the wheels' steering angle, and of their rolling angle."""
    # Curvature of a bicycle model: tan(steer) = wheelbase * yaw rate / speed.
    most = tan(STEER_LIMIT)
    curve = wheelbase * actors.yaw_rate[w, a] / max(actors.speed[w, a], _SLOWEST)
    turn = min(max(curve, -most), most)
    cosine = 1.0 / np.sqrt(1.0 + turn * turn)
    angle = actors.travelled[w, a] / radius
    rolled_sine, rolled_cosine = sin_cos(angle)
    return (cosine, turn * cosine), (rolled_cosine, rolled_sine)


@kernel
def pose_vehicle(
    table: RigTable, group: Group, actors: ActorState, looks: Looks, out: Slots, w: int, g: int
) -> None:
    """Write the slots of one vehicle."""
    a, first = group.actor[g], group.slot[g]
    model = looks.model[w, a] - group.first_model
    axles = table.axles[model]
    truck = trailer = _base_of(actors, w, a, axles.lean)
    hitch = actors.hitch[w, a]
    if hitch != 0.0:
        truck, trailer = _carried(truck, hitch, 0), _carried(truck, hitch, 1)
    steered, rolled = _wheels_of(axles.radius, axles.wheelbase, actors, w, a)
    # Lists may hold some actors only: the id, not the place in a list, keeps a vehicle's variant.
    variant = int(out.object_id[w, first]) % table.slot.shape[1]
    for k in range(table.slot.shape[2]):
        slot, part = first + k, table.slot[model, variant, k]
        if part.part < 0:
            out.part[w, slot] = -1
            continue
        out.part[w, slot] = group.first_part + part.part
        steer = steered if part.steered else (1.0, 0.0)
        spin = rolled if part.z > 0.0 else (1.0, 0.0)
        base = trailer if part.towed else truck
        _pose_slot(out.pose[w, slot], base, (part.x, part.y, part.z), steer, spin)
        for channel in range(3):
            out.colour[w, slot, channel] = looks.colour[w, a, channel]
