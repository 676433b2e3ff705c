"""The number of threads changes no byte of pictures, so neither does the number of cores."""

import os
import subprocess
import sys

import pytest

DRAWS = """
import hashlib
import numpy as np
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture

picture = Picture.create(1, 240, 320, depth=True, object_id=True, class_id=True)
for weather in ("day", "snow"):
    for samples in (1, 2, 4):
        settings = {"world": {"weather": weather}, "camera": {"samples": samples}}
        simulation = build_simulation(SimConfig(**settings), each_alone(1))
        simulation.reset()
        rng, found = np.random.default_rng(2), hashlib.sha256()
        for _ in range(15):
            simulation.advance(rng.uniform(-1.0, 1.0, (1, 4)) * (8.0, 8.0, 2.0, 1.0), 100)
            simulation.draw(np.zeros(1, np.int32), picture)
            for part in (picture.rgb, picture.depth, picture.object_id, picture.class_id):
                found.update(part.tobytes())
        print(weather, samples, found.hexdigest())
"""


def drawn(threads) -> str:
    variables = os.environ | {"NUMBA_NUM_THREADS": str(threads)}
    run = subprocess.run(
        [sys.executable, "-c", DRAWS], env=variables, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.mark.slow  # three processes that load two maps
def test_one_two_and_five_threads_draw_the_same():
    alone = drawn(1)
    assert len(set(alone.split())) == 2 + 3 + 6
    assert drawn(2) == alone
    assert drawn(5) == alone
