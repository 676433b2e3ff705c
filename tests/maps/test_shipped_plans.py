"""Plans that ship are those that today's code makes, or are not used."""

import lzma
from dataclasses import replace

import pytest

from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.planner import planner
from eyas.engine.world.maps.recipe import MADE_PLAN_SUFFIX, MapRecipe
from eyas.lanes.container import packed

FARMLAND = MAPS.get("farmland")


def test_a_plan_that_ships_is_that_which_is_made():
    network = FARMLAND.shipped_network()
    made = planner().text_of(FARMLAND.complete_plan(network, 0)).encode()
    assert FARMLAND.shipped_plan(0) in (made, None)  # none before a release


@pytest.mark.parametrize(
    ("made_by", "seed", "found"), [("now", 0, b"plan"), ("now", 1, None), ("before", 0, None)]
)
def test_a_plan_that_other_code_has_made_is_not_used(tmp_path, monkeypatch, made_by, seed, found):
    content = lzma.compress(b"".join(packed(made_by, [b"plan"])))
    (tmp_path / f"farmland{MADE_PLAN_SUFFIX}").write_bytes(content)
    monkeypatch.setattr(MapRecipe, "plan_code", lambda recipe: "now")
    assert replace(FARMLAND, package=None, home=tmp_path).shipped_plan(seed) == found
