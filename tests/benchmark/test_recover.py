"""Targets that are out of sight for seconds: when, how long, and what is measured of it."""

from dataclasses import replace

import numpy as np
import pytest

from eyas.benchmark.episodes import target_losses
from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.episodes.from_above import FromAbove
from eyas.benchmark.episodes.target_losses import (
    COVERED,
    SEARCH_LIMIT,
    TargetLoss,
    covered_losses,
    hidden_spans,
    losses_by_things,
)
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.flight.recovery import RecoveryScenario, followed, recovery_figures
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.policies.predictors import ConstantVelocity
from eyas.benchmark.policies.sighted import SightOracle
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.benchmark.report.plots import draw_plots
from eyas.engine.core.errors import SpawnError
from eyas.engine.policies.policy import Decision
from eyas.engine.policies.sight import visible_shares
from eyas.engine.settings.env import EnvConfig

VILLAGE = Place("village", "day", "SUMO_VEHICLE")
HOME = Place("citystreet", "day", "SUMO_VEHICLE")
SEED = 1_000_000
SHORT = {"done": {"total_steps": 12_000}}
"""The first 24 s."""


@pytest.fixture(scope="module")
def things():
    protocol = PROTOCOLS.get("recover")
    return protocol, protocol.choose([VILLAGE], protocol, 1, SEED)


@pytest.fixture(scope="module")
def covers():
    protocol = PROTOCOLS.get("recover-camera")
    return protocol, protocol.choose([HOME], protocol, 1, SEED)


def fly(protocol, episodes, policy):
    """Fly a policy, and return its records in the order of the episodes."""
    flight = BatchFlight(list(episodes), protocol, policy, delay_from("0"))
    records = [record for ended in flight.fly() for record in ended]
    return sorted(records, key=lambda one: [each.name for each in episodes].index(one.name))


