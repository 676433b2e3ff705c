"""The hot kernels compile for CUDA as they are: down to PTX, for which no GPU is needed."""

from types import SimpleNamespace

import numba
import numpy as np
import pytest

from eyas.render.jobs import build_jobs
from eyas.render.kernels import draw
from eyas.render.kernels.bundles import Movers, Output, Stage
from eyas.sim.build import build_simulation
from eyas.sim.config import EyasConfig
from eyas.sim.step import fly

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

    def compiled(function, *values) -> str:
        types = tuple(numba.typeof(value) for value in values)
        signature = numba.void(*types)
        text, _ = cuda.compile(
            function, signature, cc=CAPABILITY, device=False, abi="numba", output="ptx"
        )
        return text

    return compiled


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
    draw_job, until = draw._draw_job, int(Stage.SHADING)

    def one_band(geometry, light, movers, job, scratch, output):
        draw_job(0, 0, 1, until, geometry, light, movers, job, scratch, output)

    text = ptx_of(one_band, renderer._geometry, renderer._light, movers, job, scratch, output)
    assert ".visible .entry" in text
    assert "sqrt.rn.f32" in text


def test_the_fused_step_compiles_for_cuda(ptx_of):
    simulation = build_simulation(EyasConfig(), 2, shared_world=False)

    def step(actions, fleet, traffic, rules):
        fly(4, actions, fleet, traffic, rules)

    text = ptx_of(step, np.zeros((2, 4)), simulation._fleet, simulation._traffic, simulation._rules)
    assert ".visible .entry" in text
