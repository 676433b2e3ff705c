"""What `eyas maps info` tells of the maps that ship."""

import sys

import numpy as np
import pytest

from eyas.cli.main import main
from eyas.engine.sim.scenes import load_scene
from eyas.engine.world.maps import MAPS
from eyas.maps.commands.info import describe, figures_of


@pytest.mark.slow
def test_stands_count_as_the_trees_they_are_and_shrubs_as_none():
    lake, village = figures_of(load_scene("lake", 0)), figures_of(load_scene("village", 0))
    assert (lake.trees, lake.stands) == (13_520, 676)
    assert (village.trees, village.stands) == (365, 0)  # its hedges and bushes are no trees
    assert "trees: 13520 (" in "\n".join(describe("lake", 0))


def test_streets_are_measured_to_the_middle_of_junctions_and_told_without_them():
    said = figures_of(load_scene("village", 0))
    graph = MAPS.get("village").roads(0)
    at = {node.name: np.array([node.x, node.y]) for node in graph.nodes}
    links = {frozenset((edge.start, edge.end)) for edge in graph.edges}
    straight = sum(np.linalg.norm(at[a] - at[b]) for a, b in map(tuple, links)) / 1000.0
    assert said.road == pytest.approx(straight, rel=0.01)
    assert 0.85 * said.road < said.between < 0.95 * said.road
    first = describe("village", 0)
    assert f"streets: {said.road:.2f} km, {said.between:.2f} km without junctions" in first[3]


def test_the_originals_figures_stand_beside_ours():
    lines = describe("village", 0)
    assert (
        "the original has 3.59 km of streets, 24 buildings, median height 12 m, 41 trees" in lines
    )
    assert all(MAPS.get(name).original is not None for name in MAPS.built_in)


@pytest.mark.slow
@pytest.mark.sumo
def test_a_new_map_of_a_kind_is_made_at_once_with_its_traffic(
    monkeypatch, capsys, caplog, empty_cache
):
    monkeypatch.setenv("EYAS_CACHE_DIR", str(empty_cache))
    monkeypatch.setattr(sys, "argv", ["eyas", "maps", "new", "farmland-bare", "--map-seed", "3"])
    with pytest.raises(SystemExit, match="0"):
        main()
    assert "recording 1260 s of traffic" in caplog.text
    assert capsys.readouterr().out.endswith("use it with --map farmland-bare --set world.seed=3\n")
    caplog.clear()
    with pytest.raises(SystemExit, match="0"):
        main()
    assert "recording" not in caplog.text
