"""Legs that step: the foot's path is given, and the bones follow it.

While a foot is on the ground it moves back in the model frame as fast as the model moves ahead, so
that it stands still in the world. The bones are found by the law of cosines in the plane of hip,
foot and knee.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.targets.jointed.figure import Gait, Leg
from eyas.targets.jointed.frames import along, directions, framed, level, places, turned

__all__ = ["leg_frames"]

_FLAT = (0.15, 0.5)
"""Part of the time on the ground during which the sole lies flat."""

_SLACK = 0.999
"""Share of their lengths to which bones stretch: a straight leg's knee would point anywhere."""


def leg_frames(
    gait: Gait, leg: Leg, parent: NDArray[np.float64], cycle: NDArray[np.float64], *, moving: bool
) -> list[NDArray[np.float64]]:
    """Return the frames of the drawn parts of a leg in the model frame, each (K, 3, 4)."""
    ankle, pitch = _ankle(gait, leg, cycle, moving=moving)
    hip = places(parent, np.array(leg.hip))
    up = parent[..., 2]
    drawn = []
    if leg.coxa is not None:
        out = ankle - hip
        out -= (out * up).sum(axis=-1, keepdims=True) * up
        out /= np.linalg.norm(out, axis=-1, keepdims=True)
        drawn.append(framed(hip, out, np.cross(up, out), up))
        hip = hip + leg.coxa[0] * out
    bend = directions(parent, np.array(leg.knee))
    knee, ankle = _bent(hip, ankle, bend, leg.bones)
    drawn += [along(hip, knee, bend), along(knee, ankle, bend)]
    if leg.shapes[2] is not None:
        zero = np.zeros(len(cycle))
        drawn.append(turned(level(len(cycle)), ankle, zero, pitch, zero))
    return drawn


def _ankle(
    gait: Gait, leg: Leg, cycle: NDArray[np.float64], *, moving: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ankle in the model frame [m], shape (K, 3), and the pitch of the foot [rad]."""
    x, y, height = leg.foot
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
