"""Where the parts of a figure are through a cycle of its motion.

While a foot is on the ground it moves back in the model frame as fast as the model moves ahead, so
that it stands still in the world. The bones are found by the law of cosines in the plane of hip,
foot and knee.
"""

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from art.jointed.figure import Figure, Gait, Joint, Leg
from art.parts import Shape
from eyas.engine.mesh.shell import Shell
from eyas.lanes import exact

_FLAT = (0.15, 0.5)  # Part of the time on the ground during which the sole lies flat

_SLACK = 0.999
"""Share of their lengths to which bones stretch: a straight leg's knee would point anywhere."""


def shapes_of(figure: Figure) -> list[Shape]:
    """Return the shape of each drawn part, in the order of `frames_of`."""
    shapes = [joint.shape for joint in figure.joints if joint.shape is not None]
    for leg in figure.legs:
        bones = (leg.coxa[1] if leg.coxa else None, *leg.shapes)
        shapes += [shape for shape in bones if shape is not None]
    return shapes


def frames_of(
    figure: Figure,
    cycle: NDArray[np.float64],  # Parts of a cycle, shape (K,)
    *,
    moving: bool,  # Whether it moves; else it rests, and all K frames are alike
) -> NDArray[np.float64]:
    """Return the frames of the drawn parts in the model frame, shape (K, S, 3, 4) [m]."""
    frames = {"ground": _level(len(cycle)), "trunk": _trunk(figure.gait, cycle, moving=moving)}
    drawn = []
    for joint in figure.joints:
        frames[joint.name] = _joint(frames[joint.parent], joint, cycle, moving=moving)
        if joint.shape is not None:
            drawn.append(_grown(frames[joint.name], joint.scale))
    for leg in figure.legs:
        drawn += _leg_frames(figure.gait, leg, frames[leg.parent], cycle, moving=moving)
    return figure.scale * np.stack(drawn, axis=1)


