"""Pictures of `eyas bench`: sizes, weathers, the whole city, stages, and models of cameras."""

import math
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np
from rich.table import Table

from eyas.cli.bench.measurement import Measurement, of_pictures
from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.config import updated
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.still import StillWorld
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import DrawStage, Picture, Views
from eyas.engine.world.config import WorldConfig

SIZES = ((64, 84, 84), (1, 84, 84), (1, 640, 480), (1, 1280, 720))
"""Number of views, width and height of the measured pictures."""

_STAGES = (
    (DrawStage.CULLING, "traffic, poses, culling"),
    (DrawStage.VERTICES, "vertices"),
    (DrawStage.RASTERISING, "rasterising"),
    (DrawStage.MOVERS_LIGHT, "light of movers"),
    (DrawStage.SHADING, "shading"),
)


@dataclass(frozen=True, slots=True)
class StageTime:
    """The time that one stage of drawing a picture takes."""

    pictures: str  # Size of the pictures, and how many are drawn at once
    stage: str
    microseconds: float  # Shortest processor time, of all threads, for one picture [us]
    share: float  # Share of the time of the whole picture


def measure_stages(
    seconds: float,  # Time to measure each size [s]
) -> list[StageTime]:
    """Return the times of all stages for each of `SIZES`.

    A stage's time is the time to draw up to its end, less the time to draw up to its start, and
    not below 0. Other load makes a time longer, never shorter: so the shortest is told, and the
    measurements alternate, so that each has its quiet moments.
    """
    times = []
    for views, width, height in SIZES:
        simulation = build_simulation(SimConfig(), each_alone(views))
        simulation.reset()
        picture = Picture.create(views, height, width)
        trackers = np.arange(views, dtype=np.int32)
        calls: list[Callable[[], object]] = [
            partial(simulation.draw, trackers, picture, until=stage) for stage, _ in _STAGES
        ]
        assert picture.rgb is not None  # created above
        calls.append(picture.rgb.copy)
        *ends, copying = _shortest(calls, seconds)
        ends = np.maximum.accumulate(ends).tolist()
        spent = [*np.diff([0.0, *ends]), copying]
        name = f"{width}x{height}, {views} view{'s' * (views > 1)}"
        for (_, stage), time_ in zip((*_STAGES, (None, "copying out")), spent, strict=True):
            share = float(time_) / (ends[-1] + copying)
            times.append(StageTime(name, stage, 1e6 * float(time_) / views, share))
    return times


def _shortest(calls: list[Callable[[], object]], seconds: float) -> list[float]:
    """Return the shortest processor time of each call, of all threads [s]."""
    spent: list[list[float]] = [[] for _ in calls]
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(spent[0]) < 5:
        for call, times in zip(calls, spent, strict=True):
            start = time.process_time()
            call()
            times.append(time.process_time() - start)
    return [min(times) for times in spent]


def stage_table(times: list[StageTime]) -> Table:
    """Return the times as a table: stages down, sizes across."""
    table = Table(
        title="where the processor time of a picture goes (us, share)", title_justify="left"
    )
    table.add_column("stage")
    sizes = list(dict.fromkeys(time_.pictures for time_ in times))
    for size in sizes:
        table.add_column(size, justify="right")
    for stage in dict.fromkeys(time_.stage for time_ in times):
        found = {time_.pictures: time_ for time_ in times if time_.stage == stage}
        cells = (f"{found[s].microseconds:,.0f}  {found[s].share:4.0%}" for s in sizes)
        table.add_row(stage, *cells)
    return table


@dataclass(frozen=True, slots=True)
class PictureBatch:
    """What to draw at once."""

    views: int
    width: int
    height: int
    weather: str = "day"
    samples: Literal[1, 2, 4] = 1

    @property
    def name(self) -> str:
        """Name of the measurement."""
        name = f"pictures {self.width}x{self.height}, {self.views} view{'s' * (self.views > 1)}"
        name += f", {self.weather}" * (self.weather != "day")
        return name + f", {self.samples} samples" * (self.samples > 1)


BY_DAY = (
    PictureBatch(1, 84, 84),
    PictureBatch(64, 48, 48),
    PictureBatch(64, 84, 84),
    PictureBatch(64, 84, 84, samples=2),
    PictureBatch(64, 84, 84, samples=4),
    PictureBatch(1, 640, 480),
    PictureBatch(1, 1280, 720),
)
OTHER_WEATHERS = (
    PictureBatch(64, 84, 84, weather="night"),
    PictureBatch(64, 84, 84, weather="snow"),
)


def measure_pictures(
    pictures: PictureBatch,
    seconds: float,  # Time to measure [s]
) -> Measurement:
    """Return the measurement of drawing pictures."""
    config = SimConfig(
        camera=CameraConfig(samples=pictures.samples), world=WorldConfig(weather=pictures.weather)
    )
    simulation = build_simulation(config, each_alone(pictures.views))
    simulation.reset()
    picture = Picture.create(pictures.views, pictures.height, pictures.width)
    trackers = np.arange(pictures.views, dtype=np.int32)
    includes = "traffic of each world, posing, culling, shading with shadows, RGB"
    size = pictures.views, pictures.width, pictures.height
    return of_pictures(
        pictures.name, includes, lambda: simulation.draw(trackers, picture), size, seconds
    )


