"""Compare Eyas with other renderers without a GPU: the same streets, cars and cameras, in turns.

    pip install -e '.[peers]'    (moderngl also needs Mesa: apt install libegl1 libgl1-mesa-dri)
    python bench/peers.py [--views 64] [--seconds 10] [--pictures FOLDER]

All draw the same triangles: everything at its finest level of detail, textured, mip-mapped, lit and
in haze. moderngl has a shadow map; panda3d's software renderer has no shadows, pybullet's no
textures either. Eyas draws everything that it draws by default; a last line is for Eyas with its
own choice of levels. Times are those of all threads on the processor, and include reading the
pictures back.

HyperLux (pip, 0.1.8) is left out: its wheel holds C++ sources, which are compiled when they are
first used and want other sources from GitHub then.
"""

import argparse
import importlib
import time
from pathlib import Path
from typing import Protocol

import numpy as np
from city import City, finest_renderer, load_city
from PIL import Image

from eyas.engine.core.machine import describe_machine
from eyas.engine.render.renderer import CpuRenderer
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.state.draw import DrawList, Picture
from eyas.engine.state.scene import ACTOR_OBJECT

SIDE = 84
"""Size of the pictures [pixels]."""


class Drawer(Protocol):
    """A renderer to compare."""

    name: str
    rgb: np.ndarray

    def draw(self) -> None:
        """Draw all views into `rgb`."""


class Ours:
    """Eyas."""

    def __init__(self, city: City, side: int, name: str, renderer: CpuRenderer) -> None:
        self.name, self._renderer, self._views = name, renderer, city.views
        count = sum(map(len, city.slots))
        self._movers = DrawList.create(1, count)
        parts = [np.full(len(poses), k) for k, poses in enumerate(city.slots)]
        self._movers.part[0] = np.concatenate(parts)
        self._movers.pose[0] = np.concatenate(city.slots)
        self._movers.colour[0] = np.concatenate(city.slot_colours)
        self._movers.object_id[0] = ACTOR_OBJECT + np.arange(count)
        self._picture = Picture.create(len(city.views.position), side, side)

    def draw(self) -> None:
        """Draw all views into `rgb`."""
        self._renderer.draw(self._views, self._movers, self._picture)
        assert self._picture.rgb is not None
        across = int(np.ceil(np.sqrt(len(self._picture.rgb))))
        tiles = self._picture.rgb[: across * across]
        rows = tiles.reshape(across, across, SIDE, SIDE, 3)[::-1]
        self.rgb = rows.swapaxes(1, 2).reshape(across * SIDE, across * SIDE, 3)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--views", type=int, default=64, help="a square number")
    parser.add_argument("--seconds", type=float, default=10.0, help="in all, for each")
    parser.add_argument("--pictures", type=Path, help="where to write what each drew")
    arguments = parser.parse_args()
    city = load_city(arguments.views)
    assets = load_assets(SimConfig().world, SimConfig().traffic, 1)
    drawers: list[Drawer] = [Ours(city, SIDE, "eyas", finest_renderer(assets))]
    for module in ("peer_moderngl", "peer_panda3d", "peer_pybullet"):
        try:
            drawers.append(importlib.import_module(module).Peer(city, SIDE))
        except Exception as error:  # a missing driver may raise anything
            print(f"{module}: left out: {error}")
    drawers.append(Ours(city, SIDE, "eyas-levels (with levels of detail)", assets.renderer))
    times = [1e6 * spent / arguments.views for spent in _times(drawers, arguments.seconds)]
    print(f"{arguments.views} pictures of {SIDE}x{SIDE}, {describe_machine()}")
    print("processor's time of a picture, and how often ours goes into it:")
    for drawer, spent in zip(drawers, times, strict=True):
        print(f"{spent:10,.0f} us  {spent / times[0]:7.1f}x  {drawer.name}")
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
        for drawer in drawers:
            rgb = np.ascontiguousarray(drawer.rgb[..., :3])
            rgb = rgb if isinstance(drawer, Ours) else rgb[::-1]
            Image.fromarray(rgb).save(arguments.pictures / f"{drawer.name.split()[0]}.png")


def _times(drawers: list[Drawer], seconds: float) -> list[float]:
    """Return the shortest processor time of a call of each [s], of turns of half a second."""
    shortest = [np.inf] * len(drawers)
    for drawer in drawers:
        drawer.draw()
    for _ in range(max(int(seconds / 0.5), 3)):
        for number, drawer in enumerate(drawers):
            end = time.perf_counter() + 0.5
            while time.perf_counter() < end:
                start = time.process_time()
                drawer.draw()
                shortest[number] = min(shortest[number], time.process_time() - start)
    return shortest


if __name__ == "__main__":
    main()
