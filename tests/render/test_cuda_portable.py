"""The hot kernels compile for CUDA as they are: down to PTX, for which no GPU is needed."""

from types import SimpleNamespace

import numba
import numpy as np
import pytest
from numba.types import CPointer, Tuple, intp

from eyas.render.jobs import build_jobs
from eyas.render.kernels.bundles import Movers, Output, Task
from eyas.render.kernels.draw import draw_views
from eyas.sensors.config import CameraConfig
from eyas.sim.step import Orders, StepState, Surroundings, step_of
from eyas.state.draw import DrawStage
from eyas.state.motion import SAMPLE, Motion
from eyas.state.snapshot import Snapshot
from eyas.state.terrain import Terrain
from eyas.task.config import DoneConfig, RewardConfig
from eyas.task.rules import make_rules
from eyas.trackers.drone import DRONE

from .small_city import car_parts, city_scene, city_traffic, looking

CAPABILITY = (9, 0)


@pytest.fixture
def ptx_of(monkeypatch):
    """Return what compiles a function for arguments of the types of some values."""
    cuda = pytest.importorskip("numba.cuda")
    from numba.cuda import api, dispatcher

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


@pytest.mark.slow  # 36 s of compiling
def test_drawing_a_band_with_all_weathers_compiles_for_cuda(ptx_of, renderer_of):
    renderer = renderer_of(city_scene(), car_parts())
    traffic = city_traffic(1)
    movers = Movers(traffic.part, traffic.pose, traffic.colour, traffic.object_id)
    views = looking([(0.0, 0.0, 20.0)])
    job = build_jobs(views, 24, 32, 1, 0.0)
    scratch = renderer._scratch_for(1, 24, 32).bundle
    output = Output(
        np.zeros((1, 24, 32, 3), np.uint8), np.zeros((1, 24, 32), np.float32),
        np.zeros((1, 24, 32), np.int32), np.zeros((1, 6), np.int32),
    )  # fmt: skip
    task = Task(1, int(DrawStage.SHADING), movers, job, output)
    parts = [pointer_to(part) for part in (renderer._still.bundle, scratch, task)]
    text = ptx_of(draw_views.function, CPointer(Tuple(parts)), intp, intp)
    assert ".visible .entry" in text
    assert "sqrt.rn.f32" in text


@pytest.mark.parametrize("kernel", ["fly", "carry", "begin"])
def test_the_step_compiles_for_cuda(ptx_of, kernel):
    motion = Motion(np.zeros((2, 1), SAMPLE), np.zeros(1, np.int32), 10.0, 0.0)
    around = Surroundings(motion, Terrain.flat(0.0))
    rules = make_rules(RewardConfig(), DoneConfig(), CameraConfig())
    state = StepState(Snapshot.create(2), DRONE.memory(2), around, rules)
    parts = [pointer_to(part) for part in (state, Orders.create(2))]
    step = getattr(step_of(DRONE), kernel)
    text = ptx_of(step.function, CPointer(Tuple(parts)), intp, intp)
    assert ".visible .entry" in text
