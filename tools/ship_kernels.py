"""Make what ships in the package: machine code (`eyas.lanes.shipped`), PTX (`eyas.gpu.cuda.code`).

    python tools/ship_kernels.py              # some minutes; commit what it changes
    python tools/ship_kernels.py --check      # is the code in the package that of these sources?
    python tools/ship_kernels.py --out /tmp/a # elsewhere, to be compared: the same versions of
                                              # numba, llvmlite and Python make the same bytes

A kernel that was changed since is passed over and compiled, where numba is installed.
"""

import argparse
import importlib
import os
import pkgutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

import llvmlite.binding as llvm

import eyas
from eyas.engine.sim.step import step_of
from eyas.engine.trackers.drone import DRONE
from eyas.gpu.cuda import code as ptx
from eyas.lanes import CompiledCall
from eyas.lanes.identity import entry_of, language_hash
from eyas.lanes.machine_code import SUFFIX, MachineCode, read_code
from eyas.lanes.shipped import CONTENTS, LEVELS, VARIABLE, WIDE, KernelLibrary
from eyas.lanes.trusted import read_trusted

USES_ALL = """
import tempfile
import numpy as np
import eyas
from eyas.lanes.elementary.arrays import sin
from eyas.engine.camera.config import Colours
from eyas.engine.core.config import updated
from eyas.engine.core.optics.lens import BROWN, lens_of, places
from eyas.engine.sensors.stack import FrameStack
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.still import StillWorld
from eyas.engine.sim.urban_wind import winds_over
from eyas.engine.sim.views.actor_bounds import bounds_of, make_rows
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.privileged import fill_privileged
from eyas.engine.traffic.recorded import smooth, table_of
from eyas.engine.traffic.recording_file import load
from eyas.engine.trackers.driven import driven_drone
from eyas.engine.world.maps import MAPS
from eyas.robotics.mavlink.config import MavlinkConfig
from eyas.robotics.mavlink.readings import equipped

TRACKERS = (
    {},
    {"supervised": False},
    {"supervised": False, "airframe": "10-inch", "battery": {"enabled": True}},
    {"kind": "car"},
)
MOUNTED_IN_MOTION = {"mount": {}, "shutter": {"readout": 0.01}}

sin(np.zeros(1))
places(lens_of(BROWN), np.ones((1, 3)))
winds_over(np.zeros((4, 4)))
picture = Picture.create(1, 84, 84)
for settings in (
    {},
    {
        "lidar": {"enabled": True},
        "sensors": {"camera": {"noise": 1.0}},
        "done": {"crash": "contact"},
        "target": "Pedestrian",
    },
    {"camera": {"shutter": {"blur": True, "readout": 0.01}, "vibration": {"angle": 0.001}}},
    {"camera": {"spectrum": "near-infrared", "link": {"slice_loss": 0.1}, "defocus": 0.05}},
    {"camera": {"spectrum": "thermal"}},
    {
        "camera": {
            "imager": {"mosaic": "malvar"},
            "lens": {"model": "brown", "k1": -0.1, "vignetting": 0.2, "red": 0.01},
            "dirt": {"drops": 2},
            "events": {"enabled": True, "shot": 1.0},
        }
    },
):
    simulation = build_simulation(SimConfig(**settings), each_alone(1))
    simulation.reset()
    simulation.advance(np.zeros((1, 4)), 1)
    simulation.carry(1)
    simulation.packets()
    for _ in range(2):
        simulation.draw(np.zeros(1, np.int32), picture)
        if (sensor := simulation.view.events(np.zeros(1, np.int32))) is not None:
            sensor.count(np.zeros(1, np.int64), np.zeros((1, 240, 320, 2), np.uint8))
        simulation.advance(np.array([[5.0, 0.0, 0.0, 1.0]]), 10)
for tracker in TRACKERS:
    for camera in ({}, {"mount": {}}, {"shutter": {"readout": 0.01}}, MOUNTED_IN_MOTION):
        simulation = build_simulation(SimConfig(tracker=tracker, camera=camera), each_alone(1))
        simulation.reset()
        simulation.advance(np.zeros((1, 4)), 1)
        simulation.advance(np.zeros((1, 8)), 1)  # turns the camera, too
        simulation.carry(1)
for names in ([], ["compass"], ["barometer"], ["compass", "barometer"], ["barometer", "compass"]):
    sensors = {"imu": {"noise": 0.1}, "further": [{"sensor": name} for name in names]}
    simulation = build_simulation(SimConfig(sensors=sensors), each_alone(1))
    simulation.reset()
    simulation.advance(np.zeros((1, 4)), 1)
driven = EyasConfig(tracker={"supervised": False, "ground_contact": True})
driven = updated(driven, {"start": {"velocity": "rest"}})
driven = equipped(driven, MavlinkConfig.of(driven), noisy=True)
simulation = build_simulation(driven, together(1), tracker=driven_drone(driven.tracker))
simulation.reset()
simulation.advance(np.zeros((1, 4)), 1)  # as an autopilot does
fill_privileged(simulation.snapshot, np.zeros((1, 16), np.float32))
traffic = load_assets(SimConfig().world, SimConfig().traffic).traffic
make_rows(bounds_of(traffic.motion, np.arange(4)), traffic.motion)
FrameStack(1, (84, 84), Colours.GREY).add(picture.rgb, np.zeros(1, np.int64))
StillWorld(load_assets(SimConfig().world, SimConfig().traffic)).actors(0.0)
recording = load(MAPS.get("citystreet").shipped_traffic()[0])
hill = Terrain(0.0, np.ones((2, 2), np.float32), 0.0, 0.0, 1.0)
table_of(smooth(recording), hill)
with tempfile.TemporaryDirectory() as folder:
    video = {"channels": 1, "total_time": 0.1, "flight": "orbit"}
    video["writers"] = ["png", "labels", "masks", "flow", "normals"]
    lens = {"model": "brown", "k1": -0.1}
    eyas.record({"camera": {"width": 32, "height": 24, "lens": lens}, "video": video}, folder)
    eyas.load(folder)[0][0].masks()
"""
"""A program that uses every kernel of the package; `missing` names those that it forgets."""


