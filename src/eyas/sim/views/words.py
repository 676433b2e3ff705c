"""The target in words that tell it from what else is in view."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.state.motion import ActorState, ActorView
from eyas.state.snapshot import CameraState, Snapshot
from eyas.targets.catalogue import MODELS, extent_of, kind_of
from eyas.targets.words import Seen, told_apart

__all__ = ["target_in_words"]

Floats = NDArray[np.float64]

_LARGEST = 40.0
"""No point of an actor is farther from its place [m]; twice the longest truck."""


def target_in_words(shown: Snapshot, around: ActorView, tracker: int, aspect: float) -> str:
    """Return a description of a tracker's target as its camera shows it, such as "a red SUV".

    No other actor of which a part is in the camera's view shares it, hidden or not.

    Args:
        shown: The state that the picture shows.
        around: The actors around the tracker at that time.
        tracker: The tracker.
        aspect: Height of the camera's picture over its width.
    """
    cameras, target = shown.cameras, int(shown.targets.actor[tracker])
    actors, _, model, colour = around
    wide = exact.tan(0.5 * float(cameras.field_of_view[tracker]))
    # Boxes of limbs cost 40 us each, so only those that may be in view get one; of a world with
    # 160 actors, words took a third of the time of a recorded frame.
    places = _in_camera(actors.position[0], cameras, tracker)[:, None]
    near = _in_view(places, wide, wide * aspect, _LARGEST) & actors.present[0]
    near[target] = True
    chosen = np.flatnonzero(near)
    corners = _in_camera(_corners(actors, chosen, model), cameras, tracker)
    inside = _in_view(corners, wide, wide * aspect)
    # Where the middle is: half across the picture is 0.5, also if it is behind the camera.
    forward, left, _ = corners.mean(axis=1).T
    column = 0.5 - 0.5 * left / (np.maximum(forward, 1e-3) * wide)

    def seen(at: int) -> Seen:
        actor = int(chosen[at])
        return Seen(
            model=int(model[actor]),
            colour=colour[actor].tolist(),
            speed=float(actors.speed[0, actor]),
            yaw_rate=float(actors.yaw_rate[0, actor]),
            column=float(column[at]),
            distance=float(forward[at]),
        )

    others = np.flatnonzero(inside & (chosen != target)).tolist()
    return told_apart(seen(int(np.searchsorted(chosen, target))), [seen(at) for at in others])


def _corners(actors: ActorState, chosen: NDArray[np.intp], model: NDArray[np.int32]) -> Floats:
    """Return the corners of the boxes of some actors of one world [m], shape (C, 8, 3)."""
    low, high = np.empty((2, len(chosen), 3))
    for at, actor in enumerate(chosen.tolist()):
        low[at], high[at] = _extent(actors, actor, int(model[actor]))
    pick = np.array([[bit >> axis & 1 for axis in range(3)] for bit in range(8)], bool)
    own = np.where(pick, high[:, None], low[:, None])
    yaw, slope = actors.yaw[0, chosen], actors.slope[0, chosen]
    cosine, sine = exact.cos(yaw)[:, None], exact.sin(yaw)[:, None]
    east = cosine * own[..., 0] - sine * own[..., 1]
    north = sine * own[..., 0] + cosine * own[..., 1]
    up = own[..., 2] + own[..., 0] * exact.tan(slope)[:, None]
    corners: Floats = np.stack([east, north, up], axis=-1) + actors.position[0, chosen][:, None]
    return corners


def _extent(actors: ActorState, actor: int, model: int) -> Floats | tuple[list[float], list[float]]:
    """Return the least and largest coordinates of an actor ahead, left and up of its place [m]."""
    travelled, speed = float(actors.travelled[0, actor]), float(actors.speed[0, actor])
    slope, hitch = float(actors.slope[0, actor]), float(actors.hitch[0, actor])
    limbs = extent_of(model, travelled, speed, slope)
    if limbs is not None:
        return limbs
    length, width, height = MODELS[model].size
    middle, half = kind_of(model).ahead, 0.5 * width + 0.5 * length * abs(hitch)  # swings aside
    return [middle - 0.5 * length, -half, 0.0], [middle + 0.5 * length, half, height]


def _in_camera(points: Floats, cameras: CameraState, tracker: int) -> Floats:
    """Return points forward, left and up of a tracker's camera [m], shape (..., 3)."""
    away, axes = points - cameras.position[tracker], cameras.rotation[tracker]
    seen = [sum(away[..., k] * axes[k, axis] for k in range(3)) for axis in range(3)]
    return np.stack(seen, axis=-1)


def _in_view(corners: Floats, wide: float, high: float, radius: float = 0.0) -> NDArray[np.bool_]:
    """Return whether any part of boxes may be in a view: none is outside of one of its planes.

    Args:
        corners: Corners of boxes forward, left and up of the camera [m], shape (A, C, 3).
        wide: Tangent of half the horizontal field of view.
        high: Tangent of half the vertical field of view.
        radius: Radius of spheres around the corners that count as well [m].
    """
    forward, left, up = np.moveaxis(corners, -1, 0)
    sides, ends = radius * math.sqrt(1.0 + wide * wide), radius * math.sqrt(1.0 + high * high)
    planes = [forward + radius, forward * wide - left + sides, forward * wide + left + sides]
    planes += [forward * high - up + ends, forward * high + up + ends]
    inside: NDArray[np.bool_] = np.all([(plane > 0.0).any(axis=1) for plane in planes], axis=0)
    return inside
