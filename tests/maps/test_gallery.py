"""The gallery: what lies in its folder, and what it refuses to write over."""

import re
import sys
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
import shapely
from PIL import Image

from eyas.cli.main import main
from eyas.engine.core.errors import OutputError, UnknownNameError
from eyas.engine.sim.assets import load_assets
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.maps.citystreet import CITYSTREET
from eyas.maps.gallery import run as gallery
from eyas.maps.gallery.places import (
    all_cars,
    before_spans,
    beside_most,
    on_crossings,
    on_open_roads,
    stop,
)
from eyas.maps.gallery.run import PageEntry, choose_viewpoints, page
from eyas.maps.gallery.still import StillScene

pytestmark = pytest.mark.slow  # what its tests share takes long to make

SUN = CITYSTREET.light("day").sun_direction
WEATHERS = ("day", "foggy")


class Pictures(HTMLParser):
    """Collects the attributes of the page's pictures, and all tags."""

    def __init__(self, text):
        super().__init__()
        self.images, self.tags = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        if tag == "img":
            self.images.append(dict(attributes))


@pytest.fixture(scope="module")
def still():
    return StillScene(load_assets(WorldConfig(), TrafficConfig(), 1))


@pytest.fixture(scope="module")
def views(still):
    return choose_viewpoints(still, SUN)


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    out = tmp_path_factory.mktemp("drawn") / "gallery"
    gallery.run(out, ["citystreet"], WEATHERS)
    return out


@pytest.fixture
def few(views, monkeypatch):
    """Two viewpoints are enough for tests of files."""
    chosen = [view for view in views if view.name in ("horizon", "overview")]
    monkeypatch.setattr(gallery, "choose_viewpoints", lambda *_: chosen)


