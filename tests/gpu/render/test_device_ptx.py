"""The stages of a picture, and the step, compile for graphics processors: to PTX, for which no such
processor is needed. It computes what the processor does: nothing is fused, nothing is outside.
"""

import lzma
import os
import re
import shutil
import subprocess

import numpy as np
import pytest

import eyas.gpu.render.stages as stages
from eyas.engine.camera.config import CameraConfig, MountConfig
from eyas.engine.sensors.mount import CARRIED, mount_of
from eyas.engine.sim.step import Orders, StepState, StepSurroundings, step_of
from eyas.engine.state.draw import Picture
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.config import DoneConfig, RewardConfig
from eyas.engine.task.rules import make_rules
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.drone import DRONE
from eyas.engine.trackers.kinds import tracker_of
from eyas.gpu.cuda import code
from eyas.gpu.ptx import ptx_of
from eyas.gpu.render.read_back import ReadBackRenderer
from eyas.lanes import ParallelCall
from eyas.lanes.container import unpacked
from eyas.lanes.device import HostDevice

from ...kit.on_devices import EVERYTHING
from ...kit.small_city import car_parts, city_scene, city_traffic, looking

QUICK = ("look_for_clusters", "fill_triangles")
STAGES = [name for name in stages.__all__ if isinstance(getattr(stages, name), ParallelCall)]


def checked(text, entry="kernel") -> str:
    """Return PTX that is whole and that computes the bytes of the processor."""
    assert re.findall(r"\.entry (\w+)", text) == [entry]
    assert "fma" not in text
    assert "vprintf" not in text
    assert not re.search(r"\.extern \.func", text)
    assert not re.search(r"\b(mad|mul|add|sub)\.(f32|f64)\b", text)  # `mul.rn`: never fused later
    assert not re.search(r"\b(sqrt|div)\.(approx|full)", text)
    return text


def assembled(text, folder) -> str:
    """Return what NVIDIA's assembler reports; nothing where there is none."""
    ptxas = shutil.which("ptxas")
    if ptxas is None:
        return ""
    source = folder / "kernel.ptx"
    source.write_text(text)
    command = [ptxas, "-v", "-arch=sm_90", "-o", os.devnull, str(source)]
    ran = subprocess.run(command, capture_output=True, text=True)
    if known := re.search(r"current version is '([\d.]+)'", ran.stderr):  # older than LLVM's
        source.write_text(re.sub(r"\.version [\d.]+", f".version {known[1]}", source.read_text()))
        ran = subprocess.run(command, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr + ran.stdout
    return ran.stderr + ran.stdout


class Launches(HostDevice):
    """Keeps what is launched, and does it."""

    def __init__(self):
        super().__init__()
        self.kept = {}

    def launch(self, call, workers, *bundles, threads=1, block=128):
        self.kept[call] = tuple(bundle.bundle for bundle in bundles), threads
        super().launch(call, workers, *bundles, threads=threads, block=block)


@pytest.fixture(scope="module")
def launches(renderer_of):
    device = Launches()
    renderer = ReadBackRenderer(device, renderer_of(city_scene(), car_parts()))
    picture = Picture.create(1, 24, 32, **EVERYTHING)
    renderer.draw(looking([(0.0, 0.0, 20.0)]), city_traffic(1), picture)
    return device.kept


def test_every_stage_is_launched(launches):
    assert {getattr(stages, name) for name in STAGES} == launches.keys()


def test_what_ships_computes_the_bytes_of_the_processor():
    (_, table), pieces = unpacked(lzma.decompress(code.ARCHIVE.read_bytes()))
    assert len(table) > len(STAGES)
    for (_, entry), text in zip(table, pieces, strict=True):
        checked(bytes(text).decode(), entry)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    # Others compile for 20 s to a minute; their PTX ships, so it has been made.
    [n if n in QUICK else pytest.param(n, marks=pytest.mark.thorough) for n in STAGES],
)
def test_a_stage_compiles_for_cuda(launches, name, tmp_path, capsys):
    call = getattr(stages, name)
    bundles, threads = launches[call]
    report = assembled(checked(ptx_of(call, bundles, "kernel", threads=threads)), tmp_path)
    if report:
        registers = int(re.search(r"Used (\d+) registers", report)[1])
        spilled = sum(map(int, re.findall(r"(\d+) bytes spill", report)))
        with capsys.disabled():
            print(f"\n{name}: {registers} registers, {spilled} bytes spilled")
        assert registers <= 128


FLOWN, CAR, EQUIPPED = (
    tracker_of(TrackerConfig(**values))
    for values in (
        {"supervised": False},
        {"kind": "car"},
        {"supervised": False, "battery": {"enabled": True}},
    )
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tracker", "mounted", "kernel"),
    [  # what is flown with equipment calls all that is flown without
        (DRONE, False, "carry"),
        (DRONE, True, "begin"),
        (CAR, False, "fly"),
        (EQUIPPED, False, "fly"),
        pytest.param(DRONE, False, "fly", marks=pytest.mark.thorough),
        pytest.param(FLOWN, False, "begin", marks=pytest.mark.thorough),
        pytest.param(FLOWN, True, "fly", marks=pytest.mark.thorough),
    ],
)
def test_the_step_compiles_for_cuda(tracker, mounted, kernel):
    motion = SampledMotion(np.zeros((2, 1), SAMPLE), np.zeros(1, np.int32), 10.0).packed()
    around = StepSurroundings(motion, Terrain.flat(0.0))
    rules = make_rules(RewardConfig(), DoneConfig(), CameraConfig())
    memory, mount = tracker.memory(2, Terrain.flat(0.0)), mount_of(MountConfig())
    state = StepState(Snapshot.create(2), memory, around, rules, 0.02, mount, 1)
    step = getattr(step_of(tracker, CARRIED[mounted]), kernel)
    checked(ptx_of(step, (state, Orders.create(2)), "kernel"))
