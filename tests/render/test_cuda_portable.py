"""The hot kernels compile for CUDA as they are: down to PTX, for which no GPU is needed."""

from types import SimpleNamespace

import numba
import numpy as np
import pytest
from numba.types import CPointer, Tuple, intp

from eyas.render.jobs import build_jobs
from eyas.render.kernels.bundles import Movers, Output, Task
from eyas.render.kernels.draw import draw_views
from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.sim.step import fly
from eyas.state.draw import DrawStage

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


def test_drawing_a_band_with_all_weathers_compiles_for_cuda(ptx_of, renderer_of):
    renderer = renderer_of(city_scene(), car_parts())
    traffic = city_traffic(1)
    movers = Movers(traffic.part, traffic.pose, traffic.colour, traffic.object_id)
    views = looking([(0.0, 0.0, 20.0)])
    job = build_jobs(views, 24, 32, 1, 1, 0.0)
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


def test_the_fused_step_compiles_for_cuda(ptx_of):
    simulation = build_simulation(SimConfig(), 2, shared_world=False)

    def step(actions, fleet, traffic, rules):
        fly(4, actions, fleet, traffic, rules)

    values = (np.zeros((2, 4)), simulation._fleet, simulation._traffic, simulation._rules)
    text = ptx_of(step, *map(numba.typeof, values))
    assert ".visible .entry" in text
