"""The program that `eyas bench` times as "first picture": a fresh process, one picture."""

__all__ = ["FIRST_PICTURE"]

FIRST_PICTURE = """
import os, sys
if sys.argv[1]:  # an empty folder for the cache, compiled kernels too
    os.environ["EYAS_CACHE_DIR"] = sys.argv[1]
    os.environ.pop("NUMBA_CACHE_DIR", None)
import numpy as np
from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.sim.worlds import each_alone
from eyas.state.draw import Picture
simulation = build_simulation(SimConfig(), each_alone(1))
simulation.reset()
simulation.draw(np.zeros(1, np.int32), Picture.create(1, 84, 84))
"""
