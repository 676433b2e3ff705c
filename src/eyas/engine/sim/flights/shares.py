"""What shares of a flight's time show its target how: asked, and foreseen."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sim.flights.path import FlightScene
from eyas.engine.task.clearance import Clearance
from eyas.lanes import exact

Floats = NDArray[np.float64]

SMALL = 32 * 32  # A box with fewer pixels is small, as COCO has it

_SHAPE = 0.88
"""Size of a box whose corners span what a body of that box covers in a picture: bodies are round.
With it, foreseen and recorded shares of 16 flights differ by some 0.02."""

_BODY = 0.6  # Size of the box at whose corners it is looked whether something hides the body

_NEAR = 0.1  # Depth from which on points are projected [m]


class Asked(NamedTuple):
    """Shares of frames that a user asks for, 0 to 1; None: as it comes."""

    in_view: float | None  # Target in the picture, hidden or not
    hidden: float | None  # Half of it or more is hidden, in the picture
    cut: float | None  # Cut by the border of the picture
    small: float | None  # Its box has fewer than `SMALL` pixels


class FrameShares(NamedTuple):
    """Shares of frames, as in `Asked`."""

    in_view: float
    hidden: float
    cut: float
    small: float


def mean(flags: NDArray[np.bool_]) -> float:
    """Return the share of flags that are set; exact, unlike a mean of numbers."""
    return int(np.count_nonzero(flags)) / max(len(flags), 1)


def foreseen(
    flight: Floats,  # x, y, z, yaw, pitch, field of view, shape (M, 6)
    scene: FlightScene,  # The episode
    size: Floats,  # Length, width, height of the target [m], shape (3,)
    picture: tuple[int, int],  # Its width and height [pixels]
    clearance: Clearance,  # What stands around
    unseen: int,  # Samples before the first picture
) -> FrameShares:
    """Return the shares of a flight.

    What moves hides nothing here, so the recording may have some more hidden frames.
    """
    across, up, ahead = _seen(flight, _points(scene, size, _SHAPE), picture)
    left, right = across.min(axis=1), across.max(axis=1)
    low, high = up.min(axis=1), up.max(axis=1)
    in_view = (ahead.min(axis=1) > _NEAR) & (left < 1.0) & (right > -1.0)
    in_view &= (low < 1.0) & (high > -1.0)
    cut = in_view & ((left < -1.0) | (right > 1.0) | (low < -1.0) | (high > 1.0))
    width = 0.5 * picture[0] * (np.minimum(right, 1.0) - np.maximum(left, -1.0))
    height = 0.5 * picture[1] * (np.minimum(high, 1.0) - np.maximum(low, -1.0))
    small = in_view & (width * height < SMALL)
    seen = clearance.in_sight(flight[:, :3], _points(scene, size, _BODY))
    hidden = in_view & (2 * np.count_nonzero(seen, axis=1) < seen.shape[1])
    return FrameShares(*(mean(flags[unseen:]) for flags in (in_view, hidden, cut, small)))


def _points(scene: FlightScene, size: Floats, share: float) -> Floats:
    """Return the corners of the target's box, shrunk to a share, shape (M, 8, 3)."""
    signs = np.array([(a, b, c) for a in (1, -1) for b in (1, -1) for c in (1, -1)], np.float64)
    half = 0.5 * share * signs * size
    cosine, sine = exact.cos(scene.heading)[:, None], exact.sin(scene.heading)[:, None]
    off = [cosine * half[:, 0] - sine * half[:, 1], sine * half[:, 0] + cosine * half[:, 1]]
    off.append(np.broadcast_to(half[:, 2], off[0].shape))
    corners: Floats = scene.target[:, None] + np.stack(off, axis=2)
    return corners


def _seen(
    flight: Floats, points: Floats, picture: tuple[int, int]
) -> tuple[Floats, Floats, Floats]:
    """Return where points are in the picture, in halves from the middle, and their depth [m]."""
    x, y, z = np.moveaxis(points - flight[:, None, :3], 2, 0)
    yaw, pitch, field = (flight[:, column, None] for column in (3, 4, 5))
    cy, sy, cp, sp = exact.cos(yaw), exact.sin(yaw), exact.cos(pitch), exact.sin(pitch)
    level = cy * x + sy * y
    depth = cp * level - sp * z
    far = np.maximum(depth, _NEAR)
    half = exact.tan(0.5 * field)
    across = (sy * x - cy * y) / (far * half)
    up = (sp * level + cp * z) / (far * half * (picture[1] / picture[0]))
    return across, up, depth
