import pytest

from eyas.core.errors import NotInThisVersionError
from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.sim.worlds import each_alone


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"target": "Mantis"}, r"target: 'Mantis': "),
    ],
)
def test_a_simulation_refuses_what_it_would_ignore(values, line):
    with pytest.raises(NotInThisVersionError, match=rf"^{line}.* is not in this version yet$"):
        build_simulation(SimConfig(**values), each_alone(1))