@cache
def table_of(skeleton: Figure, intervals: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the frames of a `skeleton_of` at rest, shape (1, S, 3, 4), and through a cycle,
    (intervals + 1, S, 3, 4) [m].
    """
    cycle = np.linspace(0.0, 1.0, intervals + 1)
    still = frames_of(skeleton, np.zeros(1), moving=False)
    return still, frames_of(skeleton, cycle, moving=True)


def skeleton_of(figure: Figure) -> tuple[Figure, list[int]]:
    """Return what moves like a figure and is as large as one of scale 1, the same for all figures
    that differ in shapes only; and which of its parts the figure draws.
    """
    joints = tuple(replace(joint, shape=_any) for joint in figure.joints)
    legs = []
    drawn = [k for k, joint in enumerate(figure.joints) if joint.shape is not None]
    count = len(joints)
    for leg in figure.legs:
        coxa = None if leg.coxa is None else (leg.coxa[0], _any)
        legs.append(replace(leg, shapes=(_any, _any, _any), coxa=coxa))
        own = (*(() if coxa is None else (leg.coxa,)), *leg.shapes)
        drawn += [count + k for k, shape in enumerate(own) if shape is not None]
        count += len(own)
    return replace(figure, joints=joints, legs=tuple(legs), scale=1.0), drawn


def _any(shell: Shell, detail: int) -> None:
    """Stand for any shape."""


def _grown(frames: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    """Return frames whose axes are longer by a factor."""
    return frames if scale == 1.0 else frames * [scale, scale, scale, 1.0]


def _trunk(gait: Gait, cycle: NDArray[np.float64], *, moving: bool) -> NDArray[np.float64]:
    place = [s.at(cycle, moving=moving) for s in (gait.x, gait.y, gait.z)]
    angles = [s.at(cycle, moving=moving) for s in (gait.roll, gait.pitch, gait.yaw)]
    return _turned(_level(len(cycle)), np.stack(place, axis=1), *angles)


def _joint(
    parent: NDArray[np.float64], joint: Joint, cycle: NDArray[np.float64], *, moving: bool
) -> NDArray[np.float64]:
    angles = [s.at(cycle, moving=moving) for s in (joint.roll, joint.pitch, joint.yaw)]
    return _turned(parent, np.array(joint.pivot), *angles)


def _leg_frames(
    gait: Gait, leg: Leg, parent: NDArray[np.float64], cycle: NDArray[np.float64], *, moving: bool
) -> list[NDArray[np.float64]]:
    """Return the frames of the drawn parts of a leg in the model frame, each (K, 3, 4)."""
    ankle, pitch = _ankle(gait, leg, cycle, moving=moving)
    hip = _places(parent, np.array(leg.hip))
    up = parent[..., 2]
    drawn = []
    if leg.coxa is not None:
        out = ankle - hip
        out -= (out * up).sum(axis=-1, keepdims=True) * up
        out /= np.linalg.norm(out, axis=-1, keepdims=True)
        drawn.append(_framed(hip, out, exact.cross(up, out), up))
        hip = hip + leg.coxa[0] * out
    bend = _directions(parent, np.array(leg.knee))
    knee, ankle = _bent(hip, ankle, bend, leg.bones)
    drawn += [_along(hip, knee, bend), _along(knee, ankle, bend)]
    if leg.shapes[2] is not None:
        zero = np.zeros(len(cycle))
        drawn.append(_turned(_level(len(cycle)), ankle, zero, pitch, zero))
    return drawn


def _ankle(
    gait: Gait, leg: Leg, cycle: NDArray[np.float64], *, moving: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ankle in the model frame [m], shape (K, 3), and the pitch of the foot [rad]."""
    x, y, height = leg.foot
    if leg.circle is not None:
        turn = 2.0 * np.pi * (cycle + leg.phase)
        round_x, round_z = leg.circle * exact.sin(turn), leg.circle * exact.cos(turn)
        ankle = np.stack([x + round_x, np.full(len(cycle), y), height + round_z], axis=-1)
        return ankle, np.zeros(len(cycle))
    if not moving:
        return np.tile([x, y, height], (len(cycle), 1)), np.zeros(len(cycle))
    part = (cycle + leg.phase) % 1.0
    stand = np.clip(part / gait.duty, 0.0, 1.0)
    fly = np.clip((part - gait.duty) / (1.0 - gait.duty), 0.0, 1.0)
    # In the world, a foot begins and ends its flight at rest: a cycloid.
    world = gait.stride * (fly - exact.sin(2.0 * np.pi * fly) / (2.0 * np.pi))
    ahead = world - gait.stride * (part - 0.5 * gait.duty)
    pitch = _pitch(leg, stand, fly)
    # The foot turns about its toes if they point down, else about its heel.
    lever = np.where(pitch > 0.0, -leg.sole[1], leg.sole[0])
    ankle_x = -lever + lever * exact.cos(pitch) + height * exact.sin(pitch)
    ankle_z = -lever * exact.sin(pitch) + height * exact.cos(pitch)
    lift = gait.lift * np.square(exact.sin(np.pi * fly))
    place = (x + gait.shift + ahead + ankle_x, np.full(len(cycle), y), ankle_z + lift)
    return np.stack(place, axis=-1), pitch


def _pitch(leg: Leg, stand: NDArray[np.float64], fly: NDArray[np.float64]) -> NDArray[np.float64]:
    strike, push = leg.roll
    down = strike * np.square(1.0 - np.minimum(stand / _FLAT[0], 1.0))
    rise = push * np.square(np.maximum(stand - _FLAT[1], 0.0) / (1.0 - _FLAT[1]))
    swung = np.square(fly) * (3.0 - 2.0 * fly)
    swing = push * (1.0 - swung) - strike * swung
    return np.where(fly > 0.0, swing, rise - down)


def _bent(
    hip: NDArray[np.float64],
    ankle: NDArray[np.float64],
    bend: NDArray[np.float64],
    bones: tuple[float, float],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return knees and the ends of legs that reach for their ankles, each of shape (K, 3)."""
    upper, lower = bones
    reach = ankle - hip
    far = np.linalg.norm(reach, axis=-1, keepdims=True)
    reach = reach / far
    far = np.clip(far, abs(upper - lower) + 1e-6, _SLACK * (upper + lower))
    side = bend - (bend * reach).sum(axis=-1, keepdims=True) * reach
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    cosine = (np.square(upper) + np.square(far) - np.square(lower)) / (2.0 * upper * far)
    sine = np.sqrt(np.maximum(1.0 - np.square(cosine), 0.0))
    return hip + upper * (cosine * reach + sine * side), hip + far * reach


# Frames: rotations and translations, K at once, shape (K, 3, 4) [m].


def _level(count: int) -> NDArray[np.float64]:
    """Return frames at the origin, without rotation."""
    return np.tile(np.eye(3, 4), (count, 1, 1))


def _places(frames: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points, shape (3,) or (K, 3), given in frames, as seen from outside, shape (K, 3)."""
    return _directions(frames, points) + frames[..., 3]


def _directions(frames: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors, shape (3,) or (K, 3), given in frames, as seen from outside, (K, 3)."""
    turned_vectors: NDArray[np.float64] = (frames[..., :3] * vectors[..., None, :]).sum(axis=-1)
    return turned_vectors


def _turned(
    frames: NDArray[np.float64],
    pivot: NDArray[np.float64],
    roll: NDArray[np.float64],
    pitch: NDArray[np.float64],
    yaw: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return frames at a point of others, turned by roll, then pitch, then yaw [rad], (K,)."""
    angles = np.stack([roll, pitch, yaw])
    (cr, cp, cy), (sr, sp, sy) = exact.cos(angles), exact.sin(angles)
    rotation = np.stack([
        np.stack([cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], axis=-1),
        np.stack([sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], axis=-1),
        np.stack([-sp, cp * sr, cp * cr], axis=-1),
    ], axis=-2)  # fmt: skip
    return np.concatenate(
        [exact.product(frames[..., :3], rotation), _places(frames, pivot)[..., None]], axis=-1
    )


def _along(
    start: NDArray[np.float64], end: NDArray[np.float64], side: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return frames of bones: origin at the start, z away from the end, x towards a side."""
    z = _unit(start - end)
    x = _unit(side - (side * z).sum(axis=-1, keepdims=True) * z)
    return _framed(start, x, exact.cross(z, x), z)


def _framed(
    origin: NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    z: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return frames with these axes, each of shape (K, 3)."""
    return np.stack([x, y, z, origin], axis=-1)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    unit: NDArray[np.float64] = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit
