"""The number of threads changes no byte of pictures, so neither does the number of cores."""

import hashlib

import numpy as np
import pytest

from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.lanes import thread_count

CASES = [(weather, samples) for weather in ("day", "snow") for samples in (1, 2, 4)]


def drawn(weather, samples):
    """Return a digest of what a drone that flies about sees."""
    settings = {"world": {"weather": weather}, "camera": {"samples": samples}}
    simulation = build_simulation(SimConfig(**settings), each_alone(1))
    simulation.reset()
    picture = Picture.create(1, 240, 320, depth=True, object_id=True, class_id=True)
    rng, found = np.random.default_rng(2), hashlib.sha256()
    for _ in range(15):
        simulation.advance(rng.uniform(-1.0, 1.0, (1, 4)) * (8.0, 8.0, 2.0, 1.0), 100)
        simulation.draw(np.zeros(1, np.int32), picture)
        for part in (picture.rgb, picture.depth, picture.object_id, picture.class_id):
            found.update(part.tobytes())
    return found.hexdigest()


@pytest.mark.slow  # two maps are loaded
def test_one_two_and_five_threads_draw_the_same(monkeypatch):
    found = []
    for threads in (1, 2, 5):
        monkeypatch.setenv("NUMBA_NUM_THREADS", str(threads))
        assert thread_count() == threads
        found.append([drawn(*case) for case in CASES])
    assert len(set(found[0])) == len(CASES)
    assert found[0] == found[1] == found[2]
