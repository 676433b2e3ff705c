"""`eyas bench`: the speed of Eyas on this machine, as medians, each with what it covers."""

import json
import math
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from rich.console import Console
from rich.table import Table

from eyas.core.files import write_atomic
from eyas.core.machine import describe_machine, peak_memory
from eyas.modes.bench.first_picture import FIRST_PICTURE
from eyas.modes.bench.stages import measure_stages, stage_table
from eyas.sensors.config import CameraConfig
from eyas.sim.assets import load_assets
from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.sim.still import StillWorld
from eyas.sim.worlds import each_alone
from eyas.state.draw import Picture, Views

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
    """Number of timings of which it is the median."""


def run(
    json_path: Path | None = None, *, quick: bool = False, cold: bool = False, stages: bool = False
) -> None:
    """Measure, print a table and write the figures.

    Args:
        json_path: File for the machine and the figures as JSON, or None.
        quick: Whether to measure for a tenth of the time.
        cold: Whether to time the first picture with an empty cache too.
        stages: Whether to time the stages of a picture too.
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
    yield _pictures(64, 84, 84, seconds, samples=4)
    yield _horizon(seconds)
    for count in (1, 64):
        yield _steps(count, seconds, camera=False)
        yield _steps(count, seconds, camera=True)
    yield _reset(seconds)
    yield Measurement("peak memory", peak_memory() / 2**20, "MiB", "this whole benchmark", 1)
    yield _textures()


def _pictures(
    views: int, width: int, height: int, seconds: float, samples: Literal[1, 4] = 1
) -> Measurement:
    config = SimConfig(camera=CameraConfig(samples=samples))
    simulation = build_simulation(config, each_alone(views))
    simulation.reset()
    picture = Picture.create(views, height, width)
    trackers = np.arange(views, dtype=np.int32)
    rate, repeats = _median_rate(lambda: simulation.draw(trackers, picture), seconds)
    includes = "traffic of each world, posing, culling, shading with shadows, RGB"
    name = f"pictures {width}x{height}, {views} view{'s' * (views > 1)}"
    name += f", {samples} samples" * (samples > 1)
    return Measurement(name, rate * views, "/s", includes, repeats)


def _horizon(seconds: float) -> Measurement:
    """Time views from a ring outside the city, each of which shows all of it."""
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
    rate, repeats = _median_rate(lambda: assets.renderer.draw(views, movers, picture), seconds)
    includes = f"all of the city from {away:.0f} m, pitch {pitch}: drawing alone"
    return Measurement("pictures 84x84, 64 views, horizon", rate * count, "/s", includes, repeats)


def _steps(count: int, seconds: float, *, camera: bool) -> Measurement:
    simulation = build_simulation(SimConfig(), each_alone(count))
    simulation.reset()
    picture = Picture.create(count, 84, 84)
    trackers = np.arange(count, dtype=np.int32)
    commands = np.zeros((count, 4))

    def step() -> None:
        done = simulation.advance(commands, _PHYSICS_STEPS).done
        if camera:
            simulation.draw(trackers, picture)
        simulation.packets()
        if done.any():
            simulation.reset(done)

    rate, repeats = _median_rate(step, seconds)
    drawn = "84x84 pictures" if camera else "no camera"
    includes = f"{_PHYSICS_STEPS} physics steps, traffic, reward, packets, resets, {drawn}"
    name = f"steps, {count} tracker{'s' * (count > 1)}, {drawn}"
    return Measurement(name, rate * count, "steps/s", includes, repeats)


def _reset(seconds: float) -> Measurement:
    simulation = build_simulation(SimConfig(), each_alone(1))
    rate, repeats = _median_rate(simulation.reset, seconds)
    return Measurement(
        "reset of one tracker", 1e3 / rate, "ms", "target, start pose, looks", repeats
    )


def _textures() -> Measurement:
    texels = load_assets(SimConfig().world, SimConfig().traffic, 1).renderer.textures
    includes = f"{len(texels)} textures with their mip levels, of the peak memory"
    return Measurement("textures", texels.nbytes / 2**20, "MiB", includes, 1)


def _first_picture(name: str, cache: str | None) -> Measurement:
    """Time a fresh process from its start to its first picture."""
    repeats = 1 if cache else 3
    times = []
    for _ in range(repeats + (cache is None)):  # one more at the start, to fill the cache
        start = time.perf_counter()
        command = [sys.executable, "-c", FIRST_PICTURE, cache or ""]
        subprocess.run(command, check=True, capture_output=True)
        times.append(time.perf_counter() - start)
    includes = "a new process: imports, map, textures, shadows from the cache, one 84x84 picture"
    if cache:
        includes = "the same with empty caches: compiling, baking shadows"
    return Measurement(name, statistics.median(times[-repeats:]), "s", includes, repeats)


def _median_rate(call: Callable[[], None], seconds: float) -> tuple[float, int]:
    """Return calls per second, the median over blocks of at least 50 ms, and their number."""
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
    table.add_column("measurement")
    table.add_column("median", justify="right")
    table.add_column("unit")
    table.add_column("includes")
    for result in results:
        digits = 0 if result.value >= 100 else 3 if result.value < 10 else 1
        table.add_row(result.name, f"{result.value:,.{digits}f}", result.unit, result.includes)
    return table
