"""Those who cross roads: on the painted crossings, when no recorded vehicle comes."""

import numpy as np
import pytest

from eyas.engine.behaviours.gap_acceptance import GapAcceptance
from eyas.engine.behaviours.ground import WalkingGround
from eyas.engine.behaviours.groups import SampleClock, lasting
from eyas.engine.behaviours.scripted import scripted_table
from eyas.engine.core.errors import ConfigError, SpawnError
from eyas.engine.core.rng import stream
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.scenes import load_scene
from eyas.engine.sim.worlds import together
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, models_of, sections_of
from eyas.engine.targets.habit import Behaviour
from eyas.engine.targets.kind import Section
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import CANONICAL_MIX
from eyas.engine.traffic.signals import Aspect, SignalPlan
from eyas.engine.traffic.trailer import BUMPER_AHEAD, TAIL_BEHIND, folded_by
from eyas.lanes import interpreted

from .conftest import group
from .habits import HABITS

FIVE_MINUTES = SampleClock(3001, 10.0)


@pytest.fixture(scope="module")
def ground():
    return WalkingGround(load_scene("citystreet"), roads=True)


def driven(traffic=None) -> SampledMotion:
    config = SimConfig(traffic=traffic or TrafficConfig())
    motion = load_assets(config.world, config.traffic).traffic.motion
    return motion.of(motion.table[: FIVE_MINUTES.samples]).sampled()


@pytest.fixture(scope="module")
def vehicles() -> SampledMotion:
    return driven()


def walked(ground, vehicles, count=24) -> np.ndarray:
    who = group("Pedestrian", behaviour=Behaviour.CROSSING)
    who = who._replace(lifetimes=lasting(count, FIVE_MINUTES.samples))
    return scripted_table(ground, who, FIVE_MINUTES, stream(1, "crossing"), vehicles)


@pytest.fixture(scope="module")
def table(ground, vehicles):
    return walked(ground, vehicles)


def nearest(table, vehicles) -> float:
    """The least distance of anyone to the box of a vehicle, or to its truck or trailer [m]."""
    least = np.inf
    for kind, one in zip(vehicles.kind.tolist(), vehicles.table.T, strict=True):
        sizes = np.array([MODELS[m].size for m in models_of(kind)]).max(axis=0)
        whole = Section("", 0.0, tuple(sizes), 0, ())
        for section in sections_of(models_of(kind).start) or (whole,):
            x, y, c, s = interpreted(folded_by)(
                np.sin(one["hitch"]), np.cos(one["hitch"]), section.towed
            )
            cosine, sine = np.cos(one["yaw"]), np.sin(one["yaw"])
            x = x + KINDS[kind].ahead + section.ahead * c
            y = y + section.ahead * s
            east = table["x"] - (one["x"] + cosine * x - sine * y)[:, None]
            north = table["y"] - (one["y"] + sine * x + cosine * y)[:, None]
            cosine, sine = (cosine * c - sine * s)[:, None], (sine * c + cosine * s)[:, None]
            ahead = np.abs(east * cosine + north * sine) - section.size[0] / 2
            aside = np.abs(north * cosine - east * sine) - section.size[1] / 2
            away = np.hypot(np.maximum(ahead, 0.0), np.maximum(aside, 0.0))
            least = min(least, float(away[one["present"] > 0.0].min()))
    return least


def test_no_car_ever_comes_within_a_metre_of_a_walker(table, vehicles):
    assert nearest(table, vehicles) > 1.0


def test_who_does_not_look_is_run_over(ground, vehicles):
    """So the test above would see it."""
    assert nearest(walked(ground, None), vehicles) < 0.2


def on_road(table) -> np.ndarray:
    return table["z"] < 0.05  # pavements are 15 cm high


