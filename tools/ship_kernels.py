"""Make the machine code that ships in the package, for each level of `eyas.lanes.shipped.LEVELS`.

    python tools/ship_kernels.py          # some minutes; commit what it changes
    python tools/ship_kernels.py --check  # is the code in the package that of these sources?

Each file belongs to exactly one kernel: after a change of what it computes Eyas passes it over, and
compiles. So they are made before a release, not with each change.
"""

import argparse
import importlib
import os
import pkgutil
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import eyas
from eyas.lanes import parallel_kernel
from eyas.lanes.identity import language_files, language_hash
from eyas.lanes.machine_code import SUFFIX
from eyas.lanes.shipped import LEVELS, SHIPPED, features
from eyas.lanes.syntax import INDEX, index_of
from eyas.sim.step import step_of
from eyas.trackers.drone import DRONE

USES_ALL = """
import numpy as np
from eyas.lanes.elementary.arrays import sin
from eyas.sensors.config import Colours
from eyas.sensors.stack import FrameStack
from eyas.sim.assets import load_assets
from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.sim.still import StillWorld
from eyas.sim.worlds import each_alone
from eyas.state.draw import Picture
from eyas.state.terrain import Terrain
from eyas.traffic.recorded import recorded_motion
from eyas.traffic.recording_file import load
from eyas.world.maps import MAPS

sin(np.zeros(1))
picture = Picture.create(1, 84, 84)
for settings in (
    {},
    {"tracker": {"supervised": False}},
    {"tracker": {"kind": "car"}},
    {
        "lidar": {"enabled": True},
        "sensors": {"imu": {"noise": 0.1}, "camera": {"noise": 1.0}},
        "done": {"crash": "contact"},
        "target": "Pedestrian",
    },
):
    simulation = build_simulation(SimConfig(**settings), each_alone(1))
    simulation.reset()
    simulation.advance(np.zeros((1, 4)), 1)
    simulation.carry(1)
    simulation.packets()
    simulation.draw(np.zeros(1, np.int32), picture)
FrameStack(1, (84, 84), Colours.GREY).add(picture.rgb, np.zeros(1, np.int64))
StillWorld(load_assets(SimConfig().world, SimConfig().traffic)).actors(0.0)
recording = load(MAPS.get("citystreet").shipped_traffic()[0])
hill = Terrain(0.0, np.ones((2, 2), np.float32), 0.0, 0.0, 1.0)
recorded_motion(recording, hill, np.zeros(recording.actors, np.int32))
"""
"""A program that uses every kernel of the package; `missing` names those that it forgets."""


def main() -> None:
    """Make the code, or check it."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="change nothing; fail if out of date")
    if parser.parse_args().check:
        raise SystemExit(missing(SHIPPED / language_hash()) or compiled())
    INDEX.write_text(index_of(files_of_kernels()))
    for level, needed in LEVELS.items():
        folder, lacks = SHIPPED / language_hash() / level, needed - features()
        shutil.rmtree(folder, ignore_errors=True)
        if lacks:  # the code is run to know which kernels there are
            print(f"{level}: left out, as this processor lacks {', '.join(sorted(lacks))}")
            continue
        print(f"compiling for {level} ...", flush=True)
        compile_for(level, folder)
    for folder in SHIPPED.iterdir():
        if folder.is_dir() and folder.name != language_hash():
            shutil.rmtree(folder)
    raise SystemExit(missing(SHIPPED / language_hash()) or compiled())


LEAST = "x86-64-v3"
"""The level whose code serves those above, too, where theirs is left out."""


def files_of_kernels() -> list[Path]:
    """Return the files of the package that may hold kernels, and those of their language."""
    every = SHIPPED.parents[1].rglob("*.py")
    return sorted({*language_files(), *(path for path in every if b"kernel" in path.read_bytes())})


def compiled() -> str | None:
    """Return which kernels are not shipped for this machine as they are now; None if all are."""
    with tempfile.TemporaryDirectory() as cache:
        use_all(cache, {})
        found = sorted(file.stem for file in Path(cache).rglob(f"*{SUFFIX}"))
    return f"not shipped as they are now: {', '.join(found)}" if found else None


def use_all(cache: str, variables: dict[str, str]) -> None:
    """Use every kernel in a process with an empty cache."""
    environment = {**os.environ, "EYAS_CACHE_DIR": cache, **variables}
    environment.pop("NUMBA_CACHE_DIR", None)
    subprocess.run([sys.executable, "-c", USES_ALL], env=environment, check=True)


def compile_for(level: str, folder: Path) -> None:
    """Compile all kernels for a level into a folder."""
    with tempfile.TemporaryDirectory() as cache:
        use_all(cache, {"NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": ""})
        folder.mkdir(parents=True)
        for file in Path(cache, "kernels", language_hash()).glob(f"*{SUFFIX}"):
            shutil.copy(file, folder / f"{file.stem.rpartition('-')[0]}{SUFFIX}")


def missing(folder: Path) -> str | None:
    """Return what is missing in the package; None if nothing is."""
    lacks = [
        f"{level}: {name}"
        for level in LEVELS
        if (folder / level).is_dir() or level == LEAST
        for name in sorted(kernels())
        if not any((folder / level).glob(f"{name}-*{SUFFIX}"))
    ]
    return f"not in {folder}: {', '.join(lacks)}" if lacks else None


def kernels() -> set[str]:
    """Return the names of all parallel kernels of the package."""
    modules = pkgutil.walk_packages(eyas.__path__, "eyas.")
    found = [vars(importlib.import_module(module.name)).values() for module in modules]
    kept = [value for values in (*found, step_of(DRONE)) for value in values]
    return {kernel.function.__name__ for kernel in kept if isinstance(kernel, parallel_kernel)}


if __name__ == "__main__":
    main()
