import math

import numpy as np
import pytest
import shapely
import shapely.ops

from eyas.engine.behaviours import ground
from eyas.engine.behaviours.ground import WalkingGround
from eyas.engine.behaviours.scripted import STROLL, waiting_spots
from eyas.engine.core.errors import SpawnError
from eyas.engine.core.variation import Mirrored, Uniform
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.motion import ActorState, SampledMotion
from eyas.engine.state.scene import ObjectClass
from eyas.engine.state.terrain import reliefs
from eyas.engine.targets.catalogue import MODELS
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour
from eyas.engine.traffic.replay import Replay
from eyas.engine.world.roads.areas import road_area, streets

from .conftest import CLOCK, group, table_of
from .habits import HABITS

STOPPED = {kind for kind, habit in HABITS.items() if habit.behaviour is Behaviour.STOP}


def points_of(table) -> np.ndarray:
    here = table[table["present"] > 0.0]
    return np.column_stack([here["x"], here["y"]]).astype(np.float64)


def solids_at_feet(scene) -> shapely.STRtree:
    """The colliders of a map that begin on the ground, without the code under test."""
    solids, first = scene.colliders, scene.colliders.prism_first
    low = solids.prism_bottom < reliefs(scene.terrain, solids.prism_points[first[:-1]]) + 1.0
    prisms = [
        shapely.Polygon(solids.prism_points[first[i] : first[i + 1]]) for i in np.flatnonzero(low)
    ]
    trunks = shapely.buffer(shapely.points(solids.cylinder_centre), solids.cylinder_radius)
    return shapely.STRtree([*prisms, *trunks])


def test_every_object_of_the_original_has_habits():
    assert set(HABITS) == {name.value for name in TargetName} - {"SUMO_VEHICLE", "Quadrotor"}


def test_the_catalogue_tells_the_speeds_of_the_habits():
    speeds = {model.kind: model.speed for model in MODELS if model.kind in HABITS}
    assert speeds == {kind: habit.speed for kind, habit in HABITS.items()}


@pytest.mark.parametrize("place", ["city", "hills"])
@pytest.mark.parametrize("kind", ["Pedestrian", "BB-8", "Create"])
def test_nobody_goes_through_a_solid_or_water(request, place, kind):
    ground = request.getfixturevalue(place)
    points = shapely.points(points_of(table_of(ground, group(kind))))
    assert not len(solids_at_feet(ground.scene).query(points, predicate="intersects")[0])
    kinds = ground.scene.object_class[ground.scene.static_object]
    wet = ground.scene.static.triangles[kinds == ObjectClass.WATER]
    if len(wet):
        ponds = shapely.STRtree(shapely.polygons(ground.scene.static.positions[wet][..., :2]))
        assert not len(ponds.query(points, predicate="intersects")[0])


def test_everyone_stands_on_the_upper_side_of_the_ground(hills):
    table = table_of(hills, group("Pedestrian", count=30, offset=Mirrored(mirrored=(30.0, 90.0))))
    here = table[table["present"] > 0.0]
    points = points_of(table)
    relief = reliefs(hills.scene.terrain, points)
    assert np.abs(here["z"] - relief).max() < 0.7
    assert np.ptp(here["z"]) > 1.0  # there are hills
    steep = np.abs(np.tan(here["slope"]))
    assert 0.02 < steep.max() < 0.8


def test_samples_tell_how_their_places_change(hills):
    wide = Mirrored(mirrored=(30.0, 90.0))
    table = table_of(hills, group("Pedestrian", count=30, offset=wide))
    assert (table["present"] > 0.0).all()
    for place, change in (("x", "velocity_x"), ("y", "velocity_y"), ("z", "velocity_z"),
                          ("yaw", "yaw_rate")):  # fmt: skip
        went = 0.5 * CLOCK.rate * (table[place][2:].astype(float) - table[place][:-2])
        told = table[change][1:-1].astype(float)
        assert np.corrcoef(went.ravel(), told.ravel())[0, 1] > 0.95, place
        assert np.quantile(np.abs(went - told), 0.9) < 0.01, place
    speed, rise = np.hypot(table["velocity_x"], table["velocity_y"]), np.tan(table["slope"])
    climbing = (speed > 1.0) & (np.abs(rise) > 0.05)
    off = np.abs(rise * speed - table["velocity_z"])[climbing]
    assert np.median(off) < 0.07 < 0.1 < np.median(np.abs(table["velocity_z"][climbing]))


def test_pavements_are_higher_than_roads_and_lawns_lower(city):
    rows = table_of(city, group("Pedestrian", behaviour=Behaviour.PAVEMENT))
    assert np.median(rows["z"]) == pytest.approx(0.15)
    wide = table_of(city, group("Pedestrian", count=20, offset=Mirrored(mirrored=(5.0, 20.0))))
    assert {-0.1, 0.15} <= set(np.round(wide["z"].astype(float), 2).ravel().tolist())


