"""Paths on the ground: chains of straight lines and arcs, with turns on the spot between them."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

_SHARP: Final = 2.0  # Corners sharper than this are turned on the spot [rad]

_STEP: Final = 0.2  # Largest turn between points that stand for an arc [rad]

Floats = NDArray[np.float64]


class Chain(NamedTuple):
    """A path of M pieces."""

    start: tuple[float, float, float]  # East, north [m] and heading [rad] before the first piece
    spin: Floats  # Turn on the spot before each piece, counter-clockwise [rad], shape (M,)
    length: Floats  # [m], shape (M,)
    curvature: Floats  # Counter-clockwise [1/m], 0 for a straight line, shape (M,)


class Poses(NamedTuple):
    """Poses on a path, shape (K,) each."""

    x: Floats  # East [m]
    y: Floats  # North [m]
    yaw: Floats  # Heading, without jumps [rad]


def chain_of(
    pieces: list[tuple[float, float, float]],  # Spin [rad], length [m] and curvature [1/m] of each
    start: tuple[float, float, float],  # See `Chain`
) -> Chain:
    """Return a path."""
    spin, length, curvature = np.array(pieces, np.float64).reshape(-1, 3).T
    return Chain(start, spin, length, curvature)


def chain_through(
    points: Floats,  # Corners [m], shape (K, 2), at least 2, neighbours apart
    radius: float,  # Wanted radius of the corners; short sides make it smaller [m]
    rounds: int,  # How often the path is gone round
) -> Chain:
    """Return a closed path past points, with rounded corners; sharp ones are turned on the spot."""
    sides = np.roll(points, -1, axis=0) - points
    lengths = exact.hypot(sides[:, 0], sides[:, 1])
    headings = exact.atan2(sides[:, 1], sides[:, 0])
    # Turn at the end of each side.
    turn = np.roll(headings, -1) - headings
    turn = (turn + math.pi) % (2.0 * math.pi) - math.pi
    sharp = np.abs(turn) > _SHARP
    half = exact.tan(0.5 * np.where(sharp, 0.0, np.abs(turn)))
    cut = np.minimum(radius * half, 0.45 * np.minimum(lengths, np.roll(lengths, -1)))
    line = lengths - cut - np.roll(cut, 1)
    rounded = (half > 1e-6) & ~sharp
    real = np.divide(cut, half, out=np.ones_like(cut), where=rounded)
    arc = np.where(rounded, real * np.abs(turn), 0.0)
    bend = np.where(rounded, np.sign(turn) / real, 0.0)
    spin_after = np.where(sharp, turn, 0.0)
    # Each side gives a line and an arc; the spin at its end comes before the next line.
    spin = np.tile(np.column_stack([np.roll(spin_after, 1), np.zeros_like(line)]).ravel(), rounds)
    spin[0] = 0.0
    first = points[0] + sides[0] / lengths[0] * cut[-1]
    return Chain(
        (float(first[0]), float(first[1]), float(headings[0])),
        spin,
        np.tile(np.column_stack([line, arc]).ravel(), rounds),
        np.tile(np.column_stack([np.zeros_like(line), bend]).ravel(), rounds),
    )


def joints(chain: Chain) -> Poses:
    """Return the poses at the beginnings of the pieces, after their spins, and at the end."""
    yaw = headings(chain)
    dx, dy = _moved(yaw[:-1], chain.length, chain.curvature)
    x = chain.start[0] + np.concatenate([[0.0], np.cumsum(dx)])
    y = chain.start[1] + np.concatenate([[0.0], np.cumsum(dy)])
    return Poses(x, y, yaw)


def headings(chain: Chain) -> Floats:
    """Return the headings of `joints` alone, which cost a tenth [rad], shape (M + 1,)."""
    turned = chain.curvature * chain.length
    yaw: Floats = chain.start[2] + np.cumsum(chain.spin) + np.cumsum(turned) - turned
    return np.concatenate([yaw, yaw[-1:] + turned[-1:]])


def outline(chain: Chain) -> Floats:
    """Return points whose connecting lines stay within centimetres of a path, shape (K, 2) [m]."""
    turn = np.abs(chain.curvature * chain.length)
    count = np.maximum(np.ceil(turn / _STEP).astype(np.int64), 1)
    piece = np.repeat(np.arange(len(count)), count)
    place = np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count)
    along = chain.length[piece] * place / count[piece]
    at = joints(chain)
    dx, dy = _moved(at.yaw[piece], along, chain.curvature[piece])
    x, y = np.append(at.x[piece] + dx, at.x[-1]), np.append(at.y[piece] + dy, at.y[-1])
    return np.column_stack([x, y])


def _moved(yaw: Floats, along: Floats, bend: Floats) -> tuple[Floats, Floats]:
    """Return how far east and north an arc leads [m]."""
    turned = 0.5 * bend * along
    straight = turned == 0.0
    chord = along * np.where(straight, 1.0, exact.sin(turned) / np.where(straight, 1.0, turned))
    return chord * exact.cos(yaw + turned), chord * exact.sin(yaw + turned)
