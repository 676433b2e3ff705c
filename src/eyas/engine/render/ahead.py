"""The first start: a second process compiles for the first, where kernels must be compiled."""

import contextlib
import logging
import os
import subprocess
import sys

import numpy as np

from eyas.engine.render.bake.ambient import AmbientMap
from eyas.engine.render.bake.land import no_land
from eyas.engine.render.bake.shadows import ShadowMap
from eyas.engine.render.bake.tracks import TrackMap
from eyas.engine.render.kernels.draw import draw_views
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.pack.light import Baked, build_light
from eyas.engine.render.renderer import CpuRenderer
from eyas.engine.state.draw import DrawList, PartLibrary, Picture, Views
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.scene import Scene
from eyas.lanes.entry import nothing_compiled
from eyas.lanes.folder import kernel_folder, refusal
from eyas.lanes.trusted import made_folder, not_kept

_log = logging.getLogger("eyas")

_PATIENCE = 300.0  # Longest time that this process waits for the second one [s]

_compiling: list[subprocess.Popen[bytes]] = []
"""The second process; kept even after it ends, because Python warns of processes that are forgotten
before."""

_COMPILE = "from eyas.engine.render.ahead import draw_nothing; draw_nothing()"


def begin_ahead() -> None:
    """Tell the user that kernels must be compiled, and use a second core for it if there is one.

    The second process compiles the drawing kernels while this one does everything else. It never
    fails: what is missing when this process waits for it, this process makes.
    """
    if not nothing_compiled(draw_views.function):
        return
    if refusal():
        not_kept(refusal())
        return
    cache, takes = kernel_folder(), "compiling takes about half a minute, once"
    _log.warning("first start of this version: %s; cached in %s", takes, cache)
    # A frozen program has no interpreter to start.
    if (os.cpu_count() or 1) < 2 or getattr(sys, "frozen", False):
        return
    with contextlib.suppress(OSError):
        made_folder(cache)
        (cache / "started").touch(exist_ok=False)  # exactly one of several processes succeeds
        _compiling.append(_started(_COMPILE))


def _started(program: str) -> subprocess.Popen[bytes]:
    """Return a new process that runs a program."""
    path = os.pathsep.join(filter(None, sys.path))
    return subprocess.Popen(
        [sys.executable, "-P", "-c", program],
        env={**os.environ, "PYTHONPATH": path},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def drawing_is_ready() -> None:
    """Wait until the drawing kernels can be loaded, if the second process compiles them."""
    for process in _compiling:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(_PATIENCE)


def draw_nothing() -> None:
    """Draw a view of an empty scene, which compiles every drawing kernel."""
    scene = Scene.empty()
    geometry = build_geometry(scene, PartLibrary(()), {"plain": np.zeros((256, 256, 4), np.uint8)})
    ambient = AmbientMap(np.zeros((1, 1), np.uint16), np.zeros(4))
    black = (0.0, 0.0, 0.0)
    lighting = Lighting((0.0, 0.0, 1.0), black, black, black, black, black, black, 0.0)
    baked = Baked(ShadowMap.empty(), ambient, no_land(), TrackMap.empty())
    light = build_light(scene, lighting, baked, geometry)
    views = Views(
        position=np.zeros((1, 3)),
        rotation=np.eye(3)[None],
        world=np.zeros(1, np.int32),
        subject=np.zeros(1, np.int32),
        field_of_view=1.0,
    )
    renderer = CpuRenderer(geometry, light)
    renderer.draw(views, DrawList.create(1, 1), Picture.create(1, 8, 8))
