"""The grounds of two maps: a flat city, and a village between hills."""

import numpy as np
import pytest

from eyas.engine.behaviours.ground import WalkingGround
from eyas.engine.behaviours.groups import SampleClock, ScriptedGroup, lasting
from eyas.engine.behaviours.scripted import scripted_table
from eyas.engine.core.rng import stream
from eyas.engine.sim.scenes import load_scene
from eyas.engine.targets.catalogue import habit_of

from .habits import HABITS

CLOCK = SampleClock(601, 10.0)


@pytest.fixture(scope="session")
def city():
    return WalkingGround(load_scene("citystreet"), roads=False)


@pytest.fixture(scope="session")
def hills():
    return WalkingGround(load_scene("village"), roads=False)


def group(kind: str, count: int = 8, breadth: float = 0.6, **changes) -> ScriptedGroup:
    lifetimes = lasting(count, CLOCK.samples)
    made = ScriptedGroup(kind, breadth, None, habit_of(kind), lifetimes, 0.0, "objects.max_count")
    return made._replace(**changes)


def table_of(ground, which, seed=0) -> np.ndarray:
    return scripted_table(ground, which, CLOCK, stream(seed, which.kind))


@pytest.fixture(scope="session")
def city_tables(city):
    """One minute of eight of each kind."""
    return {kind: table_of(city, group(kind)) for kind in HABITS}
