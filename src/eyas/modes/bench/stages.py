"""`eyas bench --stages`: the time that each stage of drawing a picture takes."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from rich.table import Table

from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.sim.worlds import each_alone
from eyas.state.draw import DrawStage, Picture

__all__ = ["SIZES", "StageTime", "measure_stages", "stage_table"]

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

    pictures: str
    """Size of the pictures, and how many are drawn at once."""
    stage: str
    microseconds: float
    """Median for one picture [us]."""
    share: float
    """Share of the time of the whole picture."""


def measure_stages(seconds: float) -> list[StageTime]:
    """Return the times of all stages for each of `SIZES`.

    A stage's time is the time to draw up to its end, less the time to draw up to its start.
    The measurements alternate, so that other load on the machine affects all of them alike.

    Args:
        seconds: Time to measure each size [s].
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
        ends = _medians(calls, seconds)
        spent = [*np.diff([0.0, *ends[:-1]]), ends[-1]]
        name = f"{width}x{height}, {views} view{'s' * (views > 1)}"
        for (_, stage), time_ in zip((*_STAGES, (None, "copying out")), spent, strict=True):
            share = float(time_) / (ends[-2] + ends[-1])
            times.append(StageTime(name, stage, 1e6 * float(time_) / views, share))
    return times


def _medians(calls: list[Callable[[], object]], seconds: float) -> list[float]:
    """Return the median time of each call [s]."""
    spent: list[list[float]] = [[] for _ in calls]
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(spent[0]) < 5:
        for call, times in zip(calls, spent, strict=True):
            start = time.perf_counter()
            call()
            times.append(time.perf_counter() - start)
    return [statistics.median(times[1:]) for times in spent]


def stage_table(times: list[StageTime]) -> Table:
    """Return the times as a table: stages down, sizes across."""
    table = Table(title="where the time of a picture goes [us, share]", title_justify="left")
    table.add_column("stage")
    sizes = list(dict.fromkeys(time_.pictures for time_ in times))
    for size in sizes:
        table.add_column(size, justify="right")
    for stage in dict.fromkeys(time_.stage for time_ in times):
        found = {time_.pictures: time_ for time_ in times if time_.stage == stage}
        cells = (f"{found[s].microseconds:,.0f}  {found[s].share:4.0%}" for s in sizes)
        table.add_row(stage, *cells)
    return table
