"""Run many steps with pictures, many resets and a long recording, and tell how memory grows.

    python bench/long_run.py [--steps 1000000] [--resets 100000] [--video 3600] [--trackers 64]

Memory is what the process holds in RAM after garbage collection; the first hundredth of the run is
left out, in which buffers reach their sizes. Run it before a release.
"""

import argparse
import gc
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from eyas.engine.core.machine import describe_machine
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.video.run import run


def resident() -> int:
    """Return the memory in RAM that only this process has [bytes].

    Mapped files do not count: their pages come into RAM as they are read, and leave when others
    need it.
    """
    gc.collect()
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("RssAnon:")) * 1024


def grown(call: Callable[[], None], repeats: int) -> tuple[float, float]:
    """Return by how much memory grows while a call is repeated [MiB], and the time [s]."""
    for _ in range(max(repeats // 100, 10)):
        call()
    before, start = resident(), time.perf_counter()
    for _ in range(repeats):
        call()
    return (resident() - before) / 2**20, time.perf_counter() - start


def recorded(length: float) -> tuple[float, float]:
    """Return by how much memory grows with a recording of a length [s] after a short one [MiB],
    and the time [s].
    """
    with tempfile.TemporaryDirectory() as folder:
        for number, part in enumerate((min(30.0, length), length)):
            settings = VideoConfig(channels=1, total_time=part)
            before, start = resident(), time.perf_counter()
            run(EyasConfig(video=settings), Path(folder) / str(number), quiet=True)
    return (resident() - before) / 2**20, time.perf_counter() - start


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--steps", type=int, default=1_000_000, help="steps of single trackers")
    parser.add_argument("--resets", type=int, default=100_000, help="resets of single trackers")
    parser.add_argument("--video", type=float, default=3600.0, help="length of a recording [s]")
    parser.add_argument("--trackers", type=int, default=64)
    given = parser.parse_args()
    count = given.trackers
    simulation = build_simulation(SimConfig(), each_alone(count))
    simulation.reset()
    picture, all_ = Picture.create(count, 84, 84), np.arange(count, dtype=np.int32)
    rng = np.random.default_rng(0)

    def step() -> None:
        done = simulation.advance(rng.uniform(-1.0, 1.0, (count, 4)), 4).done
        simulation.draw(all_, picture)
        simulation.packets()
        if done.any():
            simulation.reset(done)

    for name, call, number in (
        ("steps", step, given.steps),
        ("resets", simulation.reset, given.resets),
    ):
        mebibytes, seconds = grown(call, -(-number // count))
        print(f"{number:,} {name}: memory grew by {mebibytes:.2f} MiB in {seconds:.0f} s")
    if given.video > 0:
        mebibytes, seconds = recorded(given.video)
        print(
            f"{given.video:.0f} s of video: memory grew by {mebibytes:.2f} MiB in {seconds:.0f} s"
        )
    print(describe_machine())


if __name__ == "__main__":
    main()
