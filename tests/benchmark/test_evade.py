"""Drivers who want to be lost: what is told from their paths, and what is measured of flights."""

import numpy as np
import pytest

from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.flight.evasion import Evasion, EvasionScenario, evasions_in, evasions_of
from eyas.benchmark.flight.meter import LOOK
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.engine.settings.env import EnvConfig
from eyas.engine.targets.catalogue import MODELS

HOME = Place("citystreet", "day", "SUMO_VEHICLE")


@pytest.fixture(scope="module")
def evade():
    protocol = PROTOCOLS.get("evade")
    return protocol, protocol.choose([HOME], protocol, 2, 1_000_000)


def driven(*parts, period=0.25):
    """Return places along an eastward road at speeds [m/s] for numbers of looks."""
    speed = np.concatenate([np.full(looks, float(own)) for own, looks in parts])
    return np.stack([np.cumsum(speed) * period, np.zeros(len(speed))], axis=1)


def test_driving_on_is_no_evasion():
    places = driven((12, 100), (6, 20), (14, 100))
    assert evasions_of(np.ones(len(places)), places) == []
    corner = np.concatenate([places[:100], places[99] + places[:100, ::-1]])
    assert evasions_of(np.ones(200), corner) == []


def test_stops_dashes_hiding_and_turns_are_told_apart():
    places = driven((12, 40), (0, 12), (12, 40), (19, 12), (12, 40), (0, 4), (12, 40))
    shares = np.ones(len(places))
    shares[110:120] = 0.0
    assert evasions_of(shares, places) == [
        Evasion("stop", 10.0, 13.0),
        Evasion("dash", 23.0, 26.0),
        Evasion("hiding", 27.75, 30.25),
    ]
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 9)
    there = driven((10, 40))
    turn = there[-1] + [0.0, 3.0] + 3.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    back = [0.0, 6.0] + there[-1] - driven((10, 40))
    about = np.concatenate([there, turn[1:], back])
    (told,) = evasions_of(np.ones(len(about)), about)
    assert told.kind == "turn"
    assert 7.5 < told.start < 10.5 < told.end < 13.0


@pytest.mark.slow
def test_targets_of_the_protocol_are_cars_that_evade_at_least_twice(evade):
    protocol, episodes = evade
    assert len(episodes) == 8
    for own in evasions_in(episodes, protocol):
        assert len(own) >= 2
        assert {"turn", "dash"} & {one.kind for one in own}
        assert all(3.0 <= one.start < one.end < 57.0 for one in own)
    targets = EpisodeBatch(episodes, protocol, EnvConfig()).snapshot().targets
    assert (targets.size[:, 0] < 7.0).all()  # no bus, no truck
    assert len({MODELS[index].name for index in targets.model.tolist()}) > 2


def test_what_is_held_is_what_is_seen_soon_after_each_evasion(evade):
    protocol, episodes = evade
    batch = EpisodeBatch(episodes, protocol, EnvConfig())
    scenario = EvasionScenario(batch, protocol, episodes)
    scenario._sees[:] = True
    assert {scenario.figures(row)["held"] for row in range(len(episodes))} == {1.0}
    first, *_ = sorted(evasions_in(episodes, protocol)[0], key=lambda one: one.start)
    end = round(first.end / (LOOK * protocol.period))
    scenario._sees[0, end : end + round(3.5 / (LOOK * protocol.period))] = False
    figures = scenario.figures(0)
    assert figures["held"] < 1.0
    assert figures[f"held_{first.kind}"] < 1.0
    scenario._sees[:] = False
    assert scenario.figures(0)["held"] == 0.0


@pytest.mark.thorough
def test_following_exactly_holds_all_and_hovering_almost_nothing(fly):
    follow, hover = (fly(policy, protocol="evade") for policy in ("follow", "hover"))
    assert np.mean([record.figures["held"] for record in follow]) > 0.9  # crowns
    assert np.mean([record.figures["held"] for record in hover]) < 0.3
