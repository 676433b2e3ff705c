"""The hot kernels compile for graphics processors as they are: to PTX, for which none is needed."""

import os
import re
import shutil
import subprocess

import numpy as np
import pytest

from eyas.lanes import address_of, parallel
from eyas.lanes.ptx import ptx_of
from eyas.render.jobs import Size, new_task, set_views
from eyas.render.kernels.bundles import Movers
from eyas.render.kernels.draw import band_of, no_glass, view_light
from eyas.render.kernels.scalars import u4
from eyas.render.kernels.visibility.transform import view_of
from eyas.sensors.config import CameraConfig, MountConfig
from eyas.sensors.mount import CARRIED, mount_of
from eyas.sim.step import Orders, StepState, StepSurroundings, step_of
from eyas.state.draw import DrawStage
from eyas.state.motion import SAMPLE, Motion
from eyas.state.snapshot import Snapshot
from eyas.state.terrain import Terrain
from eyas.task.config import DoneConfig, RewardConfig
from eyas.task.rules import make_rules
from eyas.trackers.config import TrackerConfig
from eyas.trackers.drone import DRONE
from eyas.trackers.kinds import tracker_of

from .one_pixel import shade_pixel
from .small_city import car_parts, city_scene, city_traffic, looking


def checked(text) -> str:
    """Return PTX that is whole and that computes the bytes of the processor."""
    assert re.findall(r"\.entry (\w+)", text) == ["kernel"]
    assert "fma" not in text
    assert "vprintf" not in text
    assert not re.search(r"\.extern \.func", text)
    assert not re.search(r"\b(mad|mul|add|sub)\.(f32|f64)\b", text)  # `mul.rn`: never fused later
    return text


@parallel
def shade_thread(row, column, geometry, light, scratch, movers, task, found):
    """Do what one thread does for one pixel whose triangle is known."""
    job = task.job
    view = address_of(view_of(task, 0))
    lit = address_of(view_light(light.weather, job.light, 0))
    glass = address_of(no_glass(scratch, 0))
    band = address_of(
        band_of(geometry, light, lit, movers, 0, view, glass, task.until, scratch, 0, 0, 1)
    )
    key, shade = band.key[row, column], u4(band.shade[row, column, 0])
    found[row, column] = shade_pixel(band, key, shade, row, column)


@pytest.mark.slow  # compiles for half a minute
def test_shading_a_pixel_in_all_weathers_compiles_for_cuda(renderer_of, tmp_path):
    renderer = renderer_of(city_scene(), car_parts())
    traffic = city_traffic(1)
    movers = Movers(*(getattr(traffic, name) for name in Movers._fields))
    size = Size(1, 24, 32, 1, 1, int(DrawStage.SHADING), False, False, 1)
    task = new_task(size)
    set_views(task, looking([(0.0, 0.0, 20.0)]), 0.0, 1)
    scratch = renderer._scratch_for(1, 24, size, movers.part.shape[1], False, None).bundle
    found = np.zeros((24, 32), np.uint32)
    bundles = (*(held.bundle for held in renderer._held), scratch, movers, task, found)
    text = checked(ptx_of(shade_thread, bundles, "kernel"))
    assert "sqrt.rn.f32" in text
    ptxas = shutil.which("ptxas")
    if ptxas is None:
        return
    source = tmp_path / "shade.ptx"
    source.write_text(text)
    command = [ptxas, "-v", "-arch=sm_90", "-o", os.devnull, str(source)]
    ran = subprocess.run(command, capture_output=True, text=True)
    if known := re.search(r"current version is '([\d.]+)'", ran.stderr):  # older than LLVM's
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
def test_the_step_compiles_for_cuda(tracker, mounted, kernel):
    motion = Motion(np.zeros((2, 1), SAMPLE), np.zeros(1, np.int32), 10.0, 0.0)
    around = StepSurroundings(motion, Terrain.flat(0.0))
    rules = make_rules(RewardConfig(), DoneConfig(), CameraConfig())
    memory, mount = tracker.memory(2, Terrain.flat(0.0)), mount_of(MountConfig())
    state = StepState(Snapshot.create(2), memory, around, rules, 0.02, mount, 1)
    step = getattr(step_of(tracker, CARRIED[mounted]), kernel)
    checked(ptx_of(step, (state, Orders.create(2)), "kernel"))
