"""Drones that follow one target together."""

from dataclasses import replace

import numpy as np
import pytest

from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.flight.meter import LOOK
from eyas.benchmark.flight.policy_runner import fly_batch
from eyas.benchmark.flight.team import SEARCH_LIMIT, TeamScenario
from eyas.benchmark.flight.team_radio import MESSAGE, Radio
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.plan.plan import EvaluationPlan, batches, check
from eyas.benchmark.policies.simple import Hover
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.engine.core.errors import ConfigError
from eyas.engine.policies.policy import Decision
from eyas.engine.settings.env import EnvConfig

HOME = Place("citystreet", "day", "SUMO_VEHICLE")


def chosen(name="pair", count=1, seed=1_000_000):
    protocol = PROTOCOLS.get(name)
    return protocol, protocol.choose([HOME], protocol, count, seed)


@pytest.fixture(scope="module")
def pair():
    protocol, episodes = chosen()
    return protocol, episodes, EpisodeBatch(episodes, protocol, EnvConfig())


def test_the_drones_of_a_team_have_one_target_and_other_starts(pair):
    _, episodes, batch = pair
    snapshot = batch.snapshot()
    assert [episode.variant for episode in episodes] == ["drone-1", "drone-2"] * 4
    for first in range(0, len(episodes), 2):
        one, two = first, first + 1
        assert snapshot.targets.actor[one] == snapshot.targets.actor[two]
        assert (snapshot.targets.position[one] == snapshot.targets.position[two]).all()
    above = np.linalg.norm((snapshot.episodes.view_centre - snapshot.targets.centre)[:, :2], axis=1)
    assert (above[::2] < 3.0).all()
    assert (above[1::2] > 11.0).all()


def test_one_camera_of_each_team_is_covered_for_five_to_fifteen_seconds(pair):
    protocol, episodes, batch = pair
    scenario = TeamScenario(batch, protocol, episodes)
    covered = np.array([scenario.covered(step) for step in range(protocol.steps)])
    seconds = covered.sum(axis=0) * protocol.period
    assert set(seconds.round(6).tolist()) <= {0.0, 5.0, 10.0, 15.0}
    assert len(set(seconds.round(6).tolist())) > 2
    assert ((seconds > 0).reshape(-1, 2).sum(axis=1) == 1).all()
    starts = covered.argmax(axis=0)[seconds > 0] * protocol.period
    assert (starts >= 5.0).all()
    assert (starts + seconds[seconds > 0] + SEARCH_LIMIT < 60.0).all()
    assert ((np.diff(covered.astype(int), axis=0) == 1).sum(axis=0) == (seconds > 0)).all()


def test_a_covered_camera_is_black_and_its_mates_sees(pair):
    protocol, episodes, _ = pair
    env = EnvConfig.model_validate({"observation": {"parts": ["image", "depth", "classes"]}})
    batch = EpisodeBatch(episodes, protocol, env)
    batch.covered[1] = True
    every = np.ones(batch.count, np.bool_)
    batch.look(every, every)
    seen = batch.observations
    assert not seen["image"][1].any()
    assert np.isinf(seen["depth"][1]).all()
    assert len(np.unique(seen["classes"][1])) == 1
    assert seen["image"][0].std() > 5.0
    assert batch.visible()[1] == 0.0
    assert batch.visible()[0] > 0.0


def test_messages_reach_the_mates_and_nobody_else():
    protocol, episodes = chosen("team")
    radio = Radio(episodes, protocol)
    assert radio.heard().shape == (16, 3, MESSAGE)
    assert np.isnan(radio.heard()).all()
    speaking = np.zeros(16, np.bool_)
    speaking[5] = True
    radio.say(speaking, np.full((16, MESSAGE), 7.0))
    heard = ~np.isnan(radio.heard()).any(axis=2)
    assert np.flatnonzero(heard.any(axis=1)).tolist() == [4, 6, 7]
    assert heard.sum() == 3