@pytest.mark.slow
def test_nor_do_buses_or_trucks_or_their_trailers_come_near_anyone_on_the_road(ground):
    mixed = driven(TrafficConfig(vehicle_type=CANONICAL_MIX))
    for looks, safe in ((mixed, True), (None, False)):
        table = walked(ground, looks)
        table["x"][~on_road(table)] = np.inf
        for name in ("bus", "truck", "trailer"):
            own = mixed.kind == kind_index(name)
            least = nearest(table, mixed._replace(table=mixed.table[:, own], kind=mixed.kind[own]))
            assert (least > 1.0) == safe


def test_many_cross_and_some_wait_at_the_kerb(table):
    crossing = on_road(table)
    begins = np.diff(crossing.astype(int), axis=0) == 1
    assert begins.sum() > 40
    assert (begins.sum(axis=0) > 0).mean() > 0.7
    assert 0.03 < crossing.mean() < 0.2
    speed = np.hypot(table["velocity_x"], table["velocity_y"])
    standing = speed < 0.01
    assert 0.02 < standing.mean() < 0.4
    assert not (standing & crossing)[1:].any()  # nobody stops on the road


def test_roads_are_crossed_on_paint_only(ground, table):
    scene = ground.scene
    kinds = scene.object_class[scene.static_object]
    corners = scene.static.positions[scene.static.triangles[kinds == ObjectClass.MARKING]]
    paint = corners[..., :2].mean(axis=1)
    rows = table[on_road(table)]
    places = np.column_stack([rows["x"], rows["y"]])[::20]
    # Bars are 1.1 m apart and 5.6 m long; other paint is a line here and there.
    near = np.array([(np.linalg.norm(paint - place, axis=1) < 4.0).sum() for place in places])
    assert np.median(near) >= 8
    assert (near >= 4).mean() > 0.98


def test_their_motion_is_continuous_and_the_same_again(ground, vehicles, table):
    habit = HABITS["Pedestrian"]
    steps = [np.diff(table[axis].astype(np.float64), axis=0) for axis in "xy"]
    step, gone = np.hypot(*steps), np.diff(table["travelled"].astype(np.float64), axis=0)
    assert step.max() < 0.18  # at most 1.7 m/s
    assert gone.min() > -1e-3
    assert gone.sum() == pytest.approx(step.sum(), rel=0.01)
    assert np.abs(np.diff(table["yaw"], axis=0)).max() <= habit.yaw_rate / 10.0 + 1e-4
    assert walked(ground, vehicles).tobytes() == table.tobytes()


def passing(x: np.ndarray, y: float = 0.0) -> SampledMotion:
    """One car along the x axis, ten samples a second."""
    table = np.zeros((len(x), 1), SAMPLE)
    table["x"][:, 0], table["y"], table["present"] = x, y, 1.0
    return SampledMotion(table, np.array([kind_index("passenger")], np.int32), 10.0)


LINE = np.array([[0.0, -5.0], [0.0, 5.0]])


def test_a_gap_is_long_enough_for_who_crosses():
    time = np.arange(601) / 10.0
    # It passes the line after 20 s, with 10 m/s.
    gaps = GapAcceptance(passing(10.0 * (time - 20.0)), 601, 10.0)
    assert gaps.first(LINE, 3.0, 7.0) == 3.0
    assert 20.4 < gaps.first(LINE, 15.0, 7.0) < 22.0
    assert gaps.first(LINE, 30.0, 7.0) == 30.0
    # Who leaves at 12 s is across at 19 s, but that is too narrow an escape.
    assert gaps.first(LINE, 12.0, 7.0) > 20.0
    assert GapAcceptance(None, 601, 10.0).first(LINE, 15.02, 7.0) == 15.1


