"""The long and hard protocols: ten minutes, roofs of all lengths, a mission in stages."""

import runpy
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eyas.benchmark.episodes import first_fitting, loss_sites
from eyas.benchmark.episodes.episode import FIRST_SEED, EpisodeSpec, Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.episodes.from_above import FromAbove
from eyas.benchmark.episodes.loss_sites import kind_of, losses_at_sites
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.flight.meter import inside_things
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.plan.plan import EvaluationPlan, batches
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.protocols.crowd import CoatScenario
from eyas.benchmark.protocols.mission import STAGES, MissionScenario
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.benchmark.statistics.intervals import clusters_of, rate_of
from eyas.benchmark.statistics.table_rows import clusters_in
from eyas.engine.core.rng import TEST_SEEDS
from eyas.engine.policies.policy import COME_BACK
from eyas.engine.sim.cover import cover_of
from eyas.engine.sim.scenes import load_network, load_scene
from eyas.engine.traffic.library import TEST_DURATION
from eyas.engine.world.maps import MAPS

DRAW = runpy.run_path(Path(__file__).parents[2] / "tools" / "draw_towns.py")

LONG_TEN, WIDE, MISSION, COAT = map(PROTOCOLS.get, ("long-10", "recover-wide", "mission", "coat"))


def test_ten_minutes_have_24_conditions_and_fit_into_the_recordings():
    plan = EvaluationPlan(policy="hover", protocol="long-10")
    assert (len(plan.maps), len(plan.weathers), plan.count) == (6, 4, 96)
    assert plan.rules.steps * plan.rules.period == pytest.approx(588.8)
    assert plan.rules.steps * plan.rules.period < TEST_DURATION
    assert "--weather" not in plan.command
    one = EvaluationPlan(policy="hover", protocol="long-10", weathers=("day",))
    assert one.count == 24
    assert "--weather day" in one.command
    assert EvaluationPlan(policy="hover").weathers == ("day",)


@pytest.mark.parametrize("name", [name for name in PROTOCOLS.names() if name != "paper"])
def test_all_but_two_fly_in_traffic_that_is_kept_for_tests(name):
    protocol = PROTOCOLS.get(name)
    length = protocol.settings.done.total_steps * 0.002
    assert length == pytest.approx(protocol.steps * protocol.period)  # else no step ends a flight
    seeds = protocol.recordings
    drawn = name in ("standard", "unseen", "corrupted")  # their choosers name the recordings
    assert drawn or (seeds and min(seeds) >= TEST_SEEDS)


def test_policies_act_as_often_as_they_were_made_to_whatever_the_control_step():
    short = LONG_TEN.changed({"done": {"total_steps": 480}})
    policy = open_policy("sighted", {"action_repeat": 8})
    spec = EpisodeSpec(Place("citystreet", "day", "SUMO_VEHICLE"), 0.0, 1, short.recordings[0])
    flight = BatchFlight([spec], short, policy, delay_from("0"))
    assert [len(ended) for ended in flight.fly()] == [1]
    assert len(flight.answers) == 480 // 32  # 8 steps of 8 ms are 32 physics steps


def test_a_rate_is_of_all_time_and_its_interval_holds_it():
    rng = np.random.default_rng(1)
    held = 0
    for _ in range(400):
        hours = rng.uniform(0.05, 0.2, 60)
        found = rate_of(rng.poisson(12.0 * hours), hours, clusters_of(range(60), [0] * 60))
        assert found.interval is not None
        held += found.interval.low <= 12.0 <= found.interval.high
    assert 0.92 <= held / 400 <= 0.98
    assert rate_of([1, 0], [0.1, 0.3], clusters_of([0, 1], [0, 0])).mean == pytest.approx(2.5)


def test_one_site_is_one_observation():
    class Record:
        def __init__(self, seed, variant, map_name="a"):
            self.seed, self.variant, self.map, self.direction = seed, variant, map_name, 0.0

    records = [Record(1, "turn,-25m@7"), Record(2, "junction,60m-@7"), Record(3, "turn,-25m@8")]
    assert clusters_in(records).count == 2
    assert clusters_in([*records, Record(4, "turn,-25m@7", "b")]).count == 3
    assert clusters_in([Record(1, "covered-2s"), Record(1, "covered-5s")]).count == 1
    assert kind_of("turn,25-60m@412") == ("turn", "25-60m")


