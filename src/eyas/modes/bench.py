"""`eyas bench`: how fast this machine runs Eyas, as medians, each with what it includes."""

import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from eyas.core.files import write_atomic
from eyas.core.machine import describe_machine, peak_memory
from eyas.modes.bench_first_picture import FIRST_PICTURE
from eyas.modes.bench_stages import measure_stages, stage_table
from eyas.sim.build import build_simulation
from eyas.sim.config import EyasConfig
from eyas.state.draw import Picture

__all__ = ["Measurement", "run"]

_PHYSICS_STEPS = 4


@dataclass(frozen=True, slots=True)
class Measurement:
    """One line of the table."""

    name: str
    value: float
    """Median."""
    unit: str
    includes: str
    """What the figure covers."""
    repeats: int
    """How many timings the median is of."""


def run(
    json_path: Path | None = None, *, quick: bool = False, cold: bool = False, stages: bool = False
) -> None:
    """Measure, print a table and write the figures.

    Args:
        json_path: Where to write machine and figures as JSON, or None.
        quick: A tenth of the time, for a first look.
        cold: Also time the first picture with nothing compiled yet.
        stages: Also time the stages of a picture.
    """
    seconds = 0.3 if quick else 3.0
    console = Console()
    results: list[Measurement] = []
    with console.status("measuring") as status:
        for measurement in _measurements(seconds, cold=cold):
            results.append(measurement)
            status.update(f"measured: {measurement.name}")
        spent = measure_stages(seconds) if stages else []
    machine = describe_machine()
    console.print(_table(results, machine))
    if stages:
        console.print(stage_table(spent))
    if json_path is not None:
        document: dict[str, object] = {"machine": machine}
        document["results"] = [asdict(result) for result in results]
        document["stages"] = [asdict(time_) for time_ in spent]
        write_atomic(json_path, json.dumps(document, indent=2).encode())


def _measurements(seconds: float, *, cold: bool) -> Iterator[Measurement]:
    yield _first_picture("first picture, kernels cached", None)
    if cold:
        with tempfile.TemporaryDirectory() as folder:
            yield _first_picture("first picture, nothing compiled", folder)
    for views, width, height in ((1, 84, 84), (64, 84, 84), (1, 640, 480), (1, 1280, 720)):
        yield _pictures(views, width, height, seconds)
    for count in (1, 64):
        yield _steps(count, seconds, camera=False)
        yield _steps(count, seconds, camera=True)
    yield _reset(seconds)
    yield Measurement("peak memory", peak_memory() / 2**20, "MiB", "this whole benchmark", 1)


def _pictures(views: int, width: int, height: int, seconds: float) -> Measurement:
    simulation = build_simulation(EyasConfig(), views, shared_world=False)
    simulation.reset()
    picture = Picture.create(views, height, width)
    trackers = np.arange(views, dtype=np.int32)
    rate, repeats = _median_rate(lambda: simulation.draw(trackers, picture), seconds)
    includes = "traffic of each world, posing, culling, shading with shadows, RGB"
    name = f"pictures {width}x{height}, {views} view{'s' * (views > 1)}"
    return Measurement(name, rate * views, "/s", includes, repeats)


def _steps(count: int, seconds: float, *, camera: bool) -> Measurement:
    simulation = build_simulation(EyasConfig(), count, shared_world=False)
    simulation.reset()
    picture = Picture.create(count, 84, 84)
    trackers = np.arange(count, dtype=np.int32)
    commands = np.zeros((count, 4))

    def step() -> None:
        simulation.advance(commands, _PHYSICS_STEPS)
        if camera:
            simulation.draw(trackers, picture)
        simulation.packets()
        if simulation.done.any():
            simulation.reset(simulation.done)

    rate, repeats = _median_rate(step, seconds)
    drawn = "84x84 pictures" if camera else "no camera"
    includes = f"{_PHYSICS_STEPS} physics steps, traffic, reward, packets, resets, {drawn}"
    name = f"steps, {count} tracker{'s' * (count > 1)}, {drawn}"
    return Measurement(name, rate * count, "steps/s", includes, repeats)


def _reset(seconds: float) -> Measurement:
    simulation = build_simulation(EyasConfig(), 1, shared_world=False)
    rate, repeats = _median_rate(simulation.reset, seconds)
    return Measurement(
        "reset of one tracker", 1e3 / rate, "ms", "target, start pose, looks", repeats
    )


def _first_picture(name: str, cache: str | None) -> Measurement:
    """Time a fresh process from its start to its first picture."""
    repeats = 1 if cache else 3
    times = []
    for _ in range(repeats + (cache is None)):  # once more at first, to fill the cache
        start = time.perf_counter()
        command = [sys.executable, "-c", FIRST_PICTURE, cache or ""]
        subprocess.run(command, check=True, capture_output=True)
        times.append(time.perf_counter() - start)
    includes = "a new process: imports, map, textures, shadows from the cache, one 84x84 picture"
    if cache:
        includes = "the same with empty caches: compiling, baking shadows"
    return Measurement(name, statistics.median(times[-repeats:]), "s", includes, repeats)


def _median_rate(call: Callable[[], None], seconds: float) -> tuple[float, int]:
    """Return calls in a second, as the median over blocks of at least 50 ms, and their number."""
    call()
    call()
    rates: list[float] = []
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(rates) < 3:
        start, calls = time.perf_counter(), 0
        while (elapsed := time.perf_counter() - start) < 0.05:
            call()
            calls += 1
        rates.append(calls / elapsed)
    return statistics.median(rates), len(rates)


def _table(results: list[Measurement], machine: str) -> Table:
    table = Table(title=f"eyas bench on {machine}", title_justify="left")
    table.add_column("what")
    table.add_column("median", justify="right")
    table.add_column("unit")
    table.add_column("includes")
    for result in results:
        digits = 0 if result.value >= 100 else 3 if result.value < 10 else 1
        table.add_row(result.name, f"{result.value:,.{digits}f}", result.unit, result.includes)
    return table
