"""The program that `eyas bench` times as "first picture": a fresh process, one picture."""

__all__ = ["FIRST_PICTURE"]

FIRST_PICTURE = """
import os, sys
if sys.argv[1]:  # an empty cache folder for kernels and shadows
    os.environ["XDG_CACHE_HOME"] = sys.argv[1]
    os.environ["NUMBA_CACHE_DIR"] = sys.argv[1] + "/kernels"
import numpy as np
from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.state.draw import Picture
simulation = build_simulation(SimConfig(), 1, shared_world=False)
simulation.reset()
simulation.draw(np.zeros(1, np.int32), Picture.create(1, 84, 84))
"""
