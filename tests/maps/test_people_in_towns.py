"""People in an imported town: along its pavements and over its crossings, as lights allow."""

import importlib
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely

from eyas.engine.behaviours.config import ExtraConfig
from eyas.engine.behaviours.gap_acceptance import GapAcceptance
from eyas.engine.behaviours.ground import WalkingGround, usable_crossings, walkways
from eyas.engine.behaviours.groups import SampleClock, ScriptedGroup, lasting
from eyas.engine.behaviours.scripted import scripted_table
from eyas.engine.core.errors import SpawnError
from eyas.engine.core.rng import stream
from eyas.engine.sim import scenes
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.crowd import Crowd
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import KINDS, MODELS, habit_of, models_of
from eyas.engine.targets.habit import Behaviour
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.net_file import SumoNet
from eyas.engine.traffic.signals import Aspect, walk_plan
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.maps.commands import info
from eyas.maps.osm import importing

pytestmark = [pytest.mark.sumo, pytest.mark.slow]  # what its tests share takes long to make
NAME = "test-walks"
TEN_MINUTES = SampleClock(6001, 10.0)
TRAFFIC = TrafficConfig(max_vehicles=30)


@pytest.fixture(scope="module")
def writer():
    """The class that writes files of OpenStreetMap."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(Path(__file__).parents[2] / "tools")
        yield importlib.import_module("synthetic_osm").Writer


@pytest.fixture(scope="module")
def maps(tmp_path_factory):
    """The user's folder of maps while this file is tested."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("EYAS_MAPS_DIR", str(tmp_path_factory.mktemp("maps")))
        yield


def streets_of(out) -> None:
    """Two by two blocks round a junction with lights, and a boulevard in the north.

    Crossings are mapped in the middle of a block, as a way over a street, and over both
    carriageways of the boulevard. The eastern street has no pavements, the southern ones of its
    own.
    """
    at = {(i, j): out.node((x, y)) for i, x in enumerate((-120, 0, 110))
          for j, y in enumerate((-100, 0, 100))}  # fmt: skip
    out.tag(at[1, 1], highway="traffic_signals")
    mapped = {"highway": "crossing", "crossing": "marked"}
    middle, over = out.node((-60, 0), **mapped), out.node((60, 0))
    main = {"highway": "primary", "lanes": "2", "sidewalk": "both", "maxspeed": "50"}
    out.way([at[0, 1], middle, at[1, 1], over, at[2, 1]], **main)
    out.way([out.node((60, -12)), over, out.node((60, 12))], highway="footway", footway="crossing")
    for i, tags in enumerate(({"sidewalk": "both"}, {}, {"sidewalk": "no"})):
        nodes = [at[i, 0], out.node((-120 + 120 * i, -50)), at[i, 1], at[i, 2]]
        out.way(nodes, highway="residential", lanes="2", **tags)
    out.way([at[i, 0] for i in range(3)], highway="residential", sidewalk="separate")
    out.way([at[i, 2] for i in range(3)], highway="residential")
    one_way = {**main, "oneway": "yes", "sidewalk": "right"}
    west, east = out.node((-120, 160)), out.node((110, 160))
    out.way([at[0, 2], west], **main)
    out.way([at[2, 2], east], **main)
    out.way([east, *(out.node((x, 165)) for x in (90,)), out.node((0, 165), **mapped),
             out.node((-100, 165)), west], **one_way)  # fmt: skip
    out.way([west, out.node((-100, 154)), out.node((0, 154), **mapped), out.node((90, 154)), east],
            **one_way)  # fmt: skip
    # Its wall leaves little of the pavement.
    out.area(shapely.box(-110, -60, -90, -6), building="apartments")


@pytest.fixture(scope="module")
def scene(writer, maps, tmp_path_factory):
    out, path = writer(), tmp_path_factory.mktemp("osm") / "town.osm"
    streets_of(out)
    path.write_text("\n".join(out.lines((180, 200))), encoding="utf-8")
    importing.run(path, NAME, record=False)
    return load_scene(NAME)


@pytest.fixture(scope="module")
def lights(scene):
    return walk_plan(SumoNet(MAPS.get(NAME).roads(0).finished))


@pytest.fixture(scope="module")
def vehicles(scene):
    motion = load_assets(WorldConfig(map=NAME), TRAFFIC).traffic.motion
    return motion.of(motion.table[: TEN_MINUTES.samples]).sampled()


@pytest.fixture(scope="module")
def ground(scene, lights):
    return WalkingGround(scene, roads=True, lights=lights)


def walked(ground, vehicles, behaviour=Behaviour.CROSSING, count=50) -> np.ndarray:
    lifetimes = lasting(count, TEN_MINUTES.samples)
    who = ScriptedGroup(
        "Pedestrian", 0.81, behaviour, habit_of("Pedestrian"), lifetimes, 0.0, "extras.0.count"
    )
    return scripted_table(ground, who, TEN_MINUTES, stream(1, "towns"), vehicles)


