"""`eyas bench --device`: pictures on a device, such as a graphics processor."""

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.cli.bench.measurement import Measurement
from eyas.cli.bench.pictures import PictureBatch
from eyas.engine.camera.config import CameraConfig
from eyas.engine.render.outputs import NO_OUTPUT
from eyas.engine.render.renderer import CpuRenderer
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import DrawList, DrawStage, Picture, Views
from eyas.engine.trackers.kinds import tracker_of
from eyas.engine.world.config import WorldConfig
from eyas.gpu.render.read_back import ReadBackRenderer, UploadedViews
from eyas.lanes.device import Device

ON_DEVICES = (
    *(PictureBatch(views, 84, 84) for views in (256, 1024, 4096, 16384)),
    PictureBatch(4096, 84, 84, samples=4),
    PictureBatch(4096, 84, 84, weather="snow"),
    PictureBatch(4096, 84, 84, weather="night"),
    *(PictureBatch(views, 640, 480) for views in (64, 256)),
)
"""What is drawn on devices."""

_INCLUDES = "culling, shading with shadows, RGB, left on the device; no traffic, no posing"


class _Kept:
    """Keeps what a simulation wants to be drawn; a `Renderer` that draws nothing."""

    def __init__(self, renderer: CpuRenderer) -> None:
        self._renderer = renderer
        self.last: tuple[Views, DrawList] | None = None

    def part_reach(self) -> NDArray[np.float64]:
        """See `Renderer`."""
        return self._renderer.part_reach()

    def influence(self, reach: NDArray[np.float64]) -> NDArray[np.float64]:
        """See `Renderer`."""
        return self._renderer.influence(reach)

    def draw(
        self,
        views: Views,
        draw_list: DrawList,
        picture: Picture,
        samples: int = 1,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Keep the views and the moving things, which are used again for the next ones."""
        del picture, samples, until
        self.last = views, draw_list


def _views(pictures: PictureBatch) -> tuple[CpuRenderer, Views, DrawList]:
    """Return what trackers see that begin on citystreet, each in a world of its own."""
    config = SimConfig(
        camera=CameraConfig(samples=pictures.samples), world=WorldConfig(weather=pictures.weather)
    )
    assets = load_assets(config.world, config.traffic, 1)
    renderer = assets.renderer
    assert isinstance(renderer, CpuRenderer)
    kept = _Kept(renderer)
    simulation = Simulation(
        config,
        replace(assets, renderer=kept),
        tracker_of(config.tracker),
        each_alone(pictures.views),
    )
    simulation.reset()
    trackers = np.arange(pictures.views, dtype=np.int32)
    simulation.draw(trackers, Picture.create(pictures.views, 1, 1))
    assert kept.last is not None
    return renderer, *kept.last


def measure_device(
    device: Device,
    seconds: float,  # Time to measure each [s]
) -> Iterator[Measurement]:
    """Measure pictures of several numbers, sizes and weathers."""
    for pictures in ON_DEVICES:
        yield measure_on_device(device, pictures, seconds)


def measure_on_device(device: Device, pictures: PictureBatch, seconds: float) -> Measurement:
    """Return the measurement of drawing pictures that stay on the device.

    Args:
        seconds: Time to measure [s].
    """
    renderer, given = on_device(device, pictures)
    spent = seconds_of(device, lambda: renderer.draw_uploaded(given), seconds)
    rate = pictures.views / statistics.median(spent)
    return Measurement(f"{pictures.name}, {device.name}", rate, "/s", _INCLUDES, len(spent))


def on_device(device: Device, pictures: PictureBatch) -> tuple[ReadBackRenderer, UploadedViews]:
    """Return what draws pictures, and what they show, on a device."""
    renderer, views, movers = _views(pictures)
    shape = (pictures.views, pictures.height, pictures.width, 3)
    output = NO_OUTPUT._replace(rgb=np.zeros(shape, np.uint8))
    drawing = ReadBackRenderer(device, renderer)
    return drawing, drawing.uploaded(views, movers, shape[1:3], output, pictures.samples)


def seconds_of(device: Device, call: Callable[[], object], seconds: float) -> list[float]:
    """Return how long work takes that a call asks of a device, time after time [s].

    A card measures it itself, by events in its order of work; at least five times.
    """
    call()
    call()
    device.synchronise()
    spent: list[float] = []
    event = getattr(device, "event", None)
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(spent) < 5:
        begun = time.perf_counter() if event is None else event()
        call()
        if event is None:
            device.synchronise()
            spent.append(time.perf_counter() - begun)
        else:
            spent.append(event().since(begun))
    return spent