def test_losses_begin_below_a_thing_and_end_far_away(monkeypatch):
    place = Place("village", "day", "SUMO_VEHICLE")
    episodes = [EpisodeSpec(place, 0.0, seed, TEST_SEEDS + 1) for seed in range(3)]
    looks = WIDE.settings.done.total_steps // 128
    shares = np.ones((3, looks))
    shares[0, 40:60] = shares[2, 40:60] = 0.0
    shares[1, 40:42] = 0.0  # too short
    places = np.zeros((3, looks, 2))
    places[:, :, 0] = np.arange(looks)
    places[2] = 0.0  # it comes out where it vanished
    monkeypatch.setattr(loss_sites, "seen_from_above", lambda *_: FromAbove(shares, places))
    monkeypatch.setattr(loss_sites, "_label", lambda path, *_: f"straight,-25m@{len(path)}")
    assert [len(own) for own in losses_at_sites(episodes, WIDE)] == [1, 0, 0]


@pytest.mark.slow
def test_roofs_have_many_lengths_over_unchanged_roads():
    name = "eyas.maps.covered:VILLAGE"
    assert load_network(name, 0) is not None
    assert MAPS.get(name).roads(0) == MAPS.get("village").roads(0)
    roofed, plain = load_scene(name, 0), load_scene("village", 0)
    assert len(roofed.object_class) > len(plain.object_class)
    lengths = [last - first for _, first, last in cover_of(name, 0)]
    usual = [last - first for _, first, last in cover_of("village", 0)]
    assert max(usual) < 45.0 < 100.0 < max(lengths)
    assert min(lengths) < 20.0
    low = roofed.colliders.prism_bottom[len(plain.colliders.prism_bottom) :]
    assert (low > roofed.terrain.floor + 6.0).all()


def test_towns_are_fifty_seeds_of_five_kinds_and_part_of_the_hash():
    names = [name.removeprefix("eyas.maps.covered:").split(":") for name in WIDE.drawn]
    assert WIDE.maps == WIDE.drawn
    assert Counter(kind for kind, _ in names) == dict.fromkeys(DRAW["KINDS"], 10)
    seeds = [int(seed) - TEST_SEEDS for _, seed in names]
    assert len(set(seeds)) == 50
    assert min(seeds) >= DRAW["FIRST"]
    assert replace(WIDE, drawn=WIDE.drawn[1:]).hash != WIDE.hash
    assert EvaluationPlan(policy="hover", protocol="recover-wide").count == 100


@pytest.mark.slow
@pytest.mark.sumo
def test_a_town_is_drawn_where_its_losses_can_be_flown_and_no_constant_is_right():
    name = f"eyas.maps.covered:VILLAGE:{TEST_SEEDS + 102}"
    assert name in WIDE.drawn
    rules, flyable = DRAW["RULES"], DRAW["flyable"]
    assert flyable(rules, name) == ""
    assert flyable(rules, "desert-bare") == "too few losses below roofs"
    episodes = WIDE.choose([Place(name, "day", "SUMO_VEHICLE")], WIDE, 1, FIRST_SEED)
    sites = [episode.variant.partition("@")[2] for episode in episodes]
    assert len(set(sites)) == len(episodes) == 2


def judged(nearest, wanted, *, home):
    """Return the figures of a flight of which this is all that is known."""
    scenario = MissionScenario.__new__(MissionScenario)
    scenario._period = MISSION.period
    scenario._nearest, scenario._wanted = nearest[None], wanted[None]
    scenario._home = np.full((1, len(nearest)), home)
    return scenario.figures(0)


def test_stages_count_in_a_row_and_a_flight_that_has_failed_passes_none():
    looks = MISSION.steps // 4
    target = np.full(looks, 5)
    assert judged(target, target, home=True)["score"] == 1.0
    lost = target.copy()
    lost[round(90.0 / 300.0 * looks) :] = -1
    found = judged(lost, target, home=True)
    assert [found[name] for name in STAGES] == [1.0, 1.0, *[0.0] * 5]
    assert found["score"] == pytest.approx(2 / 7)
    assert judged(target, target, home=False)["score"] == pytest.approx(6 / 7)
    # Who follows nobody does not follow a target that nobody has named either.
    nobody = np.full(looks, -1)
    assert judged(nobody, np.full(looks, -2), home=False)["score"] == 0.0