@pytest.fixture(scope="module")
def table(ground, vehicles):
    return walked(ground, vehicles)


def kerbs_of(scene) -> list[shapely.LinearRing]:
    points, first = scene.footways.kerb_points, scene.footways.kerb_first
    return [shapely.LinearRing(points[a:b]) for a, b in pairwise(first)]


def test_crossings_are_those_with_lights_and_those_that_are_mapped(scene):
    lights = usable_crossings(scene)
    assert sum(map(bool, lights)) == 4
    assert len(lights) == 7
    line = "crossings from pavement to pavement: 7, of which 4 have traffic lights"
    assert line in info.describe(NAME, 0)
    middles = scene.footways.crossings.mean(axis=1)
    for place in ((-60, 0), (60, 0), (0, 159.5)):
        assert np.hypot(*(middles - place).T).min() < 1.0, place


def test_a_boulevard_is_crossed_at_once_over_a_raised_island(ground):
    lines = ground.scene.footways.crossings
    line = lines[np.hypot(*(lines.mean(axis=1) - [0, 159.5]).T).argmin()]
    places = line[0] + np.linspace(0.01, 0.99, 60)[:, None] * (line[1] - line[0])
    height = ground.surface.at(places).height
    raised = np.flatnonzero(height > 0.1)
    assert 3 < len(raised) < 40
    assert (np.diff(raised) == 1).all()
    assert (np.diff(np.flatnonzero(height < 0.05)) > 1).sum() == 1


def test_pavements_lead_round_corners_without_a_gap(ground):
    ways = walkways(ground, 0.81, 1.0)
    # Blocks in the west have pavements on all sides; ways there and back meet each corner twice.
    whole = [way for way in ways if len(np.unique(way.corners, axis=0)) == len(way.corners)]
    for x, y in ((-60, -50), (-60, 50)):
        around = [way for way in whole if shapely.contains_xy(shapely.Polygon(way.corners), x, y)]
        inner = [way for way in around if way.length < 600.0]
        assert sorted(way.lane for way in inner) == [0, 1]
        for way in inner:
            points = shapely.line_interpolate_point(way.line, np.arange(0.0, way.length, 0.5))
            under = ground.surface.at(shapely.get_coordinates(points))
            assert under.pavement.all()
            assert under.height.min() > 0.1


def test_streets_have_the_pavements_of_their_tags(ground):
    beside = {"no": (110 + 5.0, -50), "separate": (-60, -100 - 4.5), "usual": (4.5, 50)}
    raised = {tag: bool(ground.surface.at(np.array([place], float)).height[0] > 0.1)
              for tag, place in beside.items()}  # fmt: skip
    assert raised == {"no": False, "separate": True, "usual": True}


def test_cars_hardly_ever_come_over_a_kerb(scene, vehicles):
    """Only those that turn at the end of a street do, or where houses are in the way."""
    shapes = [shapely.Polygon(kerb) for kerb in kerbs_of(scene)]
    within = [shapely.is_ccw(kerb) for kerb in kerbs_of(scene)]
    road = shapely.difference(
        shapely.union_all([one for one, own in zip(shapes, within, strict=True) if own]),
        shapely.union_all([one for one, own in zip(shapes, within, strict=True) if not own]),
    )
    shapely.prepare(road)
    rows = vehicles.table[::20].ravel()  # every two seconds
    length, width, _ = np.array([MODELS[m].size for m in models_of(vehicles.kind[0])]).max(axis=0)
    ahead = KINDS[vehicles.kind[0]].ahead + 0.5 * length * np.array([-1, 0, 1, 1, 0, -1])
    aside = 0.5 * width * np.array([-1, -1, -1, 1, 1, 1])
    cosine, sine = np.cos(rows["yaw"])[:, None], np.sin(rows["yaw"])[:, None]
    x = rows["x"][:, None] + ahead * cosine - aside * sine
    y = rows["y"][:, None] + ahead * sine + aside * cosine
    assert (~shapely.contains_xy(road, x, y)).any(axis=1).mean() < 0.01


def nearest(table, vehicles) -> float:
    """The least distance of anyone to the box of a vehicle [m]."""
    least = np.inf
    for kind, one in zip(vehicles.kind.tolist(), vehicles.table.T, strict=True):
        length, width, _ = np.array([MODELS[m].size for m in models_of(kind)]).max(axis=0)
        cosine, sine = np.cos(one["yaw"])[:, None], np.sin(one["yaw"])[:, None]
        east = table["x"] - one["x"][:, None] - KINDS[kind].ahead * cosine
        north = table["y"] - one["y"][:, None] - KINDS[kind].ahead * sine
        ahead = np.abs(east * cosine + north * sine) - length / 2
        aside = np.abs(north * cosine - east * sine) - width / 2
        away = np.hypot(np.maximum(ahead, 0.0), np.maximum(aside, 0.0))
        least = min(least, float(away[one["present"] > 0.0].min()))
    return least


