"""Where the time of a picture goes."""

import numpy as np
import pytest

from eyas.modes.bench import stages as bench_stages
from eyas.sim.assets import load_assets
from eyas.state.draw import DrawList, DrawStage, Picture, Views
from eyas.traffic.config import TrafficConfig
from eyas.world.config import WorldConfig


def test_the_shares_of_all_stages_make_one(monkeypatch):
    monkeypatch.setattr(bench_stages, "SIZES", ((2, 16, 12),))
    times = bench_stages.measure_stages(0.0)
    assert sum(time.share for time in times) == pytest.approx(1.0)
    assert {time.pictures for time in times} == {"16x12, 2 views"}
    assert bench_stages.stage_table(times).row_count == len(times) == len(DrawStage) + 1


def test_a_picture_that_stops_early_has_depths_but_no_colours():
    assets = load_assets(WorldConfig(), TrafficConfig(), 1)
    pictures = [Picture.create(1, 24, 32, depth=True) for _ in DrawStage]
    down = np.array([[[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]])
    nothing = np.zeros(1, np.int32)
    views = Views(np.array([[0.0, 0.0, 300.0]]), down, nothing, nothing - 1, 0.8)
    movers = DrawList.create(1, 1)
    for stage, picture in zip(DrawStage, pictures, strict=True):
        assets.renderer.draw(views, movers, picture, until=stage)
    assert np.isinf(pictures[DrawStage.VERTICES].depth).all()
    np.testing.assert_array_equal(pictures[DrawStage.RASTERISING].depth, pictures[-1].depth)
    assert [bool(picture.rgb.any()) for picture in pictures] == [False] * 4 + [True]
