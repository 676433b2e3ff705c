"""What a start imports."""

import subprocess
import sys

import pytest

REGISTERED = """
import sys
import eyas
assert "gymnasium" not in sys.modules
import gymnasium
assert gymnasium.__spec__.loader.get_source("gymnasium")
assert "eyas/citystreet-day-v0" in gymnasium.registry
"""

DRAWS = """
import sys
import numpy as np
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
simulation = build_simulation(SimConfig(traffic={"signals": "amber"}), each_alone(1))
simulation.reset()
simulation.draw(np.zeros(1, np.int32), Picture.create(1, 8, 8))
"""

LITTLE = """
slow = {"gymnasium", "numba", "numpy.ma", "PIL", "shapely", "urllib.request"} & sys.modules.keys()
assert not slow, slow
"""


def run(program: str) -> None:
    subprocess.run([sys.executable, "-c", program], check=True)


def test_environments_are_registered_when_gymnasium_is_imported_after_eyas():
    run(REGISTERED)


@pytest.mark.slow
def test_a_first_picture_imports_nothing_slow_that_it_does_not_need():
    exec(DRAWS, {})  # fills the cache, if it is empty
    run(DRAWS + LITTLE)


def test_the_names_of_maps_are_known_where_gymnasium_comes_first():
    run("import gymnasium, eyas; assert 'eyas/lake-snow-v0' in gymnasium.registry")
