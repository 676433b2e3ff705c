"""Where the time of a picture goes."""

from types import SimpleNamespace

import numpy as np
import pytest

from eyas.cli.bench import pictures as bench_pictures
from eyas.engine.sim.assets import load_assets
from eyas.engine.state.draw import DrawList, DrawStage, Picture, Views
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig


class Clockwork:
    """A simulation, its picture and a clock: drawing as far as a stage takes a known time [s]."""

    UNTIL = (0.001, 0.003, 0.006, 0.010, 0.015)
    COPYING = 0.005

    def __init__(self, monkeypatch):
        self.now = 0.0
        self.rgb = SimpleNamespace(copy=lambda: self.spend(self.COPYING))
        picture = SimpleNamespace(create=lambda *_: self)
        monkeypatch.setattr(bench_pictures, "time", self)
        monkeypatch.setattr(bench_pictures, "build_simulation", lambda *_: self)
        monkeypatch.setattr(bench_pictures, "Picture", picture)

    def perf_counter(self):
        return self.now

    process_time = perf_counter

    def spend(self, seconds):
        self.now += seconds

    def reset(self):
        self.spend(100.0)

    def draw(self, trackers, picture, until):
        assert picture is self
        self.spend(self.UNTIL[until])


def test_a_stage_takes_what_it_adds_to_the_stages_before_it(monkeypatch):
    Clockwork(monkeypatch)
    monkeypatch.setattr(bench_pictures, "SIZES", ((2, 16, 12),))
    times = bench_pictures.measure_stages(1.0)
    assert [time.microseconds for time in times] == pytest.approx(
        [500, 1000, 1500, 2000, 2500, 2500]
    )
    assert [time.share for time in times] == pytest.approx([0.05, 0.1, 0.15, 0.2, 0.25, 0.25])
    assert times[-1].stage == "copying out"


def test_other_load_makes_no_stage_longer_and_none_negative(monkeypatch):
    clockwork = Clockwork(monkeypatch)
    clockwork.UNTIL = (0.001, 0.003, 0.0029, 0.010, 0.015)
    monkeypatch.setattr(bench_pictures, "SIZES", ((1, 16, 12),))
    draws = iter(range(1000))
    usual = clockwork.draw

    def draw(trackers, picture, until):
        clockwork.spend(0.5 * (next(draws) % 3 == 0))  # another program takes its turn
        usual(trackers, picture, until)

    clockwork.draw = draw
    times = bench_pictures.measure_stages(20.0)
    assert [time.microseconds for time in times] == pytest.approx([1000, 2000, 0, 7000, 5000, 5000])


def test_the_table_has_a_row_for_each_stage_and_a_column_for_each_size(monkeypatch):
    monkeypatch.setattr(bench_pictures, "SIZES", ((2, 16, 12), (1, 12, 8)))
    times = bench_pictures.measure_stages(0.0)
    assert {time.pictures for time in times} == {"16x12, 2 views", "12x8, 1 view"}
    table = bench_pictures.stage_table(times)
    assert (table.row_count, len(table.columns)) == (len(DrawStage) + 1, 3)


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
