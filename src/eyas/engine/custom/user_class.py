"""A user's class: made, and asked what it must answer; all that goes wrong is told in one line."""

from collections.abc import Iterator
from contextlib import contextmanager
from traceback import extract_tb

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.core.own_code import left_out, takes
from eyas.engine.core.registry import Registry
from eyas.engine.custom.mesh_file import LARGEST
from eyas.engine.custom.own import MovesItself, OwnTarget, Ride
from eyas.engine.custom.problems import LONGEST, numbered, of_trajectory, worst
from eyas.engine.custom.trajectory import Trajectory
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.scene import Scene

_CLASSES: Registry[type] = Registry("custom.path", type, {})

Floats = NDArray[np.float64]


def made(path: str) -> OwnTarget:
    """Return a new target of a user's class, after looking at what it returns.

    Raises:
        EyasError: It cannot be used: one line.
    """
    kind = _CLASSES.get(path)
    needed = ("parts", "pose")
    if left_out(kind, needed) or not all(callable(getattr(kind, name)) for name in needed):
        raise _refused(path, "it has not all of: size, parts(), pose(ride)")
    if why := takes(kind):
        raise _refused(path, f"a class that is made without arguments is needed; {why}")
    with _asking(path, "the class"):
        instance = kind()
        # This reads its attributes, of which some may be properties.
        target = instance if isinstance(instance, OwnTarget) else None
    if target is None:
        raise _refused(path, "it has not all of: size, parts(), pose(ride)")
    with _asking(path, "size"):
        answer, size = target.size, _numbers(target.size)
    if size.shape != (3,) or not (np.isfinite(size) & (size > 0.0) & (size <= LONGEST)).all():
        allowed = f"three lengths above 0 and up to {LONGEST:g} [m]"
        raise _refused(path, f"size is {answer!r}; allowed: {allowed}")
    with _asking(path, "parts()"):
        parts = target.parts()
        many = isinstance(parts, (list, tuple)) and len(parts) > 0
    if not many or not all(isinstance(part, Mesh) and len(part.triangles) for part in parts):
        raise _refused(path, "parts() must return one or more meshes with triangles, in a list")
    count = sum(len(part.triangles) for part in parts)
    if count > LARGEST:
        raise _refused(path, f"{count} triangles; allowed: up to {LARGEST}")
    posed(target, path, Ride(*np.ones((3, 2))), len(parts))
    return target


def posed(target: OwnTarget, path: str, ride: Ride, parts: int) -> Floats:
    """Return the poses of P parts of K bodies, shape (K, P, 3, 4), see `OwnTarget.pose`.

    Raises:
        ConfigError: The user's class fails, or returns something else: one line.
    """
    count = len(ride.travelled)
    farthest = np.max(ride.travelled, initial=0.0)
    what = f"pose(ride) of {numbered(count, 'body', 'bodies')} after {farthest:.4g} m"
    with _asking(path, what):
        poses = _numbers(target.pose(ride))
    _check(path, what, poses, (count, parts, 3, 4))
    return poses


def tracks_of(
    target: MovesItself, path: str, scene: Scene, time: Floats, count: int, rng: np.random.Generator
) -> Floats:
    """Return the ways that a user's class computes, see `MovesItself.tracks`.

    Raises:
        ConfigError: They are not ways on this map: one line.
    """
    with _asking(path, "tracks(...)"):
        tracks = _numbers(target.tracks(scene, time, count, rng))
    _check(path, "tracks(...)", tracks, (len(time), count, 3))
    for body in range(count):
        way = Trajectory.of_track(time, tracks[:, body])
        if problem := worst(of_trajectory(way, scene.size, scene.name)):
            raise _refused(path, f"tracks(...), body {body + 1} of {count}: {problem}")
    return tracks


@contextmanager
def _asking(path: str, what: str) -> Iterator[None]:
    """Turn what a user's code raises into one line that says where."""
    try:
        yield
    except (EyasError, KeyboardInterrupt):
        raise
    except BaseException as error:  # anyone's code can raise anything, `SystemExit` too
        last = extract_tb(error.__traceback__)[-1]
        place = "" if last.filename == __file__ else f" ({last.filename}, line {last.lineno})"
        text = " ".join(f"{type(error).__name__}: {error}".split())[:500]
        raise _refused(path, f"{what} raised {text}{place}") from error


def _numbers(answer: object) -> Floats:
    """Return an answer as numbers; with shape () if it is something else."""
    try:
        return np.asarray(answer, np.float64)
    except (TypeError, ValueError):
        return np.array(np.nan)


def _check(path: str, what: str, numbers: Floats, shape: tuple[int, ...]) -> None:
    if numbers.shape != shape or not np.isfinite(numbers).all():
        got = f"an array of shape {numbers.shape}" if numbers.shape else "no array of numbers"
        if numbers.shape == shape:
            got = "numbers that are not finite"
        raise _refused(path, f"{what} returned {got}; allowed: finite numbers of shape {shape}")


def _refused(path: str, problem: str) -> ConfigError:
    return ConfigError(f"custom.path: {path!r}: {problem}")