class Raises:
    """Fails at once."""

    def __init__(self, env):
        self.env, self.sampled, self.told = env, False, frozenset()

    def begin(self, start):
        pass

    def act(self, sight):
        raise ValueError("nothing")


@pytest.fixture(scope="module")
def mission():
    """Two episodes of the mission."""
    return MISSION.choose([Place("downtown", "day", "SUMO_VEHICLE")], MISSION, 2, 1_000_000)


@pytest.mark.slow
def test_a_policy_that_raises_passes_no_stage(mission):
    policy = Raises(open_policy("hover", {}).env)
    flown = BatchFlight(mission, MISSION, policy, delay_from("0")).fly()
    records = [record for ended in flown for record in ended]
    assert [record.figures["score"] for record in records] == [0.0, 0.0]


@pytest.mark.slow
def test_words_change_in_flight_and_weather_turns(mission):
    batch = EpisodeBatch(mission, MISSION, open_policy("hover", {}).env)
    scenario = MissionScenario(batch, MISSION, mission)
    first = scenario.instruction()
    step = round(165.0 / MISSION.period)
    assert scenario.new_instruction(step - 1) is None
    wrong = scenario.new_instruction(step)
    assert wrong is None or wrong.words != first.words
    called = scenario.new_instruction(round(250.0 / MISSION.period))
    assert set(called.words) == {COME_BACK}
    assert not called.attributes.any()
    (group,) = batch.groups
    clear = group.simulation.snapshot.light.fog_density.copy()
    scenario.measure(round(139.99 / MISSION.period), np.ones(2, np.bool_))
    light = group.simulation.snapshot.light
    assert (light.fog_density > clear).all()
    assert (light.sun < 0.5).all()
    assert scenario.covered(round(77.0 / MISSION.period)).all()
    assert not scenario.covered(round(81.0 / MISSION.period)).any()


@pytest.mark.slow
def test_a_drone_in_a_crown_or_a_roof_is_counted():
    spec = EpisodeSpec(Place("citystreet", "day", "SUMO_VEHICLE"), 0.0, 1)
    batch = EpisodeBatch([spec], LONG_TEN, open_policy("hover", {}).env)
    (group,) = batch.groups
    solid = group.simulation.scene.colliders
    house = int(np.flatnonzero(solid.prism_top > 15.0)[0])
    first, last = solid.prism_first[house : house + 2]
    middle = solid.prism_points[first:last].mean(axis=0)
    found = []
    for height in (0.5, 1.0):
        up = solid.prism_bottom[house] + height * (solid.prism_top - solid.prism_bottom)[house]
        group.simulation.place(np.array([[*middle, up + 60.0 * (height == 1.0), 0.0]]))
        found.append(bool(inside_things(group)[0]))
    assert found == [True, False]


@pytest.mark.slow
def test_a_coat_changes_once_in_the_middle_to_that_of_the_nearest():
    short = COAT.changed({"done": {"total_steps": 64}})
    spec = EpisodeSpec(Place("citystreet", "day", "Pedestrian"), 0.0, 1, TEST_SEEDS + 1)
    batch = EpisodeBatch([spec], short, open_policy("hover", {}).env)
    scenario = CoatScenario(batch, short, [spec])
    (group,) = batch.groups
    target, looks = int(group.simulation.snapshot.targets.actor[0]), []
    for step in range(16):
        scenario.measure(step, np.ones(1, np.bool_))
        own = group.simulation.looks_around(0)
        looks.append((int(own.model[0, target]), *own.colour[0, target].tolist()))
    assert len(set(looks[:7])) == len(set(looks[7:])) == 1
    assert looks[0] != looks[-1]
    assert set(scenario.figures(0)) >= {"kept_before", "kept_after", "kept_share"}


def test_each_long_flight_is_an_observation_of_its_own(monkeypatch):
    monkeypatch.setattr(first_fitting, "visible_at_start", lambda own, _: [True] * len(own))
    plan = EvaluationPlan(policy="hover", protocol="long-10")
    episodes = [episode for part in batches(plan) for episode in part]
    assert len(episodes) == len({episode.seed for episode in episodes}) == 96
    alone = plan.model_copy(update={"maps": ("village",), "weathers": ("snow",)})
    assert {episode for part in batches(alone) for episode in part} <= set(episodes)
