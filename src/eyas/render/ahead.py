"""The first start: a second process compiles kernels while the first builds the world."""

import contextlib
import logging
import os
import subprocess
import sys
from collections.abc import Callable

import numpy as np

from eyas.core.cache.folder import not_kept
from eyas.core.jit import REFUSAL, folder_in_use, nothing_compiled
from eyas.render.bake.ambient import AmbientMap
from eyas.render.bake.shadows import ShadowMap
from eyas.render.bake.tracks import TrackMap
from eyas.render.classes import class_table
from eyas.render.pack.geometry import build_geometry
from eyas.render.pack.light import build_light
from eyas.render.renderer import Renderer
from eyas.state.draw import DrawList, PartLibrary, Picture, Views
from eyas.state.lighting import Lighting
from eyas.state.scene import Scene

__all__ = ["compile_ahead"]

_log = logging.getLogger("eyas")

_PATIENCE = 300.0
"""Longest time that a first picture waits for the second process [s]."""

_started: list[subprocess.Popen[bytes]] = []
"""Kept here, because Python warns of processes that are forgotten before they end."""

_PROGRAM = "from eyas.render.ahead import draw_nothing; draw_nothing()"


def compile_ahead() -> Callable[[], object] | None:
    """Report a first start to the user, and use a second core for it if there is one.

    Returns:
        A function that waits until the drawing kernels can be loaded from the cache; None if there
        is nothing to wait for. It never fails: the first picture compiles what is missing by then.
    """
    if not nothing_compiled("draw"):
        return None
    cache = folder_in_use()
    if REFUSAL:
        not_kept(REFUSAL)
        return None
    _log.warning(
        "first start of this version: compiling takes about half a minute, once; cached in %s",
        cache,
    )
    # A frozen program has no interpreter to start.
    if (os.cpu_count() or 1) < 2 or getattr(sys, "frozen", False):
        return None
    try:
        cache.mkdir(parents=True, exist_ok=True)
        (cache / "started").touch(exist_ok=False)  # exactly one of several processes succeeds
        path = os.pathsep.join(filter(None, sys.path))
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", _PROGRAM],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    except OSError:
        return None
    _started.append(process)
    return _wait


def _wait() -> None:
    for process in _started:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(_PATIENCE)


def draw_nothing() -> None:
    """Draw a view of an empty scene, which compiles every drawing kernel."""
    scene = Scene.empty()
    geometry = build_geometry(scene, PartLibrary(()), {"plain": np.zeros((256, 256, 4), np.uint8)})
    ambient = AmbientMap(np.zeros((1, 1), np.uint16), np.zeros(4))
    black = (0.0, 0.0, 0.0)
    lighting = Lighting((0.0, 0.0, 1.0), black, black, black, black, black, black, 0.0)
    light = build_light(scene, lighting, ShadowMap.none(), ambient, TrackMap.none(), geometry)
    views = Views(
        position=np.zeros((1, 3)),
        rotation=np.eye(3)[None],
        world=np.zeros(1, np.int32),
        subject=np.zeros(1, np.int32),
        field_of_view=1.0,
    )
    renderer = Renderer(geometry, light, class_table(scene))
    renderer.draw(views, DrawList.create(1, 1), Picture.create(1, 8, 8))
