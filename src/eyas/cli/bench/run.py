"""`eyas bench`: the speed of Eyas on this machine, as medians, each with what it covers."""

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from rich.console import Console

from eyas.cli.bench.device import measure_device
from eyas.cli.bench.measurement import Measurement, measurement_table, timed, why_not
from eyas.cli.bench.pictures import (
    BY_DAY,
    OTHER_WEATHERS,
    camera_table,
    measure_camera,
    measure_horizon,
    measure_pictures,
    measure_stages,
    stage_table,
)
from eyas.engine.core.files import write_atomic
from eyas.engine.core.identity.build import this_build
from eyas.engine.core.installed import installed_version
from eyas.engine.core.machine import describe_machine, peak_memory
from eyas.engine.core.scratch import scratch
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.scenes import load_geometry
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.targets.catalogue import kind_index
from eyas.engine.world.weather import Season
from eyas.gpu.envs.devices import device_of

FIRST_PICTURE = """
import os, sys
if sys.argv[1]:  # an empty folder for the cache, compiled kernels too
    os.environ["EYAS_CACHE_DIR"] = sys.argv[1]
    os.environ.pop("NUMBA_CACHE_DIR", None)
import numpy as np
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
simulation = build_simulation(SimConfig(), each_alone(1))
simulation.reset()
simulation.draw(np.zeros(1, np.int32), Picture.create(1, 84, 84))
"""


_PHYSICS_STEPS = 4


def run(
    json_path: Path | None = None,
    *,
    quick: bool = False,
    cold: bool = False,
    stages: bool = False,
    camera: bool = False,
    device: str | None = None,
) -> None:
    """Measure, print a table and write the figures.

    Args:
        device: Whose pictures to measure, and nothing else, see `device_of`; None: all of this
            processor.

    Raises:
        ConfigError: There is no such device, or it cannot be used.
    """
    seconds = 0.3 if quick else 3.0
    card = None if device is None else device_of(device)
    console = Console()
    results: list[Measurement] = []
    with console.status("measuring") as status:
        measurements = (
            _measurements(seconds, cold=cold) if card is None else measure_device(card, seconds)
        )
        for measurement in measurements:
            results.append(measurement)
            status.update(f"measured: {measurement.name}")
        spent = measure_stages(seconds) if stages else []
        costs = measure_camera(seconds) if camera else []
    machine = describe_machine()
    if card is not None:
        machine = f"{card.name}, {machine}"
    console.print(measurement_table(results, machine))
    missing = why_not()
    if missing is not None and card is None:
        console.print(f"no instructions and cycles: no access to hardware counters ({missing})")
    if stages:
        console.print(stage_table(spent))
    if camera:
        console.print(camera_table(costs))
    if json_path is not None:
        document: dict[str, object] = {"machine": machine}
        document["eyas"] = f"{installed_version()} (build {this_build().id})"
        document["results"] = [asdict(result) for result in results]
        document["stages"] = [asdict(time_) for time_ in spent]
        document["camera"] = [asdict(cost) for cost in costs]
        write_atomic(json_path, json.dumps(document, indent=2).encode())


def _measurements(seconds: float, *, cold: bool) -> Iterator[Measurement]:
    with scratch() as bytecode:
        yield _first_picture("first picture, kernels cached", None, str(bytecode))
    if cold:
        with scratch() as folder:
            yield _first_picture("first picture, nothing compiled", str(folder), "")
    for pictures in BY_DAY:
        yield measure_pictures(pictures, seconds)
    yield measure_horizon(seconds)
    for count in (1, 64):
        yield _steps(count, seconds, camera=False)
        yield _steps(count, seconds, camera=True)
    yield _reset(seconds)
    yield Measurement("peak memory", peak_memory() / 2**20, "MiB", "all of the above", 1)
    yield _textures()
    for pictures in OTHER_WEATHERS:
        yield measure_pictures(pictures, seconds)
    if find_spec("torch") is not None:
        from eyas.cli.bench.learning import measure_learning  # PyTorch

        yield measure_learning(max(round(3.0 * seconds), 2))


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

    timing = timed(step, seconds)
    drawn = "84x84 pictures" if camera else "no camera"
    includes = f"{_PHYSICS_STEPS} physics steps, traffic, reward, packets, resets, {drawn}"
    name = f"steps, {count} tracker{'s' * (count > 1)}, {drawn}"
    cpu = 1e6 * timing.cpu / count
    return Measurement(name, timing.rate * count, "steps/s", includes, timing.repeats, cpu)


def _reset(seconds: float) -> Measurement:
    simulation = build_simulation(SimConfig(), each_alone(1))
    timing = timed(simulation.reset, seconds)
    rate, cpu, name = timing.rate, 1e6 * timing.cpu, "reset of one tracker"
    includes = "target, start pose, looks"
    return Measurement(name, 1e3 / rate, "ms", includes, timing.repeats, cpu)


def _textures() -> Measurement:
    world, kind = SimConfig().world, kind_index("passenger")
    texels = load_geometry(world.map, world.seed, Season.SUMMER, (kind,)).texture
    includes = f"{len(texels)} textures with their mip levels, of the peak memory"
    return Measurement("textures", texels.nbytes / 2**20, "MiB", includes, 1)


def _first_picture(name: str, cache: str | None, bytecode: str) -> Measurement:
    """Time a fresh process from its start to its first picture; None: with the user's cache."""
    repeats = 1 if cache else 3
    times, spent = [], []
    environment = dict(os.environ)
    if cache is None:  # bytecode is kept, as that of an installed package is
        environment["PYTHONPYCACHEPREFIX"] = bytecode
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
    for _ in range(repeats + (cache is None)):  # one more at the start, to fill the cache
        start, before = time.perf_counter(), os.times()
        command = [sys.executable, "-c", FIRST_PICTURE, cache or ""]
        subprocess.run(command, env=environment, check=True, capture_output=True)
        after = os.times()
        times.append(time.perf_counter() - start)
        spent.append(sum(after[2:4]) - sum(before[2:4]))
    includes = "a new process: imports, map, textures, shadows from the cache, one 84x84 picture"
    if cache:
        includes = "the same with empty caches: compiling, baking shadows"
    cpu = 1e6 * statistics.median(spent[-repeats:])
    return Measurement(name, statistics.median(times[-repeats:]), "s", includes, repeats, cpu)