def files(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_the_page_shows_each_viewpoint_and_says_what_it_is(drawn, views):
    text = (drawn / gallery.INDEX).read_text()
    shown = Pictures(text)
    sources = [image["src"] for image in shown.images]
    assert sources == [
        f"citystreet-{weather}/{view.name}.png" for weather in WEATHERS for view in views
    ]
    every = views * len(WEATHERS)
    for image, view in zip(shown.images, every, strict=True):
        assert view.caption in image["alt"]
        assert view.caption in text
    assert set(files(drawn)) == {
        (drawn / name).relative_to(drawn) for name in (gallery.INDEX, gallery.SHEET, *sources)
    }


def test_the_page_needs_no_script_and_no_network(drawn):
    text = (drawn / gallery.INDEX).read_text()
    assert not Pictures(text).tags & {"script", "link", "iframe"}
    assert not re.search(r"https?:|url\(|@import", text)


def test_every_picture_opens_at_the_size_that_the_page_says_and_is_not_flat(drawn):
    for image in Pictures((drawn / gallery.INDEX).read_text()).images:
        with Image.open(drawn / image["src"]) as picture:
            pixels = np.asarray(picture.convert("RGB"))
        assert (str(pixels.shape[1]), str(pixels.shape[0])) == (image["width"], image["height"])
        assert pixels.std() > 8.0, image["src"]
    with Image.open(drawn / gallery.SHEET) as sheet:
        assert np.asarray(sheet).std() > 15.0


def test_the_observation_is_84_pixels_wide_with_each_pixel_four_times_as_large(drawn):
    with Image.open(drawn / "citystreet-day" / "observation.png") as picture:
        pixels = np.asarray(picture)
    assert pixels.shape == (336, 336, 3)
    assert np.array_equal(pixels, np.kron(pixels[::4, ::4], np.ones((4, 4, 1), np.uint8)))


def test_drone_views_have_their_car_in_the_middle_and_unhidden(still, views):
    about = [view for view in views if view.actor >= 0 and view.enlarged == 1]
    assert {(view.position[2], view.pitch) for view in about} == {(22.0, 1.37), (15.0, 0.6)}
    assert {view.name.split("-")[0] for view in about} == {"trees", "crossing", "towers", "sights"}
    for view in about:
        car = still.actors(view.time).position[0, view.actor]
        apart = np.linalg.norm(car[:2] - view.position[:2])
        # 1.5 m: the drone looks at the middle of the body, not at the reference point.
        assert apart == pytest.approx(view.position[2] / np.tan(view.pitch), abs=1.5)
        assert still.probe(view)[1] > 0.7


def test_the_next_thing_over_the_road_is_a_few_metres_ahead():
    still = StillScene(load_assets(WorldConfig(map="village"), TrafficConfig(), 1))
    cars = all_cars(still)
    soon = np.flatnonzero(before_spans(still.scene, cars))
    assert 0 < len(soon) < 0.1 * len(cars.time)
    views = {view.name: view for view in choose_viewpoints(still, SUN)}
    assert still.sights(views["span-ahead"]) > 0.15
    # From farther back the whole mouth of the tunnel is seen.
    assert still.sights(views["span-along"]) >= still.sights(views["span-ahead"])


def test_most_stands_where_pictures_show_most(still, views):
    cars = all_cars(still)
    rated = beside_most(still, cars)
    assert 0 < np.count_nonzero(rated) < len(rated)
    view = next(view for view in views if view.name == "sights-ahead")
    assert still.sights(view) > 0.8 * rated.max()


def test_a_distant_view_in_which_dust_leaves_nothing_to_see_is_left_out(still, views):
    dusty = WorldConfig(map="lake", weather="dust")
    hidden = choose_viewpoints(StillScene(load_assets(dusty, TrafficConfig(), 1)), SUN)
    assert "horizon" not in {view.name for view in hidden}
    horizon = next(view for view in views if view.name == "horizon")
    assert still.contrast(horizon) > 5.0


@pytest.mark.parametrize("turn", range(0, 360, 45))
def test_no_wall_fills_the_overview_wherever_the_sun_stands(still, turn):
    sun = (np.cos(np.radians(turn)), np.sin(np.radians(turn)), 1.0)
    overview = next(view for view in choose_viewpoints(still, sun) if view.name == "overview")
    depth = still.probe(overview)[0]
    assert overview.position[2] == 60.0
    assert np.median(depth) > 60.0
    assert np.quantile(depth, 0.1) > 60.0


def test_cars_that_a_drone_in_a_tree_would_look_at_are_passed_over(still):
    cars = all_cars(still)
    back = 15.0 / np.tan(0.6) * np.stack([np.cos(cars.yaw), np.sin(cars.yaw)], axis=1)
    crowns = still.scene.fixtures.pose[:, :2, 3]
    scale = np.linalg.norm(still.scene.fixtures.pose[:, 0, :3], axis=1)  # a tree's height
    crowns = crowns[scale > 17.0]
    apart = np.linalg.norm((cars.position - back)[:, None] - crowns[None], axis=2).min(axis=1)
    assert (apart < 6.0).sum() > 1
    assert not list(stop(still, cars, "trees", "in a tree", (apart < 6.0).astype(float)))


def test_an_open_road_is_far_from_junctions(still):
    cars = all_cars(still)
    far, crossing = on_open_roads(still.scene, cars), on_crossings(still.scene, cars)
    assert 0.0 == far.min() < 50.0 < far.max() <= 100.0
    assert (far[crossing > 0] == 0.0).all()


def test_the_outline_of_a_junction_may_cross_itself(still):
    """As that of a junction of an imported town does."""
    network = still.scene.network
    first, last = network.junction_first[:2]
    assert last - first >= 4
    twisted = network.junction_points.copy()
    twisted[[first, first + 1]] = twisted[[first + 1, first]]
    assert not shapely.Polygon(twisted[first:last]).is_valid
    bent = replace(still.scene, network=replace(network, junction_points=twisted))
    far = on_open_roads(bent, all_cars(still))
    assert 0.0 == far.min() < 50.0 < far.max() <= 100.0


def test_all_streets_are_in_the_horizon_view(still, views):
    horizon = next(view for view in views if view.name == "horizon")
    assert horizon.pitch == 0.3
    points = still.scene.network.lane_points - np.array(horizon.position[:2])
    ahead = points @ [np.cos(horizon.yaw), np.sin(horizon.yaw)]
    left = points @ [-np.sin(horizon.yaw), np.cos(horizon.yaw)]
    assert np.all(np.abs(left) < ahead * np.tan(0.5 * horizon.field_of_view))
    depth = still.probe(horizon)[0]
    assert np.isinf(depth[0]).all()
    assert np.isfinite(depth[24:, 32]).all()


def test_a_second_run_replaces_the_first_with_the_same_bytes(few, tmp_path):
    gallery.run(tmp_path, ["citystreet"], WEATHERS[:1])
    before = files(tmp_path)
    assert len(before) == 4
    gallery.run(tmp_path, ["citystreet"], WEATHERS[:1])
    assert files(tmp_path) == before


def test_a_page_of_another_maker_or_any_foreign_file_is_refused_untouched(drawn, tmp_path):
    foreign = tmp_path / "thesis"
    foreign.mkdir()
    (foreign / "index.html").write_text("<h1>My thesis</h1>")
    with pytest.raises(OutputError, match=r"not a gallery: its index\.html was not made by Eyas"):
        gallery.run(foreign)
    (foreign / "index.html").rename(foreign / "chapter1.html")
    with pytest.raises(OutputError, match=r"holds 'chapter1\.html'"):
        gallery.run(foreign)
    assert files(tmp_path) == {
        (foreign / "chapter1.html").relative_to(tmp_path): b"<h1>My thesis</h1>"
    }
    with pytest.raises(OutputError, match="is a file"):
        gallery.run(drawn / gallery.INDEX)


def test_what_an_interrupted_run_has_left_may_be_drawn_over(few, tmp_path, monkeypatch):
    (tmp_path / "citystreet-day").mkdir()
    (tmp_path / "citystreet-day" / "horizon.png").write_bytes(b"")
    (tmp_path / "citystreet-day" / ".overview.png.part").write_bytes(b"")

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(gallery, "contact_sheet", interrupted)
    with pytest.raises(KeyboardInterrupt):
        gallery.run(tmp_path, ["citystreet"], WEATHERS[:1])
    assert not (tmp_path / gallery.INDEX).exists()
    with Image.open(tmp_path / "citystreet-day" / "horizon.png") as picture:
        assert picture.size == (640, 480)


def test_only_what_is_named_is_drawn_and_wrong_names_are_told():
    every = [(name, weather) for name in MAPS.built_in for weather in MAPS.get(name).weathers]
    assert sorted(gallery.conditions([], [])) == sorted(every)
    assert gallery.conditions(["citystreet", "citystreet"], ["day"]) == [("citystreet", "day")]
    with pytest.raises(UnknownNameError, match="did you mean 'citystreet'"):
        gallery.conditions(["citystret"], [])
    with pytest.raises(UnknownNameError, match="did you mean 'foggy'"):
        gallery.conditions([], ["fogy"])


def test_maps_that_lack_a_named_weather_are_left_out_unless_they_are_named(monkeypatch):
    bare = replace(CITYSTREET, name="bare-land", without=tuple(CITYSTREET.weathers[1:]))
    monkeypatch.setattr(gallery.MAPS, "_table", {"citystreet": CITYSTREET, "bare-land": bare})
    assert gallery.conditions([], ["snow"]) == [("citystreet", "snow")]
    assert gallery.conditions([], ["day"]) == [("bare-land", "day"), ("citystreet", "day")]
    with pytest.raises(UnknownNameError, match="on the map 'bare-land'; known: day"):
        gallery.conditions(["bare-land"], ["snow"])


def test_names_on_the_page_cannot_break_it(views):
    odd = PageEntry('<b>"x"', "day", views[:1], [np.zeros((1, 1, 3), np.uint8)])
    assert "<b>" not in page([odd], gallery.SHEET)


def test_the_command_says_in_one_line_what_is_wrong(monkeypatch, capsys, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    arguments = ["eyas", "maps", "gallery", "--out", str(tmp_path)]
    for more, line in [([], "not a gallery"), (["--weather", "fogy"], "world.weather: 'fogy'")]:
        monkeypatch.setattr(sys, "argv", arguments + more)
        with pytest.raises(SystemExit) as caught:
            main()
        said = capsys.readouterr()
        assert (caught.value.code, said.out, len(said.err.splitlines())) == (2, "", 1)
        assert line in said.err
