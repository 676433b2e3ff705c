"""Lenses of traffic lights that work."""

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.sim.assets import load_assets
from eyas.engine.state.mesh import Surface
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.net_file import SumoNet
from eyas.engine.traffic.network import network_xml
from eyas.engine.traffic.signals import Aspect, load_plan, signal_plan
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import SIGNALS_FILE
from eyas.engine.world.street.signals import lens_levels, signal_levels

AMBER = 1.0, 0.55, 0.06
"""What shines amber."""


def boxes(mesh, wanted) -> np.ndarray:
    """Lower and upper corners of the boxes of a mesh whose material is wanted, shape (K, 2, 3)."""
    which = [wanted(material) for material in mesh.palette]
    corners = mesh.positions[mesh.triangles[np.array(which)[mesh.materials]]].reshape(-1, 36, 3)
    return np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)


@pytest.mark.parametrize("level", [0, 1])
def test_an_amber_that_does_not_shine_is_hidden(level):
    def amber(material):
        return material.surface == Surface.SIGNAL and material.tint == AMBER

    below = boxes(signal_levels()[level], amber)
    assert len(below) == 3 - level
    for aspect, levels in enumerate(lens_levels(covers=True)):
        shines = len(boxes(levels[level], amber)) > 0
        assert shines == (aspect in (Aspect.AMBER, Aspect.RED_AMBER))
        over = boxes(levels[level], lambda material: True)
        for low, high in below:  # seen from the front, along y
            assert any(
                (a[[0, 2]] < low[[0, 2]]).all() and (b[[0, 2]] > high[[0, 2]]).all()
                and b[1] > high[1]
                for a, b in over
            )  # fmt: skip


@pytest.mark.slow
def test_signals_work_by_default_with_the_traffic_that_obeys_them():
    made = [
        load_assets(WorldConfig(map=name), TrafficConfig(**changes))
        for name, changes in (
            ("village", {}),
            ("village", {"signals": "amber"}),
            ("village", {"demand": "respawn"}),
            ("village-bare", {}),  # the same roads, but no poles
            ("lake", {}),
        )
    ]
    assert [each.signals is not None for each in made] == [True, False, False, False, False]
    lit, still = made[0].traffic.motion, made[1].traffic.motion
    standing = [np.mean(np.hypot(m.table["velocity_x"], m.table["velocity_y"]) < 0.1)
                for m in (lit, still)]  # fmt: skip
    assert standing[0] > 0.15 > 0.1 > standing[1]


@pytest.mark.sumo
def test_the_shipped_plans_are_those_of_the_networks():
    for name in ("citystreet", "desert", "downtown", "village"):
        recipe = MAPS.get(name)
        made = signal_plan(SumoNet(network_xml(recipe.roads(0), signals=True)))
        kept = load_plan(recipe.shipped(SIGNALS_FILE))
        assert kept.edges == made.edges
        assert all(np.array_equal(*both) for both in zip(kept[1:], made[1:], strict=True))


def test_maps_without_traffic_lights_say_so():
    with pytest.raises(ConfigError, match="'simpleway-grass', which has no traffic lights"):
        load_assets(WorldConfig(map="simpleway-grass"), TrafficConfig(signals="working"))