LEVEL, OTHER_LEVEL = LEVELS["x86_64"], LEVELS["aarch64"]

ARM_TOOLS = "aarch64-linux-gnu-"  # Prefix of GNU's binary tools for AArch64

MEMORY = {"memcpy", "memmove", "memset"}
"""What LLVM itself calls to copy and to clear memory; there is only one result."""

DRAWING = "draw_views"
"""The function whose code also ships for AVX-512."""


MAKES_ALL = (
    """
import os
import re
from pathlib import Path
import llvmlite.binding as llvm
from eyas.lanes import compilation, machine_code

def target(triple, cpu):
    options = {"opt": 3, "reloc": "pic", "codemodel": "small"}
    return llvm.Target.from_triple(triple).create_target_machine(cpu, **options)


def made_for_all(module, entry):
    text = re.sub('"target-(cpu|features)"="[^"]*"', "", str(module))
    for level, machine in MACHINES.items():
        if level == WIDE and not entry.startswith(DRAWING):
            continue
        other = re.sub('target triple = ".*"', f'target triple = "{machine.triple}"', text)
        layout = f'target datalayout = "{machine.target_data}"'
        other = llvm.parse_assembly(re.sub('target datalayout = ".*"', layout, other))
        machine_code._machine = lambda: machine
        code = native(other, entry)
        machine_code._machine = native_machine
        folder = Path(os.environ["EYAS_CACHE_DIR"], level)
        folder.mkdir(exist_ok=True)
        machine_code.write_code(folder / f"{entry}{machine_code.SUFFIX}", code)
    return native(module, entry)


llvm.initialize_all_targets()
llvm.initialize_all_asmprinters()
native, native_machine = compilation.optimised, machine_code._machine
compilation.optimised = made_for_all
"""
    f"OTHER, WIDE, DRAWING = {OTHER_LEVEL.name!r}, {WIDE.name!r}, {DRAWING!r}"
    """
MACHINES = {
    OTHER: target("aarch64-unknown-linux-gnu", ""),
    WIDE: target(llvm.get_process_triple(), WIDE),
}
""" + USES_ALL
)
"""A program that uses every kernel, and makes each for other levels, too."""


