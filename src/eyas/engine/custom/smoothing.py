"""Trajectories without most of the errors of the receiver that recorded them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.custom.trajectory import Trajectory
from eyas.lanes import exact

_SLOW = 0.5  # Speed below which a body may stand [m/s]
_LONG = 4.0
"""Shortest stand, in times of the smoothing: within it, the spline forgets what was before."""

_SHORTEST = 1e-3
"""Shortest smoothing, which does nothing yet; numbers of a much shorter one overflow [s]."""

_VAGUE = 1e10
"""Variance of the first position before any point is seen, in that of a point: it counts for
nothing."""

Floats = NDArray[np.float64]


def smoothed(trajectory: Trajectory, seconds: float) -> Trajectory:
    """Return a trajectory whose positions are smoothed over a time T = `seconds`, above 0.

    The path f is the cubic smoothing spline (Reinsch 1967) that minimises

        sum_k w_k |p_k - f(t_k)|^2 + T^4 integral |f''(t)|^2 dt

    where a point p_k counts for the time w_k around it: half of that to the point before and to the
    next, each up to T. So uneven points and gaps need no care, and the number of points a second
    hardly matters. Motion at constant velocity stays as it is, also at both ends. Elsewhere f is an
    average with the weights exp(-s) sin(s + pi / 4) / 2T, s = |t| / (sqrt(2) T) (Silverman 1984,
    Annals of Statistics 12, 898-916): a motion of angular frequency a keeps 1 / (1 + (a T)^4) of
    its extent, white errors of N points a second keep 0.51 / sqrt(N T) of their size, and a sharp
    turn by 90 degrees at speed v is cut by v T / 2.

    Where the path is slow and winds about less than the points err, the body stands: these points
    are put into their middle, and smoothed again. Headings of the file stay as they are.
    """
    seconds = max(seconds, _SHORTEST)
    known = ~np.isnan(trajectory.position).any(axis=0)
    points = trajectory.position[:, known]
    place, velocity = _spline(trajectory.time, points, seconds)
    still = _with_stands(trajectory.time, points, place, velocity, seconds)
    if still is not None:
        place, velocity = _spline(trajectory.time, still, seconds)
    both = np.full((2, *trajectory.position.shape), np.nan)
    both[:, :, known] = place, velocity
    return replace(trajectory, position=both[0], velocity=both[1])


def _with_stands(
    time: Floats, points: Floats, place: Floats, velocity: Floats, seconds: float
) -> Floats | None:
    """Return points (N, D) with those of each stand in its middle; None if the body never stands.

    `place` and `velocity` are those of the smoothed path [m, m/s], `seconds` its time constant.
    """
    slow = exact.hypot(velocity[:, 0], velocity[:, 1]) < _SLOW
    edges = np.flatnonzero(np.diff(np.concatenate([[False], slow, [False]])))
    out, stands = points.copy(), False
    for first, end in edges.reshape(-1, 2):
        if time[end - 1] - time[first] < _LONG * seconds:
            continue
        path, error = place[first:end, :2], (points - place)[first:end, :2]
        if np.var(path, axis=0).sum() <= np.square(error).mean(axis=0).sum():
            out[first:end] = points[first:end].mean(axis=0)
            stands = True
    return out if stands else None


def _spline(time: Floats, points: Floats, seconds: float) -> tuple[Floats, Floats]:
    """Return positions and velocities of the spline at its points, each of shape (N, D).

    The spline is the mean of an integrated random walk, given the points (Wahba 1978), which the
    smoother of Rauch, Tung and Striebel (1965) finds in two passes: unlike a system of equations,
    it stays exact where points are close together or far apart.
    """
    step = np.diff(time)
    near = np.concatenate([[0.0], np.minimum(step, seconds), [0.0]])
    variance = 2.0 * seconds / (near[:-1] + near[1:])
    x, v = points[0], np.zeros(points.shape[1])
    a, b, c = _VAGUE, 0.0, _VAGUE / (seconds * seconds)  # covariance of x and v: [[a, b], [b, c]]
    known, guessed = [], []
    for k, point in enumerate(points):
        if k:
            h, noise = step[k - 1], step[k - 1] / (seconds * seconds * seconds)
            x = x + h * v
            a, b, c = (
                a + h * (2.0 * b + h * c) + noise * h * h / 3.0,
                b + h * c + noise * h / 2.0,
                c + noise,
            )
        guessed.append((x, v, a, b, c))
        gain = 1.0 / (a + variance[k])
        x, v = x + a * gain * (point - x), v + b * gain * (point - x)
        a, b, c = a * variance[k] * gain, b * variance[k] * gain, c - b * b * gain
        known.append((x, v, a, b, c))
    place, velocity = np.empty_like(points), np.empty_like(points)
    place[-1], velocity[-1] = x, v
    for k in range(len(points) - 2, -1, -1):
        x, v, a, b, c = known[k]
        next_x, next_v, p, q, r = guessed[k + 1]
        d, e = a + step[k] * b, b + step[k] * c  # covariances of x and v with the next x
        whole = p * r - q * q
        dx, dv = place[k + 1] - next_x, velocity[k + 1] - next_v
        along, across = (r * dx - q * dv) / whole, (p * dv - q * dx) / whole
        place[k], velocity[k] = x + d * along + b * across, v + e * along + c * across
    return place, velocity