class Talker(Hover):
    """Says who it is, and remembers what it hears."""

    def __init__(self):
        super().__init__({"action_repeat": 4})
        self.heard = []

    def act(self, sight):
        self.heard.append(sight.heard.copy())
        said = np.repeat(np.arange(len(sight.heard))[:, None], MESSAGE, axis=1).astype(float)
        return Decision(super().act(sight).actions, messages=said)


def test_a_message_is_heard_at_the_next_look():
    protocol, episodes = chosen()
    short = replace(protocol.changed({"done": {"total_steps": 100}}), scenario=None)
    talker = Talker()
    for _ in BatchFlight(episodes, short, talker, delay_from("0")).fly():
        pass
    assert np.isnan(talker.heard[0]).all()
    assert talker.heard[1][:, 0, 0].tolist() == [1, 0, 3, 2, 5, 4, 7, 6]


def test_ones_own_class_hears_and_says(monkeypatch):
    import own_policies

    class Echo:
        env_settings = {"action_repeat": 4}  # noqa: RUF012
        heard = []  # noqa: RUF012

        def hear(self, messages):
            Echo.heard.append(messages)

        def act(self, picture):
            return 6

        def say(self):
            return 6 * [float(len(Echo.heard))]

    monkeypatch.setattr(own_policies, "Echo", Echo, raising=False)
    protocol, episodes = chosen()
    short = replace(protocol.changed({"done": {"total_steps": 100}}), scenario=None)
    for _ in BatchFlight(
        episodes[:2], short, open_policy("own_policies:Echo", {}), delay_from("0")
    ).fly():
        pass
    assert Echo.heard[0].shape == (1, 6)
    assert np.isnan(Echo.heard[0]).all()
    assert Echo.heard[2][0].tolist() == 6 * [2.0]  # what its mate said at the look before


def test_figures_of_a_team_are_those_of_a_recount():
    """By hand: both look away, one sees, the covered one sees again after two seconds."""
    protocol, episodes = chosen()
    batch = EpisodeBatch(episodes, protocol, EnvConfig())
    scenario = TeamScenario(batch, protocol, episodes)
    row = int(np.flatnonzero(scenario._lid[:, 1])[0])
    mate = row ^ 1
    scenario._sees[:] = False
    scenario._sees[mate, :100] = True
    first = -(-int(scenario._lid[row, 1]) // LOOK) + round(2.0 / (LOOK * protocol.period))
    scenario._sees[row, first:] = True
    figures = scenario.figures(row)
    assert figures["handover_time"] == pytest.approx(2.0, abs=0.05)
    assert figures["handed_over"] == 1.0
    looks = scenario._sees.shape[1]
    assert figures["team_seen"] == pytest.approx((100 + looks - first) / looks)
    assert figures["alone_seen"] == pytest.approx((looks - first) / looks)
    assert scenario.figures(mate)["handover_time"] is None
    assert scenario.figures(mate)["team_seen"] == figures["team_seen"]
    scenario._sees[row] = False
    assert scenario.figures(row)["handover_time"] == SEARCH_LIMIT
    assert scenario.figures(row)["handed_over"] == 0.0


def test_a_team_is_never_split_between_batches_and_its_latency_is_not_measured():
    plan = EvaluationPlan(policy="hover", protocol="team", episodes=2, batch=7)
    parts = batches(plan)
    assert {len(part) for part in parts} == {4}
    assert sum(map(len, parts)) == plan.count
    with pytest.raises(ConfigError, match="--latency: 'measured' is not allowed"):
        check(plan.model_copy(update={"latency": "measured"}))


@pytest.mark.slow
def test_records_wait_for_the_whole_team():
    """A drone that ends early has the team's figures all the same."""
    plan = EvaluationPlan(policy="hover", protocol="pair", episodes=1, batch=2)
    records = [r for ended in fly_batch(plan, batches(plan)[0]) for r in ended]
    assert {record.variant for record in records} == {"drone-1", "drone-2"}
    assert len({record.figures["team_seen"] for record in records}) == 1