USES_DEVICE = """
from pathlib import Path
import numpy as np
import torch
from eyas import EyasVectorEnv
from eyas.gpu.cuda import code
from eyas.lanes.device import HostDevice
from eyas.lanes.bundles import PackedBundle

code.ARCHIVE = Path("none")  # what is in the package already is made anew


class Recorder:
    # Makes PTX of kernels as for a card, where all arrays are alike, and runs none.
    def __init__(self):
        self._host = HostDevice()

    def __getattr__(self, name):
        return getattr(self._host, name)

    def launch(self, call, workers, *bundles, threads=1, block=None):
        types = tuple(small(bundle.bundle) for bundle in bundles)
        kinds = tuple(PackedBundle(bundle).kind for bundle in types)
        code.ptx_code(call, types, kinds, threads)


def small(value):
    if isinstance(value, np.ndarray):
        return np.zeros((1,) * value.ndim, value.dtype)
    if not isinstance(value, tuple):
        return value
    parts = [small(part) for part in value]
    return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)


for settings in ({}, {"tracker": {"supervised": False}}, {"tracker": {"kind": "car"}}):
    envs = EyasVectorEnv(2, settings, device=Recorder())
    envs.reset(seed=1)
    envs.step(torch.from_numpy(np.zeros(envs.action_space.shape, envs.action_space.dtype)))
envs = EyasVectorEnv(2, device=Recorder(), measures=True, observation={"layout": "chw"})
envs.reset(seed=1)
"""
"""A program that uses the kernels of environments on a graphics processor, with usual settings."""


FOR_DEVICES = ("eyas.gpu.render.stages", "eyas.gpu.sim.", "eyas.gpu.envs.")
"""Rooms of kernels that run on graphics processors; they ship as PTX."""


def main() -> None:
    """Make the code, or check it."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="change nothing; fail if out of date")
    parser.add_argument("--out", type=Path, help="folder to write into")
    options = parser.parse_args()
    if options.check:
        ships = KernelLibrary.opened(LEVEL.library).names
        raise SystemExit(missing(ships) or not_wide(ships) or compiled())

    def place(archive: Path) -> Path:
        """Return where a file is written: where it ships, or in the folder that is named."""
        if options.out is None:
            return archive
        options.out.mkdir(parents=True, exist_ok=True)
        return options.out / archive.name

    with tempfile.TemporaryDirectory() as cache:
        variables = {"NUMBA_CPU_NAME": LEVEL.name, "NUMBA_CPU_FEATURES": "", VARIABLE: "0"}
        use_all(cache, variables, MAKES_ALL)
        folder = Path(cache, "kernels", language_hash())
        codes = codes_in(folder.glob(f"*{SUFFIX}"))
        link(codes, place(LEVEL.library))
        link(codes_of(codes, Path(cache, OTHER_LEVEL.name)), place(OTHER_LEVEL.library), ARM_TOOLS)
        drawing = filter(draws, codes)
        link(codes_of(drawing, Path(cache, WIDE.name)), place(WIDE.library))
    with tempfile.TemporaryDirectory() as cache:
        use_all(cache, {}, USES_DEVICE)
        place(ptx.ARCHIVE).write_bytes(ptx.archive_of(ptx_in(Path(cache))))
    raise SystemExit(missing(codes))


def compiled() -> str | None:
    """Return which kernels are not shipped for this machine as they are now; None if all are."""
    with tempfile.TemporaryDirectory() as cache:
        use_all(cache, {})
        found = sorted(file.stem for file in Path(cache).rglob(f"*{SUFFIX}"))
    return f"not shipped as they are now: {', '.join(found)}" if found else None


def use_all(cache: str, variables: dict[str, str], program: str = USES_ALL) -> None:
    """Use every kernel in a process with an empty cache."""
    # numba walks through sets of names, whose order would differ from one process to the next.
    environment = {**os.environ, "EYAS_CACHE_DIR": cache, "PYTHONHASHSEED": "0", **variables}
    environment.pop("NUMBA_CACHE_DIR", None)
    subprocess.run([sys.executable, "-c", program], env=environment, check=True)


def codes_in(files: Iterable[Path]) -> dict[str, MachineCode]:
    """Return the machine code in some files, by the names by which it is found."""
    codes = {file.stem.rpartition("-")[0]: read_code(file) for file in files}
    return {name: code for name, code in codes.items() if code is not None}


def link(codes: Mapping[str, MachineCode], library: Path, tools: str = "") -> None:
    """Link machine code, by the names by which it is found, into a shared library.

    Args:
        codes: The machine code.
        library: The library, written completely or not at all.
        tools: Prefix of the names of GNU's binary tools for these processors.
    """
    with tempfile.TemporaryDirectory() as folder:
        objects = {entry_of(name): bytes(code.code) for name, code in sorted(codes.items())}
        objects[CONTENTS] = contents_object([language_hash(), *sorted(codes)], tools)
        for name, code in objects.items():
            Path(folder, f"{name}.o").write_bytes(code)
        entries = "".join(f"{name};" for name in objects)
        Path(folder, "exports").write_text(f"{{global: {entries} local: *;}};")
        command = [
            *(f"{tools}ld", "-shared", "--gc-sections", "--strip-all", "--build-id=none"),
            *("--version-script=exports", "-o", "made"),
            *(f"{name}.o" for name in objects),
        ]
        subprocess.run(command, cwd=folder, check=True)
        listed = [f"{tools}nm", "--dynamic", "--undefined-only", "--format=posix", "made"]
        lines = subprocess.run(listed, cwd=folder, check=True, capture_output=True, text=True)
        outside = {line.split()[0] for line in lines.stdout.splitlines()} - MEMORY
        if outside:
            raise SystemExit(f"{library}: calls {', '.join(sorted(outside))} outside")
        library.write_bytes(Path(folder, "made").read_bytes())


def contents_object(lines: list[str], tools: str) -> bytes:
    """Return an object file of the text by which a library tells its kernels."""
    text = "\n".join(lines).encode() + b"\0"
    source = f'@{CONTENTS} = constant [{len(text)} x i8] c"{llvm_text(text)}"'
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple(tools.rstrip("-") or llvm.get_process_triple())
    return target.create_target_machine(reloc="pic").emit_object(llvm.parse_assembly(source))


def llvm_text(text: bytes) -> str:
    """Return a text as LLVM's assembly has it between quotes."""
    return "".join(f"\\{byte:02x}" for byte in text)


