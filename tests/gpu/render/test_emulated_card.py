"""The PTX that ships draws the bytes of the processor, on a card that this processor emulates: with
it the second forms of loops, for threads, are tried, what warps do together, and atomic writes.

Kernels for the bundles of usual maps ship, until their sources change; then, and for those of other
scenes, they are compiled for minutes.
"""

import functools

import numpy as np
import pytest

import eyas.gpu.render.device as device_module
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.world.config import WorldConfig
from eyas.gpu.cuda import CudaError, cuda_device

from ...kit.on_devices import EVERYTHING, differences
from ...kit.small_city import looking
from .test_device import at_instant

INSTANT = 300.0


@functools.cache
def seen(weather):
    """Return a renderer, views from a hand's breadth, 2, 9 and 25 m over lanes, and what moves."""
    config = SimConfig(world=WorldConfig(map="citystreet", weather=weather))
    assets = load_assets(config.world, config.traffic, 1)
    still = StillWorld(assets)
    points = assets.scene.network.lane_points[[10, 70, 130, 200]]
    heights = assets.scene.terrain.floor + np.array([0.1, 2.0, 9.0, 25.0])
    views = looking(
        [
            tuple(map(float, (*point, height)))
            for point, height in zip(points, heights, strict=True)
        ],
        yaw=[0.3, 2.0, 4.0, 5.5],
        pitch=[0.0, 0.1, 0.5, 0.8],
        fov=1.3,
        subject=ACTOR_OBJECT + 3,
    )
    return assets.renderer, at_instant(views), still.movers(INSTANT)


@pytest.mark.parametrize(
    ("weather", "samples", "seed"), [("day", 1, 0), ("snow", 4, 1), ("night", 2, 2)]
)
def test_everything_is_equal(emulated, weather, samples, seed):
    with emulated(seed) as card:
        found = differences(cuda_device(), *seen(weather), samples=samples, **EVERYTHING)
        counted = sum(int(loaded.turns.sum()) for loaded in card.programs.values())
    assert found == []
    assert counted > 100_000


@pytest.mark.parametrize(
    "room",
    [{"RECORDS_PER_ROW": 1}, {"UNITS_PER_ROW": 2}, {"ITEMS": 5, "CLUSTERS": 8}, {"FILLERS": 1}],
)
def test_where_there_is_no_room_it_is_drawn_at_once(emulated, monkeypatch, room):
    for name, number in room.items():
        monkeypatch.setattr(device_module, name, number)
    with emulated(3):
        assert differences(cuda_device(), *seen("day"), **EVERYTHING) == []


def test_what_is_written_beyond_its_memory_is_told(emulated, monkeypatch):
    with emulated() as card:
        device = cuda_device()
        usual = device.zeros

        def zeros(shape, kind):
            """Too few keys of samples, as a mistake would have it."""
            return usual((1, 1, 8) if np.size(shape) == 3 else shape, kind)

        monkeypatch.setattr(device, "zeros", zeros)
        with pytest.raises(CudaError, match="error 700"):
            differences(device, *seen("day"), **EVERYTHING)
    assert "an address that is not the program's" in card.wrong[0]
