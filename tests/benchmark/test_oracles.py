"""Oracles that are told the true place only while they see the target."""

import numpy as np
import pytest

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.policies.lane_graph import SPACING, Lanes, lane_graph
from eyas.benchmark.policies.predictors import AlongLanes, ConstantVelocity
from eyas.benchmark.policies.road_search import RoadSearch
from eyas.benchmark.policies.sighted import Clue, LastMotion
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.engine.policies.policy import PolicyInput, Start
from eyas.engine.sim.scenes import load_network
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import find_recording
from eyas.engine.traffic.smoothing import smooth
from eyas.engine.world.maps import MAPS

ORACLES = ("sighted", "constant-velocity", "road-graph")

HIDDEN_AT_FIRST = 77_000_014
"""Seed of an episode of `paper`, direction 0, whose target stands below a tree at the start."""


def specs(*seeds, place="citystreet"):
    return [EpisodeSpec(Place(place, "day", "SUMO_VEHICLE"), 0.0, seed) for seed in seeds]


@pytest.mark.parametrize("kind", ["discrete", "velocity"])
@pytest.mark.parametrize("name", ORACLES)
def test_an_oracle_that_does_not_see_the_target_knows_nothing_of_it(name, kind):
    """Its actions are the same wherever the target is."""

    def actions(shift):
        policy = open_policy(name, {"actions": kind})
        batch = EpisodeBatch(specs(5, 6), PROTOCOLS.get("paper"), policy.env)
        every, nobody = np.ones(2, np.bool_), np.zeros(2, np.bool_)
        policy.begin(Start(np.array([5, 6]), lambda: np.zeros((2, 4), np.int32), None, batch.roads))

        def state():
            snapshot = batch.snapshot()
            snapshot.targets.centre[:] += shift
            snapshot.targets.velocity[:] -= shift
            return snapshot

        told = []
        for share in (0.14, 0.0, 0.0):
            sight = PolicyInput(
                batch.observations, every, state, lambda share=share: np.full(2, share), nobody
            )
            told.append(np.asarray(policy.act(sight).actions).tolist())
            batch.advance(np.zeros((2, 4)), every)
        return told

    assert actions(0.0) == actions(3.0)


def test_what_is_seen_is_followed_exactly(fly):
    """Where nothing is ever hidden, the oracles do what `follow` does."""
    exact = {record.name: record for record in fly("follow")}
    for name in ORACLES:
        for record in fly(name):
            if record.clear == 1.0:
                assert record.cr == pytest.approx(exact[record.name].cr, abs=0.5)
                assert record.tsr == 1.0


def test_only_one_that_searches_finds_a_target_hidden_at_first(fly):
    cv, best = (
        fly(name, 4, seeds=(HIDDEN_AT_FIRST - 2,)) for name in ("constant-velocity", "sighted")
    )
    hidden = [number for number, record in enumerate(cv) if record.seed == HIDDEN_AT_FIRST]
    (number,) = hidden
    assert cv[number].tsr < 0.5
    assert best[number].tsr > 0.95


@pytest.mark.parametrize("name", ["citystreet", "village"])
def test_lanes_are_points_in_a_row_that_go_on_over_junctions(name):
    graph = lane_graph(load_network(name, 0))
    count = len(graph.place)
    assert ((graph.after >= 0) & (graph.after < count)).all()
    step = np.linalg.norm(graph.place[graph.after] - graph.place[:, None], axis=2)
    dead = graph.after[:, 0] == np.arange(count)
    assert dead.sum() <= 16
    assert (step[~dead] > 0.0).all()
    assert np.median(step[~dead]) == pytest.approx(SPACING, abs=0.1)
    assert step.max() < 2.0 * SPACING
    # Somewhere a lane has several ways to go on.
    assert (graph.after != graph.after[:, :1]).any()


def test_lanes_of_two_maps_stay_apart():
    first, second = load_network("citystreet", 0), load_network("village", 0)
    lanes, alone = Lanes([first, second, first]), Lanes([second])
    here = alone.graph.place[100]
    found, expected = lanes.near(1, here, None), alone.near(0, here, None)
    assert len(found)
    assert (lanes.graph.place[found] == alone.graph.place[expected]).all()
    width = alone.graph.after.shape[1]
    onward, alone_onward = lanes.graph.after[found, :width], alone.graph.after[expected]
    assert (onward - found[0] == alone_onward - expected[0]).all()


def _errors(predictor, seconds):
    """Return how far off a predictor is after a time, for real vehicles, [m], shape (V,)."""
    recipe = MAPS.get("citystreet")
    recording = find_recording(recipe.roads(0), TrafficConfig(), shipped=recipe.shipped_traffic())
    tracks = smooth(recording)
    roads = load_network("citystreet", 0)
    off, count = [], recording.actors
    for at in range(500, 5000, 1500):
        later = at + round(seconds * recording.rate)
        seen = LastMotion(tracks.position[at], tracks.velocity[at], tracks.yaw[at], np.zeros(count))
        start = Start(np.arange(count), lambda: np.zeros((count, 4)), None, lambda: [roads] * count)
        predictor.begin(start)
        every, nobody = np.ones(count, np.bool_), np.zeros(count, np.bool_)
        for age in np.arange(0.0, seconds + 0.01, 0.125):
            clue = Clue(seen, np.full(count, age), every, seen.place, seen.yaw, ~nobody)
            places = predictor.places(clue)
        off.append(np.linalg.norm(places - tracks.position[later], axis=1))
    return np.concatenate(off)


def test_lanes_predict_better_than_a_straight_line():
    straight, lanes = (_errors(make(), 4.0) for make in (ConstantVelocity, AlongLanes))
    assert (lanes < 7.0).mean() > (straight < 7.0).mean()


def test_a_search_goes_where_hidden_vehicles_can_be():
    """After 8 s below a cover, its goal is on the roads, within what a vehicle can drive."""
    away = _errors(RoadSearch(), 8.0)
    assert np.median(away) < 60.0
    assert (away < 10.0).mean() > 0.2


@pytest.mark.parametrize("name", ["follow", "sighted"])
def test_an_oracle_keeps_its_height_over_a_target_that_climbs(name):
    protocol, policy = PROTOCOLS.get("air"), open_policy(name, {"actions": "velocity"})
    place = Place("citystreet", "day", "Quadrotor")
    specs = [EpisodeSpec(place, 0.0, seed, variant="cruise") for seed in (900_000_003, 900_000_004)]
    batch = EpisodeBatch(specs, protocol, policy.env)
    every, nobody = np.ones(2, np.bool_), np.zeros(2, np.bool_)
    policy.begin(Start(np.array([3, 4]), lambda: np.zeros((2, 4), np.int32), None, batch.roads))
    state = batch.snapshot()
    state.targets.velocity[:, 2] = 1.5
    sight = PolicyInput(batch.observations, every, lambda: state, lambda: np.ones(2), nobody)
    up = np.asarray(policy.act(sight).actions)[:, 2]
    np.testing.assert_allclose(up, 1.5, atol=1e-6)
    state.targets.centre[:, 2] += 2.0
    if name == "follow":  # at once; the other looks again after some steps
        np.testing.assert_allclose(np.asarray(policy.act(sight).actions)[:, 2], 3.5, atol=1e-6)
