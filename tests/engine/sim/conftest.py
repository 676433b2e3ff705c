"""Simulations on the shipped map; building one takes 20 ms once the assets are there."""

import dataclasses

import pytest

from eyas.engine.sim.assets import Assets, load_assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.task.config import DoneConfig, StartConfig
from eyas.engine.traffic.replay import Replay


@pytest.fixture(scope="session")
def config():
    """A start in the middle of the picture, and episodes that end by their length only."""
    start = StartConfig(pitch=1.37, height=22.0)
    return SimConfig(start=start, done=DoneConfig(no_reward_steps=10_000))


@pytest.fixture(scope="session")
def assets(config) -> Assets:
    return load_assets(config.world, config.traffic, 1)


@pytest.fixture(scope="session")
def assets_where(assets):
    """Build the assets with 12 s of its traffic, in which vehicles are away at times [s]."""
    motion = assets.traffic.motion
    motion = motion.of(motion.table[: 1 + round(12.0 * motion.rate)]).sampled()

    def build(*away: tuple[float, float]) -> Assets:
        cut = motion.table.copy()
        for leaves, comes_back in away:
            first, last = round(leaves * motion.rate) + 1, round(comes_back * motion.rate)
            cut["present"][first:last] = 0.0
        return dataclasses.replace(assets, traffic=Replay(motion._replace(table=cut).packed()))

    return build
