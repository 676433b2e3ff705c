"""The protocols `standard` and `unseen`: starts drawn evenly, and which episodes are solvable."""

import subprocess
import sys
from collections import Counter

import numpy as np
import pytest

from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.episodes.even_choice import TRIED
from eyas.benchmark.episodes.starts import CELL
from eyas.benchmark.flight.policy_runner import SOLVED
from eyas.benchmark.plan.plan import EvaluationPlan, batches, check
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.rng import TEST_SEEDS
from eyas.engine.settings.env import EnvConfig
from eyas.engine.sim.scenes import load_network
from eyas.engine.traffic.library import TEST_TRAFFIC


def episodes_of(**changes):
    plan = EvaluationPlan(**{"policy": "hover", "protocol": "standard", **changes})
    return [episode for part in batches(plan) for episode in part]


@pytest.fixture(scope="module", params=["citystreet", "village"])
def standard(request):
    """A hundred starts, as the simulator makes them: episodes, and their batch."""
    episodes = episodes_of(maps=(request.param,))
    return episodes, EpisodeBatch(episodes, PROTOCOLS.get("standard"), EnvConfig())


def squares(batch):
    centres = batch.snapshot().targets.centre[:, :2]
    return Counter(map(tuple, np.floor(centres / CELL).tolist()))


@pytest.mark.slow
def test_starts_have_twelve_directions_and_three_recordings_equally_often(standard):
    episodes, _ = standard
    assert len(episodes) == len({episode.name for episode in episodes}) == 108
    turns = Counter(round(np.degrees(episode.direction)) for episode in episodes)
    assert turns == dict.fromkeys(range(0, 360, 30), 9)
    pairs = Counter((episode.direction, episode.traffic) for episode in episodes)
    assert set(pairs.values()) == {3}
    assert {episode.traffic for episode in episodes} == set(TEST_TRAFFIC)


def test_the_drone_starts_in_the_direction_that_is_told(standard):
    episodes, batch = standard
    snapshot = batch.snapshot()
    turn = snapshot.trackers.euler[:, 2] - snapshot.targets.yaw
    told = np.array([episode.direction for episode in episodes])
    assert np.cos(turn - told) == pytest.approx(np.ones(108), abs=1e-6)


def test_every_target_is_half_visible_in_the_first_picture(standard):
    _, batch = standard
    assert batch.visible().min() >= 0.5


def test_starts_are_spread_over_the_map_and_over_vehicles(standard):
    episodes, batch = standard
    visits = squares(batch)
    assert len(visits) > 30
    assert max(visits.values()) <= 4
    actors = batch.snapshot().targets.actor.tolist()
    followed = Counter((each.traffic, actor) for each, actor in zip(episodes, actors, strict=True))
    assert len(followed) > 80
    assert max(followed.values()) <= 3
    # Those that come first are not: nine of a hundred in one square.
    place = episodes[0].place
    first = [each._replace(seed=1_000_000 + number) for number, each in enumerate(episodes)]
    assert {each.place for each in first} == {place}
    taken = squares(EpisodeBatch(first, PROTOCOLS.get("standard"), EnvConfig()))
    assert max(taken.values()) > max(visits.values())
    assert len(taken) < len(visits)


def test_more_episodes_include_the_fewer_ones_and_weathers_share_them():
    few, many = (episodes_of(episodes=count) for count in (2, 11))
    assert set(few) < set(many)
    both = episodes_of(episodes=2, weathers=("night", "foggy"))
    for weather in ("night", "foggy"):
        own = [each for each in both if each.place.weather == weather]
        assert [each._replace(place=few[0].place) for each in own] == few
    other = episodes_of(episodes=2, seeds=(11_000_000,))
    assert not {each.seed for each in other} & {each.seed for each in many}


def test_an_episode_has_seeds_of_its_own_however_many_are_tried():
    many = episodes_of(episodes=11)
    slots = [(each.seed - 1_000_000) // TRIED for each in many]
    assert sorted(slots) == list(range(12 * 11))


UNSEEN = EvaluationPlan(policy="hover", protocol="unseen")


@pytest.mark.thorough  # six towns are built and looked at from 1,728 starts each
def test_all_towns_of_unseen_have_their_episodes():
    assert UNSEEN.count == 6 * 24 == len(episodes_of(protocol="unseen"))


@pytest.mark.slow  # the first time, a town is built
def test_unseen_is_flown_elsewhere_and_needs_no_sumo():
    plan, one = UNSEEN, {"protocol": "unseen", "maps": UNSEEN.maps[-1:]}
    assert len(plan.maps) == 6
    assert plan.count == 6 * 24 == 6 * len(episodes_of(**one))
    for name in plan.maps:
        town, seed = Place(name, "day", "SUMO_VEHICLE").town
        assert seed > TEST_SEEDS
        here, home = load_network(town, seed), load_network(town, 0)
        assert here.graph_hash != home.graph_hash
    code = (
        "import sys\n"
        "sys.modules.update(dict.fromkeys(['libsumo', 'sumo', 'sumolib', 'traci']))\n"
        "from eyas.benchmark.flight.policy_runner import fly_batch\n"
        "from eyas.benchmark.plan.plan import EvaluationPlan, batches\n"
        f"plan = EvaluationPlan(policy='hover', episodes=1, **{one})\n"
        "parts = batches(plan)\n"
        "part = [episode for part in parts for episode in part][:1]\n"
        "flown = [record for ended in fly_batch(plan, part) for record in ended]\n"
        "print(len(flown), len({record.map for record in flown}))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "1 1", done.stderr


@pytest.mark.parametrize("name", ["citystreet", "citystreet:7", "village"])
def test_unseen_is_not_flown_where_policies_are_taught(name):
    with pytest.raises(ConfigError, match=f"--map: '{name}' is not allowed in protocol 'unseen'"):
        check(EvaluationPlan(policy="hover", protocol="unseen", maps=(name,)))


@pytest.mark.parametrize(
    ("name", "town"),
    [
        ("citystreet", ("citystreet", 0)),
        ("citystreet:900000001", ("citystreet", 900_000_001)),
        ("package.module:FIELD", ("package.module:FIELD", 0)),
        ("my.plan.json", ("my.plan.json", 0)),
    ],
)
def test_a_town_of_a_seed_is_written_after_the_map(name, town):
    assert Place(name, "day", "SUMO_VEHICLE").town == town


@pytest.mark.slow
def test_episodes_are_solvable_that_the_oracle_solves(fly):
    """In village, some of the first targets of `paper` stand in a tunnel."""
    village = {"maps": ("village",), "episodes": 6, "seeds": (77_000_000,)}
    best, still = fly("sighted", **village), fly("hover", **village)
    assert [record.solvable for record in best] == [record.tsr >= SOLVED for record in best]
    told = {record.name: record.solvable for record in best}
    assert {record.name: record.solvable for record in still} == told
    assert set(told.values()) == {True, False}


def test_where_the_target_starts_out_of_view_nothing_is_said(fly):
    assert {record.solvable for record in fly("hover", protocol="search")} == {None}