@pytest.mark.parametrize("kind", sorted(HABITS))
def test_each_moves_at_its_speed_and_turns_no_faster_than_it_can(city_tables, kind):
    table, habit = city_tables[kind], HABITS[kind]
    speed = np.hypot(table["velocity_x"], table["velocity_y"])
    assert speed.max() <= habit.speed * 1.001
    moving = speed > 0.0
    assert np.median(speed[moving]) == pytest.approx(habit.speed, rel=0.02)
    assert speed[0].mean() > 0.7 * habit.speed
    step = np.hypot(*(np.diff(table[axis].astype(np.float64), axis=0) for axis in "xy"))
    assert step.max() <= habit.speed / CLOCK.rate + 1e-4
    assert np.abs(np.diff(table["yaw"], axis=0)).max() <= habit.yaw_rate / CLOCK.rate + 1e-4
    gone = np.diff(table["travelled"], axis=0)
    both = moving[1:] & moving[:-1]
    assert gone[both].mean() == pytest.approx(step[both].mean(), rel=0.02)
    assert ((speed[-1] == 0.0).all()) == (kind in STOPPED and time_to_stop(kind) < 60.0)


def time_to_stop(kind: str) -> float:
    habit = HABITS[kind]
    return (habit.distance + abs(habit.turn) * habit.radius) / habit.speed + 1.0


def test_a_weave_swings(city_tables):
    yaw = city_tables["BB-8"]["yaw"].astype(np.float64)
    assert np.ptp(yaw, axis=0).min() > 2.0


def test_the_pose_between_samples_is_the_same_alone_and_among_other_times(city_tables):
    """Bit for bit: nothing is stepped."""
    table = city_tables["Pedestrian"]
    replay = Replay(SampledMotion(table, np.zeros(table.shape[1], np.int32), CLOCK.rate).packed())
    times = np.linspace(0.0, 59.0, 300)
    every, one = ActorState.create(300, 8), ActorState.create(1, 8)
    replay.at(times, every)
    for k in (299, 0, 150):
        replay.at(times[k : k + 1], one)
        assert all(np.array_equal(a[k], b[0]) for a, b in zip(every, one, strict=True))


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(city, city_tables):
    again = table_of(city, group("Create"))
    assert again.tobytes() == city_tables["Create"].tobytes()
    assert table_of(city, group("Create"), seed=1).tobytes() != again.tobytes()


def from_middle(ground, points) -> np.ndarray:
    """Distance of points to the nearest middle of a road [m]."""
    middles = shapely.MultiLineString([street.left for street in streets(ground.scene.network)])
    return shapely.distance(shapely.points(points), middles)


def test_offsets_are_perpendicular_to_the_road_and_on_the_asked_side(city):
    for offset in (2.0, -2.0):
        starts = points_of(table_of(city, group("Sojourner", count=40, offset=offset))[:1])
        assert np.median(from_middle(city, starts)) == pytest.approx(2.0, abs=0.05)
    mirrored = Mirrored(mirrored=(1.0, 3.0))
    starts = points_of(table_of(city, group("Sojourner", count=40, offset=mirrored))[:1])
    away = from_middle(city, starts)
    assert 0.9 < np.percentile(away, 10) < np.percentile(away, 90) < 3.1


@pytest.mark.parametrize(
    ("offset", "least", "most"),
    [
        (2.0, 2.0, 2.0),
        (-3.0, -3.0, -3.0),
        (Uniform(uniform=(1.0, 4.0)), 1.0, 4.0),
        (Mirrored(mirrored=(2.0, 4.0)), -4.0, 4.0),
    ],
)
def test_an_offset_is_to_the_left_of_its_road(city, monkeypatch, offset, least, most):
    road = max(streets(city.scene.network), key=lambda road: shapely.LineString(road.left).length)
    monkeypatch.setattr(ground, "streets", lambda _network: [road])
    roadside = ground.Roadside(city.scene.network, city.obstacles)
    points = roadside.sample(200, offset, 0.1, np.random.default_rng(0), "objects.max_count")
    line = shapely.LineString(road.left)
    left = line.buffer(5.0, single_sided=True)
    away = shapely.distance(shapely.points(points), line)
    aside = np.where(shapely.intersects(left, shapely.points(points)), away, -away)
    assert (aside.min(), aside.max()) == pytest.approx((least, most), abs=0.25)
    if isinstance(offset, Mirrored):
        assert (np.abs(aside) > 1.9).all()


def test_where_cars_drive_nobody_is_on_the_road():
    ground = WalkingGround(load_scene("citystreet"), roads=True)
    for behaviour in (None, Behaviour.PAVEMENT):
        table = table_of(ground, group("Pedestrian", behaviour=behaviour))
        lanes = ground.scene.network.lane_points
        points = points_of(table[::10])
        away = np.linalg.norm(points[:, None] - lanes, axis=2).min()
        assert away > 0.6


