"""Networks by netconvert: true to the graph, strongly connected, the same each time."""

from dataclasses import fields, replace
from xml.etree import ElementTree

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError, MissingExtraError
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode
from eyas.engine.state.scene import ObjectClass
from eyas.engine.traffic import network, sumo_install
from eyas.engine.traffic.network import build_network, graph_hash, network_xml
from eyas.engine.world.maps import MAPS
from eyas.maps.citystreet import CITYSTREET

needs_sumo = pytest.mark.sumo


def test_the_hash_follows_what_netconvert_is_told(grid):
    assert graph_hash(grid) == graph_hash(replace(grid, map_name="other", seed=5))
    moved = (replace(grid.nodes[0], x=-180.01), *grid.nodes[1:])
    assert graph_hash(grid) != graph_hash(replace(grid, nodes=moved))
    faster = (replace(grid.edges[0], speed=20.0), *grid.edges[1:])
    assert graph_hash(grid) != graph_hash(replace(grid, edges=faster))


@pytest.mark.parametrize("name", MAPS.built_in)
def test_shipped_networks_belong_to_their_graphs(name):
    recipe = MAPS.get(name)
    assert recipe.shipped_network().graph_hash == graph_hash(recipe.roads(0))


@pytest.mark.slow
@needs_sumo
@pytest.mark.parametrize("name", MAPS.built_in)
def test_shipped_networks_are_what_netconvert_makes(name):
    recipe = MAPS.get(name)
    shipped, built = recipe.shipped_network(), build_network(recipe.roads(0))
    if shipped.builder != built.builder:
        pytest.skip(f"shipped by {shipped.builder}, here is {built.builder}")
    for field in fields(shipped):
        assert np.array_equal(getattr(shipped, field.name), getattr(built, field.name))


@needs_sumo
def test_lanes_lie_where_the_graph_has_its_roads(grid):
    network = build_network(grid)
    at = {node.name: np.array([node.x, node.y]) for node in grid.nodes}
    assert len(network.lane_width) == 2 * len(grid.edges)
    assert set(network.lane_width) == {3.5}
    for lane, edge in enumerate(network.lane_edge):
        points = network.lane_points[network.lane_first[lane] : network.lane_first[lane + 1]]
        start, end = at[network.edge_start[edge]], at[network.edge_end[edge]]
        onwards = (end - start) / np.linalg.norm(end - start)
        rightwards = np.array([onwards[1], -onwards[0]])
        aside = (points - start) @ rightwards
        assert aside == pytest.approx(5.25 - 3.5 * network.lane_index[lane], abs=0.01)
        assert np.all(np.diff((points - start) @ onwards) > 0)


@needs_sumo
def test_a_bent_edge_keeps_its_shape():
    nodes = (RoadNode("a", 0, 0), RoadNode("b", 200, 0))
    bent = ((100.0, 60.0),)
    edges = (RoadEdge("there", "a", "b", shape=bent), RoadEdge("back", "b", "a", shape=bent))
    network = build_network(RoadGraph("bent", 0, nodes, edges))
    assert network.lane_points[:, 1].max() > 55.0


@needs_sumo
def test_the_file_is_the_same_each_time_and_names_no_time_or_folder(grid):
    xml = network_xml(grid)
    assert xml == network_xml(grid)
    assert b"<!--" not in xml
    assert b"eyas-roads" not in xml


@needs_sumo
@pytest.mark.parametrize("seed", range(4))
def test_from_every_road_of_a_city_every_other_can_be_reached_without_turning_round(seed):
    root = ElementTree.fromstring(network_xml(CITYSTREET.roads(seed)))
    onwards: dict[str, set[str]] = {}
    for link in root.findall("connection"):
        if not link.attrib["from"].startswith(":"):
            onwards.setdefault(link.attrib["from"], set()).add(link.attrib["to"])
    for edge, following in onwards.items():
        assert "-".join(reversed(edge.split("-"))) not in following
        reached, open_ends = {edge}, [edge]
        while open_ends:
            fresh = onwards[open_ends.pop()] - reached
            reached |= fresh
            open_ends += fresh
        assert len(reached) == 64


@pytest.mark.slow
@needs_sumo
@pytest.mark.parametrize("seed", [1, 2])  # cities that tests of lamps need, too
def test_other_seeds_become_whole_cities(seed):
    scene = load_scene("citystreet", seed)
    assert (np.linalg.norm(scene.fixtures.pose[:, 0, :2], axis=1) > 12.0).sum() == 63
    assert (scene.object_class == ObjectClass.BUILDING).sum() > 70


@needs_sumo
def test_what_netconvert_refuses_is_told_in_one_line(grid):
    broken = replace(grid, edges=(replace(grid.edges[0], end="nowhere"),))
    with pytest.raises(ConfigError, match=r"'grid'.*nowhere") as caught:
        build_network(broken)
    assert "\n" not in str(caught.value)


def test_without_sumo_the_extra_and_the_system_packages_are_named(grid, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "sumo", None)
    with pytest.raises(MissingExtraError, match=r"\[sumo\]") as caught:
        build_network(grid)
    assert sumo_install.SYSTEM_PACKAGES in str(caught.value)
    assert "\n" not in str(caught.value)


def test_two_nodes_or_edges_of_one_name_are_refused(grid):
    moved = replace(grid.nodes[0], x=grid.nodes[0].x + 1.0)
    twins = {
        f"node '{moved.name}' is there twice": replace(grid, nodes=(*grid.nodes, moved)),
        f"edge '{grid.edges[0].name}' is there": replace(grid, edges=(*grid.edges, grid.edges[0])),
    }
    for line, graph in twins.items():
        with pytest.raises(ConfigError, match=line):
            build_network(graph)


def test_any_name_survives_in_the_files_for_netconvert():
    name = "A & \"B\" <c> 'd'\n\te"
    node = RoadNode(name, 1.0, 2.0)
    xml = network._node_xml((node,))
    assert [found.get("id") for found in ElementTree.fromstring(xml)] == [name]
