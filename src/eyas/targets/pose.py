"""Where the parts of vehicles are: the loop over all actors of all worlds."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import kernel
from eyas.state.scene import ACTOR_OBJECT

__all__ = ["CENTRE_OFFSET", "LEAN_LIMIT", "STEER_LIMIT", "RigTable", "pose_worlds"]

CENTRE_OFFSET = -1.0
"""Where the middle of a vehicle is drawn, ahead of the actor's reference point [m]. The point that
the original rewards is 1 m behind its reference, so here that point is the visible middle."""

STEER_LIMIT = 0.6
"""Most that wheels steer [rad]."""

LEAN_LIMIT = 0.2
"""Most that two-wheelers lean into a curve [rad]; the original's clamp of the yaw rate [rad/s]."""

Numbers = NDArray[np.float64]

_SLOWEST = 1.0
"""Speed below which the curve is not told from the yaw rate any more [m/s]."""


class RigTable(NamedTuple):
    """What the kernel knows of M models with S slots each; slot 0 is the body."""

    part: NDArray[np.int32]
    """Index into the part library, -1 for an unused slot, shape (M, S)."""
    offset: NDArray[np.float64]
    """Place of the part in the model's frame [m], shape (M, S, 3)."""
    steered: NDArray[np.bool_]
    """Whether the part follows the curve, shape (M, S)."""
    radius: NDArray[np.float64]
    """Of the wheels [m], shape (M,)."""
    wheelbase: NDArray[np.float64]
    """[m], shape (M,)."""
    lean: NDArray[np.float64]
    """Most that the model leans [rad], shape (M,)."""


@kernel
def _pose_slot(
    pose: NDArray[np.float32],
    base: tuple[float, float, float, float],
    origin: tuple[float, float],
    offset: NDArray[np.float64],
    steer: tuple[float, float],
    spin: tuple[float, float],
) -> None:
    """Write the pose of one part.

    Args:
        pose: What is written, shape (3, 4).
        base: Cosine and sine of the vehicle's yaw and of its roll.
        origin: The vehicle's middle, east and north [m].
        offset: Place of the part in the model's frame [m], shape (3,).
        steer: Cosine and sine of the part's turn about its own upward axis.
        spin: Cosine and sine of its turn about its own left axis, after that.
    """
    c, s, cr, sr = base
    b00, b01, b02 = c, -s * cr, s * sr
    b10, b11, b12 = s, c * cr, -c * sr
    w00, w01, w02 = steer[0] * spin[0], -steer[1], steer[0] * spin[1]
    w10, w11, w12 = steer[1] * spin[0], steer[0], steer[1] * spin[1]
    x, y, z = offset
    pose[0, 0] = b00 * w00 + b01 * w10 - b02 * spin[1]
    pose[0, 1] = b00 * w01 + b01 * w11
    pose[0, 2] = b00 * w02 + b01 * w12 + b02 * spin[0]
    pose[0, 3] = b00 * x + b01 * y + b02 * z + origin[0]
    pose[1, 0] = b10 * w00 + b11 * w10 - b12 * spin[1]
    pose[1, 1] = b10 * w01 + b11 * w11
    pose[1, 2] = b10 * w02 + b11 * w12 + b12 * spin[0]
    pose[1, 3] = b10 * x + b11 * y + b12 * z + origin[1]
    pose[2, 0] = sr * w10 - cr * spin[1]
    pose[2, 1] = sr * w11
    pose[2, 2] = sr * w12 + cr * spin[0]
    pose[2, 3] = sr * y + cr * z


@kernel
def _pose_actor(
    table: RigTable,
    model: int,
    place: tuple[float, float, float],
    motion: tuple[float, float, float],
    part: NDArray[np.int32],
    pose: NDArray[np.float32],
) -> None:
    """Write the parts and poses of one actor.

    Args:
        table: The rigs.
        model: Index into `VEHICLES`.
        place: East, north [m] and yaw [rad] of the reference point.
        motion: Speed [m/s], yaw rate [rad/s] and path length [m].
        part: What is written, shape (S,).
        pose: What is written, shape (S, 3, 4).
    """
    speed, yaw_rate, travelled = motion
    c, s = np.cos(place[2]), np.sin(place[2])
    lean = min(max(yaw_rate, -table.lean[model]), table.lean[model])
    base = (c, s, np.cos(lean), -np.sin(lean))  # a roll to the left is negative about x
    origin = (place[0] + CENTRE_OFFSET * c, place[1] + CENTRE_OFFSET * s)
    # Curvature of a bicycle model: tan(steer) = wheelbase * yaw rate / speed.
    most = np.tan(STEER_LIMIT)
    slope = min(max(table.wheelbase[model] * yaw_rate / max(speed, _SLOWEST), -most), most)
    cosine = 1.0 / np.sqrt(1.0 + slope * slope)
    angle = travelled / table.radius[model]
    spin = (np.cos(angle), np.sin(angle))
    for slot in range(part.shape[0]):
        part[slot] = table.part[model, slot]
        if part[slot] < 0:
            continue
        steer = (cosine, slope * cosine) if table.steered[model, slot] else (1.0, 0.0)
        turn = spin if slot > 0 else (1.0, 0.0)
        _pose_slot(pose[slot], base, origin, table.offset[model, slot], steer, turn)


@kernel
def pose_worlds(
    table: RigTable,
    moving: tuple[Numbers, Numbers, Numbers, Numbers, Numbers],
    present: NDArray[np.bool_],
    model: NDArray[np.int32],
    colour: NDArray[np.float32],
    drawn: tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.float32], NDArray[np.int32]],
) -> None:
    """Write the slots of all actors of all worlds.

    Args:
        table: The rigs.
        moving: Position, yaw, speed, yaw rate and path length of `ActorState`.
        present: Of `ActorState`.
        model: Index into `VEHICLES`, shape (W, A).
        colour: Body colours, sRGB 0 to 1, shape (W, A, 3).
        drawn: What is written: part, pose, colour and object id of `DrawList`.
    """
    position, yaw, speed, yaw_rate, travelled = moving
    part, pose, tint, object_id = drawn
    slots = table.part.shape[1]
    # One thread: waking a second one costs more than 64 worlds of 40 actors.
    for w in range(model.shape[0]):
        for a in range(model.shape[1]):
            first = a * slots
            if not present[w, a]:
                part[w, first : first + slots] = -1
                continue
            place = (position[w, a, 0], position[w, a, 1], yaw[w, a])
            motion = (speed[w, a], yaw_rate[w, a], travelled[w, a])
            window = slice(first, first + slots)
            _pose_actor(table, model[w, a], place, motion, part[w, window], pose[w, window])
            for slot in range(first, first + slots):
                object_id[w, slot] = ACTOR_OBJECT + a
                for k in range(3):
                    tint[w, slot, k] = colour[w, a, k]