def test_nobody_waits_where_a_vehicle_drives_over_the_kerb():
    way, begin = 10.0 * (np.arange(601) / 10.0 - 20.0), LINE[0, 1]
    half = max(MODELS[model].size[1] for model in models_of(kind_index("passenger"))) / 2
    for y, waits in ((0.0, True), (begin - half - 0.4, True), (begin - half, False)):
        gaps = GapAcceptance(passing(way, y), 601, 10.0)
        begins = gaps.first(LINE, 18.0, 7.0)
        assert (begins is not None and begins > 20.0) == waits
        assert gaps.first(LINE, 3.0, 7.0) == 3.0  # it comes later


def test_nobody_crosses_behind_a_folded_truck_where_its_kingpin_is():
    """Its kingpin is at the origin, its bumper east of it, the tail of its trailer south of it."""
    yaw = np.arctan2(TAIL_BEHIND, BUMPER_AHEAD)
    table = np.zeros((2001, 1), SAMPLE)
    table["x"], table["y"] = 0.5 * BUMPER_AHEAD + np.cos(yaw), -0.5 * TAIL_BEHIND + np.sin(yaw)
    table["yaw"], table["hitch"], table["present"] = yaw, 0.5 * np.pi, 1.0
    kind = np.array([kind_index("trailer")], np.int32)
    gaps = GapAcceptance(SampledMotion(table, kind, 10.0), 2001, 10.0)

    def free(x, y):
        return gaps.first(np.array([[x, y], [x + 0.5, y + 0.5]]), 3.0, 7.0) is not None

    assert not free(-2.5, 2.0)  # 1.6 m from the corner of the truck, 5 m from the chord
    assert not free(4.0, 2.8)
    assert free(-5.0, 2.0)
    assert free(4.0, -4.2)  # 1.6 m from the chord, 2.8 m from truck and trailer


def test_nobody_waits_longer_than_a_minute():
    gaps = GapAcceptance(passing(np.zeros(2001)), 2001, 10.0)
    assert gaps.first(LINE, 3.0, 7.0) is None


def test_one_steps_off_on_green_and_has_crossed_before_red():
    shown = np.array([[Aspect.GREEN, Aspect.AMBER, Aspect.RED]], np.int64)
    end, cycle, offset = np.array([[10.0, 14.0, 30.0]]), np.array([30.0]), np.zeros(1)
    gaps = GapAcceptance(None, 2001, 10.0, SignalPlan(("walk",), cycle, offset, end, shown))
    assert gaps.first(LINE, 3.0, 7.0, "walk", 1.0) == 3.0
    assert gaps.first(LINE, 7.5, 7.0, "walk", 1.0) == 30.0  # red would come too early
    assert gaps.first(LINE, 9.5, 3.0, "walk", 1.0) == 30.0  # the kerb is reached too late
    assert gaps.first(LINE, 14.0, 7.0, "walk", 1.0) == 30.0
    assert gaps.first(LINE, 14.0, 7.0) == 14.0
    assert gaps.first(LINE, 3.0, 15.0, "walk", 1.0) is None
    assert gaps.first(LINE, 3.0, 7.0, "a light without a program", 1.0) is None


@pytest.mark.slow
def test_maps_without_crossings_and_live_traffic_say_so():
    hills = WalkingGround(load_scene("village"), roads=False)
    with pytest.raises(SpawnError, match=r"'crossing': 'village' has no pavement"):
        walked(hills, None)
    people = {"kind": "Pedestrian", "count": 3, "behaviour": "crossing"}
    config = SimConfig(extras=[people], world={"map": "village"})
    with pytest.raises(SpawnError, match=r"^extras\.0\.behaviour: 'crossing': 'village' has no pa"):
        build_simulation(config, together(1))
    config = SimConfig(custom={"body": "Mantis", "behaviour": "crossing"})
    with pytest.raises(SpawnError, match=r"^custom\.behaviour: .* wide enough for 'Mantis';"):
        build_simulation(config, together(1))
    config = SimConfig(extras=[people], traffic={"source": "live"})
    with pytest.raises(ConfigError, match=r"^extras\.0\.behaviour: 'crossing' is not allowed with"):
        build_simulation(config, together(1))
