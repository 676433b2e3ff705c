"""Tell whether a target can be used, and why not."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from eyas.engine.core.errors import EyasError, UnknownNameError
from eyas.engine.core.files import user_path
from eyas.engine.core.rng import stream
from eyas.engine.custom.config import ENDINGS, CustomConfig
from eyas.engine.custom.kind import as_custom, own_target
from eyas.engine.custom.mesh_file import loaded
from eyas.engine.custom.own import MovesItself, OwnTarget, Ride
from eyas.engine.custom.problems import (
    Finding,
    numbered,
    of_height,
    of_noise,
    of_shape,
    of_trajectory,
)
from eyas.engine.custom.shape import simplified
from eyas.engine.custom.tracks import Placement, endings, is_track, on_map
from eyas.engine.custom.trajectory import Trajectory
from eyas.engine.custom.user_class import posed, tracks_of
from eyas.engine.sim.scenes import load_scene
from eyas.engine.targets.catalogue import KINDS, MODELS
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.place import projection_of

_SECONDS = 60  # Time for which a motion of one's own is tried [s]

_OUT, _LOST = 0.05, 0.25
"""Shares of its size: how far a body may stick out of its box, and what it must fill of it."""


def check(what: str, config: CustomConfig, map_name: str) -> tuple[list[str], bool]:
    """Return lines about a target, and whether it can be used.

    Args:
        what: A name of the catalogue, a file, or `package.module:Class`.

    Raises:
        UnknownNameError: There is no such name.
    """
    try:
        findings = list(_findings(what, config, map_name))
    except UnknownNameError:
        raise
    except EyasError as error:
        findings = [Finding(str(error), fatal=True)]
    usable = not any(finding.fatal for finding in findings)
    lines = [f"{'not usable' if one.fatal else 'note'}: {one.text}" for one in findings]
    return [*lines, *([f"usable: {what}"] if usable else [])], usable


def _findings(what: str, config: CustomConfig, map_name: str) -> Iterator[Finding]:
    path, own = user_path(what), as_custom(what, config)
    if own is not None and own.mesh is not None:
        yield from _mesh(own)
    elif is_track(path):
        yield from _trajectories(path, config, map_name)
    elif own is not None:
        yield from _class(what, map_name)
    else:
        names = dict.fromkeys([*(kind.name for kind in KINDS), *(model.name for model in MODELS)])
        if what not in names:
            files = ", ".join((*ENDINGS, *endings()))
            others = f"(nor a file {files}, nor 'package.module:Class')"
            raise UnknownNameError("target", what, names, others)


def _mesh(config: CustomConfig) -> Iterator[Finding]:
    shape = loaded(config)
    if shape.left_out:
        yield Finding(shape.left_out, fatal=False)
    whole = len(shape.corners)
    if config.most_triangles is not None and np.isfinite(shape.points).all():
        shape = simplified(shape, config.most_triangles)
    yield from of_shape(shape)
    simpler = f" of {whole}" if len(shape.corners) < whole else ""
    if not np.isfinite(shape.points).all():
        return
    size = " x ".join(f"{length:.3g}" for length in shape.size)
    colours = len(np.unique(shape.colours, axis=0))
    yield Finding(
        f"{len(shape.corners)}{simpler} triangles, {numbered(colours, 'colour')}, {size} m",
        fatal=False,
    )


def _trajectories(path: Path, config: CustomConfig, map_name: str) -> Iterator[Finding]:
    scene = load_scene(map_name)
    projection = projection_of(MAPS.get(map_name))
    for _, trajectory in on_map([path], Placement(map_name, projection, config.at, config.speed)):
        yield from of_trajectory(trajectory, scene.size, map_name)
        yield from of_height(trajectory, scene)
        yield from of_noise(trajectory)
        step = np.hypot(*np.diff(trajectory.position[:, :2], axis=0).T)
        speed = step / np.diff(trajectory.time)
        yield Finding(
            f"{len(trajectory.time)} points in {trajectory.time[-1]:g} s, {step.sum():.0f} m, "
            f"{speed.max():.1f} m/s at most",
            fatal=False,
        )


def _class(path: str, map_name: str) -> Iterator[Finding]:
    target = own_target(CustomConfig(path=path))
    size = " x ".join(f"{length:.3g}" for length in target.size)
    yield Finding(f"{numbered(len(target.parts()), 'part')}, {size} m", fatal=False)
    yield from _drawn(target, path)
    if isinstance(target, MovesItself):
        scene, time = load_scene(map_name), np.arange(10 * _SECONDS) / 10.0
        tracks = tracks_of(target, path, scene, time, 1, stream(0, "custom"))
        way = Trajectory.of_track(time, tracks[:, 0])
        yield from of_trajectory(way, scene.size, map_name)


def _drawn(target: OwnTarget, path: str) -> Iterator[Finding]:
    """Yield whether what is drawn at rest is not of the size that is told."""
    parts = target.parts()
    pose = posed(target, path, Ride(*np.zeros((3, 1))), len(parts))[0]
    corners = [
        part.positions @ place[:, :3].T + place[:, 3]
        for part, place in zip(parts, pose, strict=True)
    ]
    low, high = np.concatenate(corners).min(axis=0), np.concatenate(corners).max(axis=0)
    size = np.asarray(target.size)
    box = np.array([[-size[0] / 2, -size[1] / 2, 0.0], [size[0] / 2, size[1] / 2, size[2]]])
    sticks_out = max((box[0] - low).max(), (high - box[1]).max()) > _OUT * size.max()
    if sticks_out or (high - low < _LOST * size).any():
        told = ", ".join(
            f"{axis} {a:.3g} to {b:.3g}" for axis, a, b in zip("xyz", low, high, strict=True)
        )
        yield Finding(
            f"what is drawn at rest ({told} m) does not match its size; labels, lidar and contacts "
            "use the box of that size in the middle over the origin",
            fatal=False,
        )