@pytest.mark.slow
def test_losses_by_things_are_as_long_as_promised_for_who_flies_exactly(things):
    """Counted in the pictures of an exact flight, ten times as often as the protocol looks."""
    protocol, episodes = things
    (group,) = EpisodeBatch(episodes, protocol, EnvConfig()).groups
    shares = np.zeros((protocol.steps // 3, len(episodes)))
    for look in range(len(shares)):
        shares[look, group.rows] = visible_shares(group.subjects()[0])
        group.simulation.carry(12)
    for own, losses in zip(shares.T, losses_by_things(episodes, protocol), strict=True):
        counted = [one for one in hidden_spans(own, 0.024) if one.end - one.start > 3.5]
        assert 1 <= len(losses) == len(counted) <= 3
        for loss, seen in zip(losses, counted, strict=True):
            assert 4.0 <= loss.end - loss.start <= 12.0
            assert loss.start == pytest.approx(seen.start, abs=0.3)
            assert loss.end == pytest.approx(seen.end, abs=0.3)
            assert loss.end <= 90.0 - SEARCH_LIMIT


def test_a_camera_is_covered_for_exactly_the_promised_steps(covers):
    protocol, episodes = covers
    batch = EpisodeBatch(episodes, protocol, EnvConfig())
    scenario = RecoveryScenario(batch, protocol, episodes)
    covered = np.array([scenario.covered(step) for step in range(protocol.steps)])
    lengths = [COVERED[episode.variant] for episode in episodes]
    assert (covered.sum(axis=0) == np.array([2 * round(one / 0.008) for one in lengths])).all()
    assert (np.diff(covered.astype(int), axis=0) == 1).sum(axis=0).tolist() == [2] * len(episodes)
    starts = [[loss.start for loss in own] for own in covered_losses(episodes, protocol)]
    for first in range(0, len(episodes), len(COVERED)):
        assert [one.variant for one in episodes[first : first + 4]] == list(COVERED)
        assert starts[first : first + 4] == [starts[first]] * 4
    assert len({tuple(one) for one in starts}) == 4


class Watcher:
    """Hovers, and remembers at which steps its picture was black."""

    sampled = False

    def __init__(self):
        self.env = EnvConfig.model_validate({"observation": {"width": 16, "height": 16}})

    def begin(self, start):
        self.black, self.blind = [], []

    def act(self, sight):
        self.black.append(~sight.observation.any(axis=(1, 2, 3)))
        self.blind.append(sight.visible() == 0.0)
        return Decision(np.full(len(sight.deciding), 6))


@pytest.mark.slow
def test_pictures_are_black_while_the_camera_is_covered_and_not_a_step_longer(covers):
    protocol, episodes = covers
    episodes = episodes[:2]  # covered for 2 and for 5 s
    # The covers are those of the full length, of which the first 24 s are flown.
    scenario = RecoveryScenario(EpisodeBatch(episodes, protocol, EnvConfig()), protocol, episodes)
    short = replace(protocol.changed(SHORT), scenario=lambda *_: Covers(scenario))
    watcher = Watcher()
    assert [one.error for one in fly(short, episodes, watcher)] == [None] * len(episodes)
    black = np.array(watcher.black)
    covered = np.array([scenario.covered(step) for step in range(len(black))])
    assert len(black) == 3000
    assert covered.sum(axis=0).tolist() == [250, 625]
    assert (black == covered).all()
    assert np.array(watcher.blind)[covered].all()


class Covers:
    """Only the covers of another scenario."""

    def __init__(self, other):
        self.covered, self.over = other.covered, other.over
        self.new_instruction = other.new_instruction
        self.instruction, self.measure, self.figures = (
            other.instruction,
            lambda *_: None,
            lambda _: {},
        )


def test_figures_of_flights_made_by_hand():
    losses, sees = [TargetLoss(10.0, 14.0), TargetLoss(40.0, 52.0)], np.ones(900, np.bool_)
    always = recovery_figures(losses, sees, 0.1)
    assert (always["recovered"], always["recovery_time"], always["nt2f"]) == (1.0, 0.0, 1.0)
    sees[100:200] = False  # seen again 6 s after the first loss, 10 s after its onset
    sees[400:560] = False  # 4 s after the second, 16 s after its onset
    some = recovery_figures(losses, sees, 0.1)
    assert some["recovered"] == 1.0
    assert some["recovery_time"] == pytest.approx(5.0)
    assert some["recovered_of_onset"] == 0.5
    sees[145:148] = True  # a glimpse of 0.3 s is not enough
    assert recovery_figures(losses, sees, 0.1) == some
    sees[400:680] = False  # 16 s after the second
    late = recovery_figures(losses, sees, 0.1)
    assert late["recovered"] == 0.5
    assert late["recovery_time"] == pytest.approx(0.5 * (6.0 + SEARCH_LIMIT))
    assert late["nt2f"] == pytest.approx(40.0 / 90.0)
    nothing = recovery_figures(losses, np.zeros(900, np.bool_), 0.1)
    assert (nothing["recovered"], nothing["nt2f"]) == (0.0, pytest.approx(10.0 / 90.0))


def test_another_vehicle_is_followed_if_it_stays_in_the_middle():
    period, loss = 0.25, TargetLoss(10.0, 14.0)
    middle = np.full(360, -1)
    assert not followed(middle, loss, period)
    middle[60:72:2] = 7  # now and then
    middle[80:86] = 7  # for 1.25 s
    assert not followed(middle, loss, period)
    middle[80:90] = np.where(np.arange(10) < 5, 7, 8)  # one after the other
    assert not followed(middle, loss, period)
    middle[80:89] = 7
    assert followed(middle, loss, period)
    assert not followed(np.roll(middle, 120), loss, period)  # long after


def test_a_target_that_comes_out_where_it_vanished_makes_no_episode(monkeypatch):
    """A drone that only waits would have it in its picture again."""
    protocol = PROTOCOLS.get("recover")
    looks = round(protocol.steps * protocol.period / 0.256)
    shares = np.ones((2, looks))
    shares[:, 40:60] = 0.0  # 5.1 s
    places = np.zeros((2, looks, 2))
    places[0, 40:, 0], places[1, 40:, 0] = 11.9, 12.1  # both vanish at look 39
    seen = FromAbove(shares, places)
    monkeypatch.setattr(target_losses, "seen_from_above", lambda *_: seen)
    near, far = losses_by_things([None, None], protocol)
    assert near == []
    assert len(far) == 1


def test_hidden_spans_join_over_glimpses():
    shares = np.ones(40)
    shares[4:12] = shares[14:20] = 0.1
    shares[30] = 0.14
    assert hidden_spans(shares, 0.25) == [TargetLoss(1.25, 5.25), TargetLoss(7.75, 8.0)]
    shares[14:16] = 0.9
    assert len(hidden_spans(shares, 0.25)) == 3


class Stays(ConstantVelocity):
    """The target is where it was seen last."""

    def places(self, clue):
        return clue.last.place


def recovered(protocol, episodes, policy):
    return np.mean([one.figures["recovered"] for one in fly(protocol, episodes, policy)])


@pytest.mark.slow
def test_who_waits_where_the_target_vanished_does_not_recover_it(things):
    protocol, episodes = things
    some = episodes[: len(episodes) // 4]
    assert recovered(protocol, some, open_policy("follow", {})) == 1.0
    assert recovered(protocol, some, SightOracle({}, Stays())) <= 0.5


@pytest.mark.thorough
def test_who_waits_recovers_the_target_in_one_of_four_episodes_at_most(things):
    protocol, episodes = things
    assert recovered(protocol, episodes, open_policy("follow", {})) == 1.0
    assert recovered(protocol, episodes, SightOracle({}, Stays())) <= 0.25


@pytest.mark.slow
def test_records_repeat_however_episodes_are_batched(covers):
    protocol, episodes = covers
    protocol, chosen = protocol.changed(SHORT), episodes[1:3]
    together = fly(protocol, chosen, open_policy("constant-velocity", {}))
    alone = [fly(protocol, [one], open_policy("constant-velocity", {}))[0] for one in chosen]
    assert together == alone
    assert {one.figures["recovered_5s"] for one in together} != {None}


def test_a_map_without_cover_is_refused_in_words():
    protocol = PROTOCOLS.get("recover")
    with pytest.raises(SpawnError, match=r"nothing in 'farmland' hides .* use 'recover-camera'$"):
        protocol.choose([HOME._replace(map="farmland")], protocol, 1, SEED)


def test_more_episodes_include_the_fewer_ones(covers):
    protocol, episodes = covers
    more = protocol.choose([HOME], protocol, 2, SEED)
    assert more[: len(episodes)] == episodes
    assert len(more) == 2 * len(episodes) == len(set(more))


def test_the_curve_over_the_time_covered_is_drawn(covers, tmp_path):
    pytest.importorskip("matplotlib")
    protocol, episodes = covers
    protocol = protocol.changed({"done": {"total_steps": 500}})
    records = fly(protocol, episodes[:4], open_policy("hover", {}))
    draw_plots(tmp_path, protocol, "hover", records)
    assert (tmp_path / "plots" / "recovered.png").read_bytes().startswith(b"\x89PNG")