def test_in_ten_minutes_nobody_comes_within_a_metre_of_a_car(ground, vehicles, table):
    assert nearest(table, vehicles) > 1.0
    assert nearest(walked(ground, vehicles, Behaviour.PAVEMENT), vehicles) > 1.0


def crossed(scene, table) -> list[tuple[int, int, int, int]]:
    """Crossing, walker, and first and last sample of each time on the road."""
    lines, found = shapely.linestrings(scene.footways.crossings), []
    heading = scene.footways.crossings[:, 1] - scene.footways.crossings[:, 0]
    heading /= np.hypot(*heading.T)[:, None]
    on_road = (table["z"] < 0.05).astype(int)
    for first, who in np.argwhere(np.diff(on_road, axis=0) == 1).tolist():
        last = first + 1 + int(np.argmin(np.append(on_road[first + 1 :, who], 0))) - 1
        way = np.array([table[axis][last, who] - table[axis][first, who] for axis in "xy"])
        point = shapely.Point(table["x"][first + 1, who], table["y"][first + 1, who])
        along = np.abs(heading @ way) > 0.9 * np.hypot(*way)
        away = np.where(along, shapely.distance(lines, point), np.inf)
        assert away.min() < 1.6  # there is paint so far from its middle
        found.append((int(away.argmin()), who, first + 1, last))
    return found


def broken(scene, lights, table) -> tuple[int, int, int]:
    """How often roads were entered at lights, how often not on green, how often until red."""
    entered = late = caught = 0
    for crossing, _, first, last in crossed(scene, table):
        if name := scene.footways.lights[crossing]:
            shown = lights.only(lights.edges.index(name)).at(np.arange(first, last + 1) / 10.0)
            entered += 1
            late += shown[0, 0] != Aspect.GREEN
            caught += bool((shown == Aspect.RED).any())
    return entered, late, caught


def test_many_cross_and_at_lights_on_green_only(scene, lights, table):
    times = crossed(scene, table)
    assert len(times) > 60
    assert len({who for _, who, _, _ in times}) > 30
    assert len({crossing for crossing, _, _, _ in times}) == 7
    entered, late, caught = broken(scene, lights, table)
    assert entered > 15
    assert (late, caught) == (0, 0)


def test_who_does_not_look_at_lights_would_be_noticed(scene, lights, vehicles, monkeypatch):
    monkeypatch.setattr(GapAcceptance, "_shown", lambda *_: True)
    blind = walked(WalkingGround(scene, roads=True, lights=lights), vehicles)
    entered, late, caught = broken(scene, lights, blind)
    assert late > 0.2 * entered
    assert caught > 0


def test_paint_of_crossings_lies_apart_from_lines_and_pavements(scene):
    kinds = scene.object_class[scene.static_object]
    corners = scene.static.positions[scene.static.triangles].astype(np.float64)
    plan = shapely.polygons(corners[..., :2])
    level = np.ptp(corners[..., 2], axis=1) < 1e-6
    paint = plan[(kinds == ObjectClass.MARKING) & level]
    raised = plan[(kinds == ObjectClass.PAVEMENT) & level & (corners[:, 0, 2] > 0.1)]
    assert shapely.area(shapely.intersection(shapely.union_all(paint), shapely.union_all(raised))) \
        < 0.05  # fmt: skip
    assert shapely.area(paint).sum() == pytest.approx(
        shapely.area(shapely.union_all(paint)), rel=0.01
    )


def test_towns_without_pavements_or_crossings_say_so_in_a_line(writer, maps, tmp_path):
    out, path = writer(), tmp_path / "bare.osm"
    ends = [out.node((x, 0)) for x in (-100, 0, 100)]
    out.way(ends, highway="residential", sidewalk="no")
    path.write_text("\n".join(out.lines((120, 60))), encoding="utf-8")
    importing.run(path, "test-bare", record=False)
    bare = load_scene("test-bare")
    assert usable_crossings(bare) == []
    for behaviour in (Behaviour.PAVEMENT, Behaviour.CROSSING):
        with pytest.raises(SpawnError, match=rf"'{behaviour.value}': 'test-bare' has no pavement"):
            walked(WalkingGround(bare, roads=True), None, behaviour)
    path.write_text(path.read_text().replace('v="no"', 'v="both"'), encoding="utf-8")
    importing.run(path, "test-bare", record=False, overwrite=True)
    for kept in vars(scenes).values():
        if hasattr(kept, "cache_clear"):
            kept.cache_clear()
    with pytest.raises(SpawnError, match="'test-bare' has no crossing between pavements;"):
        walked(WalkingGround(load_scene("test-bare"), roads=True), None)


def test_extras_walk_with_the_lights_of_the_map(scene, lights):
    people = ExtraConfig(count=30, behaviour=Behaviour.CROSSING)
    motion = load_assets(WorldConfig(map=NAME), TRAFFIC, crowd=Crowd(extras=(people,))).traffic
    entered, late, caught = broken(scene, lights, motion.motion.sampled().table[:, -30:])
    assert entered > 15
    assert (late, caught) == (0, 0)
