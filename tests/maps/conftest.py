import pytest

from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import Scene
from eyas.maps.citystreet import CITYSTREET

from ..kit.frames import episode, frame, run

__all__ = ["episode", "frame", "run"]


@pytest.fixture(scope="session")
def network() -> RoadNetwork:
    """Roads of citystreet, seed 0."""
    return CITYSTREET.shipped_network()


@pytest.fixture(scope="session")
def scene() -> Scene:
    """Citystreet in summer, seed 0: of the cache, or built once for all tests."""
    return load_scene("citystreet", 0)
