"""The first start: what the second process compiles is what the first will need."""

import subprocess
import sys

import pytest

from eyas.engine.render import ahead
from eyas.engine.render.kernels.draw import draw_views

from ...kit.small_city import looking


def test_drawing_nothing_compiles_what_drawing_a_city_needs(city, drawn, monkeypatch):
    renderer, traffic = city

    def compiled_by(draw):
        monkeypatch.setattr(draw_views, "_loaded", {})  # other tests have drawn already
        draw()
        return set(draw_views._loaded)

    needed = compiled_by(lambda: drawn(renderer, looking([(0, 0, 20)]), traffic))
    assert needed
    assert compiled_by(ahead.draw_nothing) == needed


@pytest.fixture
def begins(tmp_path, monkeypatch):
    """Return a function that begins a start with an empty cache of kernels."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kernels"))
    monkeypatch.setattr(ahead, "_COMPILE", "import eyas; raise SystemExit(7)")
    monkeypatch.setattr(ahead.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(ahead, "_compiling", [])

    def begin(*, shipped):
        monkeypatch.setattr(ahead, "nothing_compiled", lambda name: not shipped)
        ahead.begin_ahead()
        return ahead._compiling

    return begin


def test_a_first_start_is_told_and_shared_by_one_of_those_that_start_together(begins, caplog):
    (process,) = begins(shipped=False)
    assert "first start" in caplog.text
    ahead.drawing_is_ready()
    assert process.returncode == 7
    assert begins(shipped=False) == [process]


def test_where_kernels_are_shipped_there_is_no_second_process(begins, caplog):
    assert begins(shipped=True) == []
    assert not caplog.text
    ahead.drawing_is_ready()  # waits for nothing


ASKS = """
import sys
from eyas.lanes import entry
from eyas.engine.render import ahead
address = entry.entry_address
entry.entry_address = lambda function, bundles, **options: (
    print(function.__name__) or address(function, bundles, **options)
)
if sys.argv[1] == "second":
    ahead.draw_nothing()
    sys.exit()
import numpy as np
from eyas.engine.render import renderer
from eyas.engine.sim import assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
assets.drawing_is_ready = lambda: print("waits")
simulation = build_simulation(SimConfig(), each_alone(1))
simulation.reset()
simulation.draw(np.zeros(1, np.int32), Picture.create(1, 8, 8))
"""


def asked_for(process):
    """Return the kernels that a process asks for, in order, and when it waits."""
    command = [sys.executable, "-c", ASKS, process]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return done.stdout.split()


def test_no_kernel_is_compiled_by_both_processes():
    first, second = asked_for("first"), asked_for("second")
    own = first[: first.index("waits")]
    assert {"_fly", "_list_actors"} <= set(own)
    assert not set(own) & set(second)
    assert set(first[len(own) + 1 :]) == set(second) == {"draw_views"}
