"""Maps by name."""

import pytest

from eyas.core.errors import NotInThisVersionError, UnknownNameError
from eyas.world.maps import LATER, MAPS, build_scene, road_graph, shipped_network


def test_an_unknown_map_is_told_with_the_nearest_name():
    with pytest.raises(UnknownNameError, match=r"world\.map: .*'citystret'.*mean 'citystreet'"):
        road_graph("citystret", 0)


@pytest.mark.parametrize("name", LATER)
def test_maps_of_later_versions_are_told_in_one_line(name):
    network = shipped_network("citystreet")
    for ask in (
        lambda: road_graph(name, 0),
        lambda: shipped_network(name),
        lambda: build_scene(name, network, 0),
    ):
        with pytest.raises(NotInThisVersionError, match=name) as caught:
            ask()
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", MAPS)
def test_the_roads_of_seed_0_are_shipped(name):
    assert shipped_network(name) is not None