def codes_of(names: Iterable[str], folder: Path) -> dict[str, MachineCode]:
    """Return the machine code of some kernels for another level, from its folder."""
    codes = {name: read_code(folder / f"{entry_of(name)}{SUFFIX}") for name in names}
    missing_codes = sorted(name for name, code in codes.items() if code is None)
    assert not missing_codes, missing_codes
    return {name: code for name, code in codes.items() if code is not None}


def ptx_in(cache: Path) -> dict[str, ptx.Ptx]:
    """Return the PTX in a cache, by the names by which it is found."""
    files = cache.rglob(f"*{ptx.SUFFIX}")
    found = {file.stem.rpartition("-")[0]: read_trusted(file) for file in files}
    return {
        name: ptx.Ptx(one.header, bytes(one.pieces[0]))
        for name, one in found.items()
        if one is not None
    }


def missing(names: Iterable[str]) -> str | None:
    """Return which kernels of the package are not among those of a library; None if all are."""
    ships = {name.partition("-")[0] for name in names}
    lacks = sorted(kernels() - ships)
    return f"not in {LEVEL.library}: {', '.join(lacks)}" if lacks else None


def not_wide(names: Iterable[str]) -> str | None:
    """Return what draws and does not ship for AVX-512; None if all does."""
    lacks = set(filter(draws, names)) - KernelLibrary.opened(WIDE.library).names
    return f"not in {WIDE.library}: {', '.join(sorted(lacks))}" if lacks else None


def draws(name: str) -> bool:
    """Return whether machine code with that name draws."""
    return name.startswith(f"{DRAWING}-")


def kernels() -> set[str]:
    """Return the names of all compiled functions of the package."""
    names = [module.name for module in pkgutil.walk_packages(eyas.__path__, "eyas.")]
    found = [vars(importlib.import_module(name)).values() for name in names]
    kept = [value for values in (*found, step_of(DRONE)) for value in values]
    functions = [kernel.function for kernel in kept if isinstance(kernel, CompiledCall)]
    ours = [one for one in functions if not one.__module__.startswith(FOR_DEVICES)]
    return {one.__qualname__.rpartition(".")[2] for one in ours}


if __name__ == "__main__":
    main()