def measure_horizon(seconds: float) -> Measurement:
    """Return the measurement of views from a ring outside the city, which show all of it."""
    assets = load_assets(SimConfig().world, SimConfig().traffic, 1)
    count, pitch, field_of_view = 64, 0.3, 1.2
    points = assets.scene.network.lane_points
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    away = np.linalg.norm(points - centre, axis=1).max() / math.sin(0.5 * field_of_view)
    turn = np.arange(count) * (math.tau / count)
    out = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    level = np.stack([-out[:, 0], -out[:, 1], np.zeros(count)], axis=1)
    forward = math.cos(pitch) * level - math.sin(pitch) * np.array([0.0, 0.0, 1.0])
    left = np.cross([0.0, 0.0, 1.0], level)
    views = Views(
        position=np.column_stack([centre + away * out, np.full(count, away * math.tan(pitch))]),
        rotation=np.stack([forward, left, np.cross(forward, left)], axis=2),
        world=np.zeros(count, np.int32),
        subject=np.full(count, -1, np.int32),
        field_of_view=field_of_view,
    )
    movers = StillWorld(assets).movers(300.0)
    picture = Picture.create(count, 84, 84)
    includes = f"all of the city from {away:.0f} m, pitch {pitch}: drawing alone"
    name = "pictures 84x84, 64 views, horizon"

    def draw() -> None:
        assets.renderer.draw(views, movers, picture)

    return of_pictures(name, includes, draw, (count, 84, 84), seconds)


_VIEWS, _SIDE = 64, 84
_TURN = (12.0, 0.0, 0.0, 1.5)  # Command while it is measured: without motion nothing is blurred

_CASES: Mapping[str, Mapping[str, Any]] = {
    "pinhole": {},
    "sensor and automatic exposure": {"imager": {}},
    "the same, by Malvar's mosaic": {"imager": {"mosaic": "malvar"}},
    "barrel lens (k1 -0.1)": {"lens": {"model": "brown", "k1": -0.1}},
    "fisheye of half a sphere": {"lens": {"model": "fisheye"}, "field_of_view": 2.2},
    "vignetting and fringes": {"lens": {"vignetting": 0.4, "red": 0.004, "blue": -0.004}},
    "blur, at most 4 instants of 20 ms": {
        "shutter": {"blur": True, "exposure": 0.02, "most_samples": 4}
    },
    "rolling shutter of 20 ms": {"shutter": {"readout": 0.02}},
    "dirt and drops": {"dirt": {"drops": 8}},
    "link, JPEG of quality 40": {"link": {}},
    "defocus of 4 pixels": {"defocus": 0.05},
    "near infrared": {"spectrum": "near-infrared"},
    "thermal": {"spectrum": "thermal"},
    "small-drone": {"model": "small-drone"},
}


@dataclass(frozen=True, slots=True)
class CameraCost:
    """What a picture costs."""

    effect: str
    microseconds: float  # Median of the processor time of a picture [us]
    ratio: float  # Over that of a pinhole's, the median of measurements side by side


def measure_camera(
    seconds: float,  # Time to measure each [s]
) -> list[CameraCost]:
    """Return the cost of camera models, measured by turns with a pinhole."""
    everyone = np.arange(_VIEWS, dtype=np.int32)
    picture = Picture.create(_VIEWS, _SIDE, _SIDE)
    simulations = []
    for camera in _CASES.values():
        simulation = build_simulation(updated(SimConfig(), {"camera": camera}), each_alone(_VIEWS))
        simulation.reset()
        simulation.advance(np.tile(np.array(_TURN), (_VIEWS, 1)), 50)
        simulation.draw(everyone, picture)
        simulations.append(simulation)
    spent: list[list[float]] = [[] for _ in simulations]
    end = time.perf_counter() + seconds * len(simulations)
    while time.perf_counter() < end or len(spent[0]) < 5:
        for simulation, times in zip(simulations, spent, strict=True):
            start = time.process_time()
            simulation.draw(everyone, picture)
            times.append(time.process_time() - start)
    costs = []
    for effect, times in zip(_CASES, spent, strict=True):
        ratios = [own / plain for own, plain in zip(times, spent[0], strict=True)]
        own = 1e6 * statistics.median(times) / _VIEWS
        costs.append(CameraCost(effect, own, statistics.median(ratios)))
    return costs


def camera_table(costs: list[CameraCost]) -> Table:
    """Return the costs as a table."""
    title = f"processor time of a picture of {_SIDE}x{_SIDE}, {_VIEWS} at once, in a turn"
    table = Table(title=title, title_justify="left")
    table.add_column("camera")
    table.add_column("us", justify="right")
    table.add_column("of a pinhole's", justify="right")
    for cost in costs:
        table.add_row(cost.effect, f"{cost.microseconds:,.0f}", f"{cost.ratio:.2f}")
    return table
