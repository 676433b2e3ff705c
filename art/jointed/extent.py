"""The box in which a person or robot fits at a moment: limbs swing out of that of its size."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from art.jointed.cycle import frames_of, shapes_of
from art.jointed.figure import Figure
from art.parts import DETAILS, Shape, shell_of
from eyas.engine.targets.jointed.rig import Extents

INTERVALS = 32  # Of a cycle; within one, parts move along straight lines

Floats = NDArray[np.float64]


@cache
def extents_of(figure: Figure) -> Extents:
    """Return the boxes of a figure; wheels fill theirs however far they have rolled."""
    cycle = np.linspace(0.0, 1.0, INTERVALS + 1)
    points = [_points(figure, number) for number in range(len(shapes_of(figure)))]
    still = frames_of(figure, np.zeros(1), moving=False)
    moving = frames_of(figure, cycle, moving=True)
    gait = figure.gait
    return Extents(
        _boxes(points, still)[0], _boxes(points, moving), figure.scale * gait.stride, gait.slowest
    )


def _points(figure: Figure, number: int) -> Floats:
    """Return the points of a drawn part in its own frame [m], shape (P, 3)."""
    points = _corners(shapes_of(figure)[number])
    joints = [joint for joint in figure.joints if joint.shape is not None]
    if number >= len(joints):
        return points
    if joints[number].spins:
        points = _swept(points, 0, 2)
    if joints[number].steers != 0.0:
        points = _swept(points, 0, 1)
    return points


@cache
def _corners(shape: Shape) -> Floats:
    """Return the corners of a shape at all levels of detail [m], shape (P, 3); people share most
    shapes, and meshes take ten times as long.
    """
    corners = [shell_of(shape, detail).corners() for detail in DETAILS]
    return np.unique(np.concatenate(corners), axis=0)


def _swept(points: Floats, a: int, b: int) -> Floats:
    """Return corners around all that points cover when they turn in the plane of two axes."""
    radius = np.sqrt(points[:, a] * points[:, a] + points[:, b] * points[:, b])
    corners = np.repeat(points[None], 4, axis=0)
    corners[:, :, a] = np.array([1, 1, -1, -1])[:, None] * radius
    corners[:, :, b] = np.array([1, -1, 1, -1])[:, None] * radius
    return corners.reshape(-1, 3)


def _boxes(
    points: list[Floats],  # The points of each of S parts
    frames: Floats,  # Frames of the parts, shape (K, S, 3, 4)
) -> Floats:
    """Return the boxes around all parts, shape (K, 2, 3)."""
    low = np.full((len(frames), 3), np.inf)
    high = -low
    for part, own in enumerate(points):
        for axis in range(3):
            row = frames[:, part, axis]
            there = row[:, 3:] + sum(row[:, k : k + 1] * own[:, k] for k in range(3))
            low[:, axis] = np.minimum(low[:, axis], there.min(axis=1))
            high[:, axis] = np.maximum(high[:, axis], there.max(axis=1))
    return np.stack([low, high], axis=1)
