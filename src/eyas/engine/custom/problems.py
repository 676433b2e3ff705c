"""Problems of a shape or a trajectory, one line each."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from eyas.engine.custom.mesh_file import LARGEST, Triangles
from eyas.engine.custom.smoothing import smoothed
from eyas.engine.custom.trajectory import JUMP, Trajectory
from eyas.engine.state.scene import Scene
from eyas.engine.state.terrain import reliefs
from eyas.lanes import exact

_LARGE, _SMALL = 60.0, 0.05  # Lengths from which on a target is hardly one: a unit is suspected [m]
LONGEST = 100.0  # Largest length of a target [m]
_USUAL = 2.0  # Length of a usual target [m]
_UNITS = {0.001: "millimetres", 0.01: "centimetres", 1000.0: "kilometres"}
_GAP = 5.0  # Time between two points from which on a gap is told [s]
_RARE = 60.0  # Time between most points from which on another unit is suspected [s]
_STILL, _FEW = 0.2, 10  # Way of a trajectory of so many points from which on it moves [m]
_TICK, _ROUGH = 0.1, 1.5
"""Steps in which accelerations are looked at [s], and what half of them seldom exceed [m/s^2]."""

_SMOOTHINGS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0)
"""Times that are tried in turn, from that between two points on [s]."""

_CALM, _SETTLED = 0.1, 1.2
"""An acceleration that is calm enough [m/s^2], and the power of the time with which it falls where
it is hardly one of errors: that of errors falls by 1.5, if they last, to 2.5."""

_TRIED = 3000  # Number of points on which they are tried
_HIGHEST = 10_000.0  # Largest height of a point, also below ground [m]
_ALOFT = 3.0  # Distance from the ground that is told [m]


class Finding(NamedTuple):
    """Something to tell."""

    text: str
    fatal: bool  # Whether the target cannot be used


def numbered(count: int, noun: str, several: str = "") -> str:
    """Return a number of things in words."""
    return f"{count} {noun if count == 1 else several or noun + 's'}"


def worst(findings: Iterator[Finding]) -> str:
    """Return the first that is fatal; empty if none is."""
    return next((finding.text for finding in findings if finding.fatal), "")


def of_shape(shape: Triangles) -> Iterator[Finding]:
    """Yield what is wrong with a shape in metres."""
    if not np.isfinite(shape.points[shape.corners]).all():
        bad = int((~np.isfinite(shape.points)).any(axis=1).sum())
        yield Finding(f"{numbered(bad, 'vertex', 'vertices')} not finite (NaN)", fatal=True)
        return
    count, size = len(shape.corners), shape.size
    if count > LARGEST:
        advice = f"simplify it with custom.most_triangles={LARGEST // 10}"
        yield Finding(f"{count} triangles; allowed: up to {LARGEST}; {advice}", fatal=True)
    extent = " x ".join(f"{length:.4g}" for length in size)
    if min(size) < 1e-6 * max(max(size), 1e-9):
        yield Finding(f"it has no size, or is flat: {extent} m", fatal=True)
        return
    if max(size) > _LARGE or max(size) < _SMALL:
        yield Finding(f"{extent} m: {_unit(max(size))}", fatal=max(size) > LONGEST)
    if count <= LARGEST:
        yield from _surface(shape)


def of_trajectory(
    trajectory: Trajectory,  # The trajectory
    size: tuple[float, float],  # Extent of the map in x and y; its middle is the origin [m]
    map_name: str,  # Its name
) -> Iterator[Finding]:
    """Yield what is wrong with a trajectory on a map."""
    steps = trajectory.steps()
    for k in trajectory.jumps().tolist()[:3]:
        seconds = trajectory.time[k] - trajectory.time[k - 1]
        yield Finding(
            f"point {k + 1}: it jumps {_metres(steps[k - 1])} m in {seconds:g} s; allowed: up to "
            f"{JUMP:g} m/s",
            fatal=True,
        )
    high = np.flatnonzero(np.abs(trajectory.position[:, 2]) > _HIGHEST)  # NaN: on the ground
    if len(high):
        z = trajectory.position[high[0], 2]
        yield Finding(
            f"point {high[0] + 1}: z = {_metres(z)} m is not allowed: up to {_HIGHEST:g} m from "
            "the lowest ground of the map",
            fatal=True,
        )
    beyond = np.abs(trajectory.position[:, :2]) > 0.5 * np.array(size)
    outside = beyond[:, 0] | beyond[:, 1]
    if outside.any():
        extent = " x ".join(f"{length:.0f}" for length in size)
        yield Finding(
            f"{int(outside.sum())} of {len(outside)} points are outside the map '{map_name}' "
            f"({extent} m about the origin), first point {int(np.argmax(outside)) + 1}",
            fatal=bool(outside.all()),
        )
    if np.ptp(trajectory.position[:, :2], axis=0).max() < _STILL and len(outside) > _FEW:
        yield Finding(
            f"it moves by less than {_STILL:g} m: are x and y degrees? they are metres from the "
            "middle of the map",
            fatal=False,
        )
    pause = np.diff(trajectory.time)
    gaps = np.flatnonzero(pause > _GAP)
    if np.median(pause) > _RARE:
        yield Finding(
            f"points are {np.median(pause):.0f} s apart: is t in milliseconds? it is in seconds",
            fatal=False,
        )
    elif len(gaps):
        yield Finding(
            f"{numbered(len(gaps), 'gap')} of more than {_GAP:g} s, where a curve is guessed; the "
            f"first after point {int(gaps[0]) + 1}",
            fatal=False,
        )


def of_height(trajectory: Trajectory, scene: Scene) -> Iterator[Finding]:
    """Yield what is unusual about the heights that a trajectory tells."""
    above = trajectory.position[:, 2] - reliefs(scene.terrain, trajectory.position[:, :2])
    most = float(np.abs(above).max())
    if most > _ALOFT:  # NaN: it stays on the ground
        side = "above" if np.abs(above).max() == above.max() else "below"
        yield Finding(
            f"it is up to {most:.4g} m {side} the ground: z counts from the lowest ground of the "
            "map; without z it stays on the ground",
            fatal=False,
        )


def of_noise(trajectory: Trajectory) -> Iterator[Finding]:
    """Yield that a trajectory is hardly that of a body, but of a receiver that errs."""
    if trajectory.time[-1] <= _TICK * _FEW:
        return
    usual = _roughness(trajectory)
    if usual > _ROUGH:
        seconds = _calming(trajectory)
        calm = smoothed(trajectory, seconds)
        assert calm.velocity is not None  # it is smoothed
        cut = 0.5 * seconds * float(np.linalg.norm(calm.velocity[:, :2], axis=1).max())
        yield Finding(
            f"its velocity changes by {usual:.1f} m/s^2 most of the time: if these are errors of "
            f"a receiver, custom.smoothing={seconds:g} leaves {_roughness(calm):.1f} m/s^2, and "
            f"cuts a sharp turn by up to {cut:.2g} m",
            fatal=False,
        )


def _metres(length: float) -> str:
    return f"{length:.0f}" if abs(length) < 1e7 else f"{length:.3g}"


def _calming(trajectory: Trajectory) -> float:
    """Return the shortest smoothing that leaves hardly more than the body's own motion [s]."""
    few = slice(_TRIED)
    begin = Trajectory(trajectory.time[few], trajectory.position[few], None)
    step = float(np.median(np.diff(begin.time)))
    times = [seconds for seconds in _SMOOTHINGS[:-1] if seconds >= step] + [_SMOOTHINGS[-1]]
    rough = np.array([_roughness(smoothed(begin, seconds)) for seconds in times])
    calms = -np.diff(exact.log(rough + 1e-9)) / np.diff(exact.log(np.array(times)))
    enough = (rough[:-1] <= _CALM) | (calms <= _SETTLED)
    return times[int(np.argmax(enough)) if enough.any() else -1]