def test_strollers_walk_on_pavements_only(city):
    table = table_of(city, group("Pedestrian", count=12, behaviour=Behaviour.PAVEMENT))
    assert city.surface.at(points_of(table)).pavement.mean() > 0.95
    speed = np.hypot(table["velocity_x"], table["velocity_y"]).max(axis=0)
    assert ((STROLL[0] <= speed) & (speed <= STROLL[1])).all()


def test_those_who_go_the_same_way_keep_apart(city):
    """Two may meet, but none walks in another all the time."""
    table = table_of(city, group("Pedestrian", count=100, behaviour=Behaviour.PAVEMENT))
    points = np.stack([table["x"], table["y"]], axis=-1)[:: round(CLOCK.rate)]
    first, second = np.triu_indices(100, 1)
    near = np.linalg.norm(points[:, first] - points[:, second], axis=-1) < 0.5
    assert near.mean(axis=0).max() < 0.5
    assert near.sum(axis=1).mean() < 1.5  # pairs at a time


def test_a_map_without_pavements_says_so(hills):
    with pytest.raises(SpawnError, match=r"pavement.*'village' has no pavement"):
        table_of(hills, group("Pedestrian", behaviour=Behaviour.PAVEMENT))


def test_a_map_that_is_full_says_so(city):
    with pytest.raises(SpawnError, match=r"^objects\.max_count: .* has only 0 of the 4 places"):
        table_of(city, group("Mantis", count=4, breadth=400.0))


def test_nobody_is_placed_beyond_the_map(city):
    table = table_of(city, group("Pedestrian", count=20, offset=250.0))
    assert (np.abs(points_of(table)) < np.array(city.scene.size) / 2).all()
    beyond = Mirrored(mirrored=(2000.0, 3000.0))
    with pytest.raises(SpawnError, match="-3000 to 3000 m from their middle"):
        table_of(city, group("Pedestrian", count=2000, offset=beyond))


def test_the_ground_under_a_point_does_not_depend_on_the_others(city):
    rng = np.random.default_rng(0)
    points = rng.uniform(-300.0, 300.0, (200, 2))
    points = np.concatenate([points, points[:50] + 1e-9])
    alone = [city.surface.at(point[None]) for point in points]
    together = city.surface.at(points)
    assert np.array_equal(together.height, np.concatenate([one.height for one in alone]))
    assert np.array_equal(together.pavement, np.concatenate([one.pavement for one in alone]))
    assert together.pavement.any()
    assert len(set(together.height)) > 1


def test_a_full_turn_is_no_jump(city_tables):
    for table in city_tables.values():
        assert np.abs(np.diff(table["yaw"], axis=0)).max() < math.pi / 2


def test_who_walks_along_a_verge_keeps_near_the_road_and_off_it(hills):
    rows = table_of(hills, group("Pedestrian", behaviour=Behaviour.VERGE))
    roads = road_area(hills.scene.network)
    away = shapely.distance(roads, shapely.points(rows["x"][::200], rows["y"][::200]))
    assert 0.7 < away.min() < 1.1
    assert np.median(away) < 2.0
    assert away.max() < 5.5


def test_who_rides_keeps_by_the_kerb_with_the_traffic(city):
    rows = table_of(city, group("Cyclist", breadth=0.72, behaviour=Behaviour.RIDE))[::50]
    road = road_area(city.scene.network)
    places = shapely.points(rows["x"], rows["y"])
    away = shapely.distance(road, places)
    assert away.min() > 0.35
    assert np.median(away) < 0.6
    near = shapely.get_coordinates(shapely.ops.nearest_points(road, places[0, 0])[0])[0]
    aside = near - [rows["x"][0, 0], rows["y"][0, 0]]
    left = np.array([-np.sin(rows["yaw"][0, 0]), np.cos(rows["yaw"][0, 0])])
    assert aside @ left > 0.0  # the road is on the left of those who drive on the right
    speed = np.hypot(rows["velocity_x"], rows["velocity_y"])
    assert 2.0 < speed.mean() < 5.0


def test_people_wait_at_bus_stops_and_cafes(city):
    rows = table_of(city, group("Pedestrian", count=30, behaviour=Behaviour.WAIT))
    assert not np.ptp(rows["x"], axis=0).any()
    assert not rows["velocity_x"].any()
    assert len({*zip(rows["x"][0].tolist(), rows["y"][0].tolist(), strict=True)}) == 30
    fixtures = city.scene.fixtures
    wanted = [name.startswith(("shelter", "cafe")) for name in fixtures.names]
    feet = fixtures.pose[np.array(wanted)[fixtures.prototype], :2, 3]
    away = np.hypot(rows["x"][0][:, None] - feet[:, 0], rows["y"][0][:, None] - feet[:, 1])
    assert away.min(axis=1).max() < 2.6
    with pytest.raises(SpawnError, match=r"'wait': 'citystreet' has [0-9]+ places at bus stops"):
        waiting_spots(city.scene, 1000, np.random.default_rng(0))
