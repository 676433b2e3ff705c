"""The hot kernels compile for CUDA as they are: down to PTX, for which no GPU is needed."""

import os
import re
import shutil
import subprocess
from types import SimpleNamespace

import numba
import numpy as np
import pytest
from numba.types import CPointer, Tuple, intp

from eyas.core.cuda import prepare_cuda
from eyas.core.intrinsics import address_of
from eyas.core.jit import kernel
from eyas.core.lanes import greater
from eyas.render.jobs import Size, new_task, set_views
from eyas.render.kernels.bundles import Movers
from eyas.render.kernels.light.view_light import view_light
from eyas.render.kernels.scalars import u4
from eyas.render.kernels.surface.pixel import shade_pixel
from eyas.render.kernels.visibility.transform import view_of
from eyas.sensors.config import CameraConfig, MountConfig
from eyas.sensors.mount import CARRIED, mount_of
from eyas.sim.step import Orders, StepState, Surroundings, step_of
from eyas.state.draw import DrawStage
from eyas.state.motion import SAMPLE, Motion
from eyas.state.snapshot import Snapshot
from eyas.state.terrain import Terrain
from eyas.task.config import DoneConfig, RewardConfig
from eyas.task.rules import make_rules
from eyas.trackers.config import TrackerConfig
from eyas.trackers.drone import DRONE
from eyas.trackers.kinds import tracker_of

from .small_city import car_parts, city_scene, city_traffic, looking

CAPABILITY = (9, 0)


@pytest.fixture
def ptx_of(monkeypatch):
    """Return what compiles a function for arguments of the types of some values."""
    cuda = pytest.importorskip("numba.cuda")
    from numba.cuda import api, dispatcher

    prepare_cuda()

    no_gpu = SimpleNamespace(compute_capability=CAPABILITY)
    monkeypatch.setattr(dispatcher, "get_current_device", lambda: no_gpu)
    monkeypatch.setattr(api, "get_current_device", lambda: no_gpu, raising=False)

    def compiled(function, *types) -> str:
        signature = numba.void(*types)
        text, _ = cuda.compile(
            function, signature, cc=CAPABILITY, device=False, abi="numba", output="ptx"
        )
        return text

    return compiled


def pointer_to(bundle) -> CPointer:
    return CPointer(numba.typeof(bundle))


def shade_thread(parts, row, column, found):
    """Do what one thread does for one pixel whose triangle is known."""
    geometry, light, scratch, movers, task = parts[0]
    job = task.job
    view = address_of(view_of(job, 0, task.width, task.height, task.samples))
    lit = address_of(view_light(light.weather, job.light[0]))
    found[row, column] = shade_pixel(
        view, geometry, light, lit, movers, 0, scratch.drawn[0], scratch.key[0, row, column],
        u4(scratch.shade[0, row, column, 0]), row, column,
    )  # fmt: skip


@pytest.mark.slow  # compiles for half a minute
def test_shading_a_pixel_in_all_weathers_compiles_for_cuda(ptx_of, renderer_of, tmp_path):
    renderer = renderer_of(city_scene(), car_parts())
    traffic = city_traffic(1)
    movers = Movers(*(getattr(traffic, name) for name in Movers._fields))
    task = new_task(Size(1, 24, 32, 1, int(DrawStage.SHADING), False, 1))
    set_views(task, looking([(0.0, 0.0, 20.0)]), 0.0, 1)
    scratch = renderer._scratch_for(1, 24, 32, 1, movers.part.shape[1], False).bundle
    bundles = (*(held.bundle for held in renderer._held), scratch, movers, task)
    parts = CPointer(Tuple([pointer_to(bundle) for bundle in bundles]))
    text = ptx_of(shade_thread, parts, numba.int64, numba.int64, numba.uint32[:, ::1])
    assert ".visible .entry" in text
    assert "sqrt.rn.f32" in text
    ptxas = shutil.which("ptxas")
    if ptxas is None:
        return
    source = tmp_path / "shade.ptx"
    source.write_text(text.rstrip("\0"))
    command = [ptxas, "-v", "-arch=sm_90", "-o", os.devnull, str(source)]
    ran = subprocess.run(command, capture_output=True, text=True)
    if known := re.search(r"current version is '([\d.]+)'", ran.stderr):  # older than numba's
        source.write_text(re.sub(r"\.version [\d.]+", f".version {known[1]}", source.read_text()))
        ran = subprocess.run(command, capture_output=True, text=True)
    report = ran.stderr + ran.stdout
    assert ran.returncode == 0, report
    registers = int(re.search(r"Used (\d+) registers", report)[1])
    spilled = [int(number) for number in re.findall(r"(\d+) bytes spill", report)]
    assert registers <= 128
    assert sum(spilled) == 0


FLOWN, CAR = (
    tracker_of(TrackerConfig(**values)) for values in ({"supervised": False}, {"kind": "car"})
)


@pytest.mark.parametrize(
    ("tracker", "mounted", "kernel"),
    [
        (DRONE, False, "fly"),
        (DRONE, False, "carry"),
        (DRONE, True, "begin"),
        (FLOWN, False, "begin"),
        (FLOWN, True, "fly"),
        (CAR, False, "fly"),
    ],
)
def test_the_step_compiles_for_cuda(ptx_of, tracker, mounted, kernel):
    motion = Motion(np.zeros((2, 1), SAMPLE), np.zeros(1, np.int32), 10.0, 0.0)
    around = Surroundings(motion, Terrain.flat(0.0))
    rules = make_rules(RewardConfig(), DoneConfig(), CameraConfig())
    memory, mount = tracker.memory(2, Terrain.flat(0.0)), mount_of(MountConfig())
    state = StepState(Snapshot.create(2), memory, around, rules, 0.02, mount, 1)
    parts = [pointer_to(part) for part in (state, Orders.create(2))]
    step = getattr(step_of(tracker, CARRIED[mounted]), kernel)
    text = ptx_of(step.function, CPointer(Tuple(parts)), intp, intp)
    assert ".visible .entry" in text


def test_what_is_compiled_for_cuda_leaves_the_processors_kernels_as_they_are(ptx_of):
    """numba notes in its functions with what they were compiled last, for any processor."""

    def compiled():
        @kernel
        def larger(a):
            a[0] = greater(a[0], a[1]) + 1.0

        @kernel
        def work(a):
            larger(a)

        values = np.array([1.0, 2.0])
        work(values)
        assert values[0] == 3.0
        ptx_of(work.py_func, numba.float64[::1])

    compiled()
    compiled()