def _roughness(trajectory: Trajectory) -> float:
    """Return the acceleration that a trajectory exceeds half of the time [m/s^2]."""
    time = np.arange(0.0, trajectory.time[-1], _TICK)
    velocity = np.gradient(trajectory.at(time)[0][:, :2], _TICK, axis=0)
    return float(np.median(exact.hypot(*np.gradient(velocity, _TICK, axis=0).T)))


def _unit(longest: float) -> str:
    """Return a guess at the unit of a length: that of which it would be the most usual one."""
    scale = min(_UNITS, key=lambda scale: abs(exact.log(longest * scale / _USUAL)))
    if not _SMALL <= longest * scale <= _LARGE:
        return f"allowed: {_SMALL:g} to {LONGEST:g} m; choose custom.scale (--scale)"
    return f"in {_UNITS[scale]}? then use custom.scale={scale:g} (--scale {scale:g})"


def _surface(shape: Triangles) -> Iterator[Finding]:
    """Yield what is wrong with the surface: holes, and the wrong side outside."""
    extent = max(shape.size)
    _, place = np.unique(np.rint(shape.points / (1e-6 * extent)), axis=0, return_inverse=True)
    corners = place.ravel()[shape.corners]
    a, b, c = corners.T
    flat = (a == b) | (b == c) | (c == a)
    edges = np.concatenate([corners[~flat][:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    _, times = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    single = int((times == 1).sum())
    if single:
        yield Finding(
            f"it is not closed: {numbered(single, 'edge')} with one triangle only, behind which "
            "one looks through it",
            fatal=False,
        )
    p, q, r = np.moveaxis(shape.points[shape.corners], 1, 0)
    if not single and float(exact.dot(p, np.cross(q, r)).sum()) < 0.0:
        yield Finding("it is inside out: its triangles run clockwise from outside", fatal=False)
