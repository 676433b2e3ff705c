"""`flown`: a drone that cannot follow at once, in wind, late; and starts that its body allows."""

import numpy as np
import pytest

from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.episodes.first_fitting import first_fitting
from eyas.benchmark.episodes.setting_out import AT_REST, AT_SPEED, leaves_its_way
from eyas.benchmark.flight.policy_runner import SOLVED
from eyas.benchmark.plan.plan import EvaluationPlan, opened
from eyas.benchmark.policies.follow import Follow
from eyas.benchmark.policies.oracle_commands import flown_over
from eyas.benchmark.policies.predictors import constant_velocity
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.engine.core.errors import SpawnError
from eyas.engine.policies.policy import PolicyInput, Start
from eyas.engine.settings.env import EnvConfig

HOME = Place("citystreet", "day", "SUMO_VEHICLE")
FLOWN = PROTOCOLS.get("flown")
SEED = 60_000_000


@pytest.fixture(scope="module")
def episodes():
    return FLOWN.choose([HOME], FLOWN, 1, SEED)


@pytest.fixture
def batch(episodes):
    return EpisodeBatch(episodes, FLOWN, EnvConfig())


def speeds(velocity):
    return np.linalg.norm(velocity[:, :2], axis=1)


def mean(records, variant):
    return np.mean([record.tsr for record in records if record.variant == variant])


@pytest.mark.slow
def test_there_are_as_many_starts_of_each_kind_and_more_include_the_fewer(episodes):
    assert [each.variant for each in episodes] == [AT_SPEED] * 4 + [AT_REST] * 4
    assert len({each.seed for each in episodes}) == 8
    assert FLOWN.choose([HOME], FLOWN, 1, SEED) == episodes
    assert set(episodes) < set(FLOWN.choose([HOME], FLOWN, 2, SEED))


def test_at_rest_both_stand_and_at_speed_both_drive(batch):
    snapshot = batch.snapshot()
    drones, targets = snapshot.trackers.velocity, snapshot.targets.velocity
    assert (speeds(targets)[:4] > 4.0).all()
    assert (speeds(drones - targets)[:4] < 2.0).all()  # turning ones: its place is another
    assert (speeds(targets)[4:] < 0.3).all()
    assert (drones[4:] == 0.0).all()


def test_the_wind_comes_from_anywhere_and_pushes_a_drone_that_hovers(batch):
    begun = batch.snapshot().trackers.position.copy()
    for _ in range(60):
        batch.advance(np.zeros((8, 4)), np.ones(8, np.bool_))
    pushed = (batch.snapshot().trackers.position - begun)[4:, :2]
    assert (np.linalg.norm(pushed, axis=1) > 0.02).all()
    angles = np.arctan2(pushed[:, 1], pushed[:, 0])
    assert len(np.unique(angles.round(2))) == 4


def test_a_command_takes_effect_after_40_ms(episodes):
    def flown(steps):
        paths = []
        for command in (0.0, 5.0):
            batch = EpisodeBatch(episodes, FLOWN, EnvConfig())
            for _ in range(steps):
                batch.advance(np.tile([command, 0.0, 0.0, 0.0], (8, 1)), np.ones(8, np.bool_))
            paths.append(batch.snapshot().trackers.commanded_position.copy())
        return np.abs(paths[1] - paths[0]).max(axis=1)

    assert (flown(5) == 0.0).all()
    assert (flown(6) > 0.0).all()


def test_targets_that_just_go_on_or_stay_are_left_out():
    time = np.arange(70) * 0.256
    on = np.stack([12.0 * time, np.zeros(70)], axis=1)
    ways = {
        "drives on": (on, False),
        "stands": (0.0 * on, False),
        "turns": (np.where(time[:, None] < 6.0, on, 72.0 + 0.0 * on), True),
        "turns too late": (np.where(time[:, None] < 10.0, on, 120.0 + 0.0 * on), False),
        "sets out": (np.maximum(on - 60.0, 0.0), True),
    }
    found = leaves_its_way(np.stack([way for way, _ in ways.values()]))
    assert dict(zip(ways, found.tolist(), strict=True)) == {
        name: leaves for name, (_, leaves) in ways.items()
    }


def test_velocities_steer_where_the_drone_is_told_to_be(batch):
    """What it is behind its command is on its way already."""
    env = Follow({"actions": "velocity"}).env
    state = batch.snapshot()
    place, still = state.targets.centre[:, :2], np.zeros((8, 2))
    before = np.asarray(flown_over(state, place, still, still, env))[:, :2]
    state.trackers.commanded_position[:, 0] += 3.0
    change = np.asarray(flown_over(state, place, still, still, env))[:, :2] - before
    yaw = state.trackers.euler[:, 2]
    assert change == pytest.approx(-3.0 * np.stack([np.cos(yaw), -np.sin(yaw)], axis=1))


@pytest.mark.slow
def test_who_sees_keeps_the_target_and_who_does_not_look_loses_it(fly):
    def flown(policy):
        return fly(policy, protocol="flown", seeds=(SEED,))

    sighted = flown("sighted")
    # It is flown again, or was in another run, to say which episodes can be solved.
    assert [record.solvable for record in sighted] == [each.tsr >= SOLVED for each in sighted]
    hover, coaster = flown("hover"), flown("cheats:Coaster")
    for start in (AT_SPEED, AT_REST):
        assert mean(sighted, start) > 0.95
        assert mean(hover, start) < 0.5
        assert mean(coaster, start) < 0.5
    assert sum(bool(record.solvable) for record in sighted) >= 7


@pytest.mark.slow
def test_seven_actions_are_too_rough_even_for_one_that_knows_all(fly):
    rough = fly("follow", protocol="flown", seeds=(SEED,), env={"actions": "discrete"})
    assert np.mean([record.tsr for record in rough]) < 0.5
    assert all(record.crashed for record in rough)


def test_oracles_fly_by_velocities_here_unless_told_otherwise_and_by_numbers_elsewhere():
    def actions(policy, protocol, env=None):
        plan = EvaluationPlan(policy=policy, protocol=protocol, env=env or {})
        return opened(plan)[0].env.actions

    for name in ("follow", "sighted", "constant-velocity", "road-graph"):
        assert actions(name, "flown") == "velocity"
        assert actions(name, "flown", {"actions": "discrete"}) == "discrete"
        assert actions(name, "paper") == "discrete"
    assert actions("hover", "flown") == "discrete"


def test_an_oracle_flies_on_as_fast_where_it_goes_on_from_what_it_saw(episodes):
    policy = constant_velocity({"actions": "velocity"})
    batch = EpisodeBatch(episodes, FLOWN, policy.env)
    every, nobody = np.ones(8, np.bool_), np.zeros(8, np.bool_)
    policy.begin(Start(np.arange(8), lambda: np.zeros((8, 4), np.int32), None, batch.roads))
    told = []
    for share in (1.0, 0.0, 0.0, 0.0, 0.0):
        sight = PolicyInput(
            *(batch.observations, every, batch.snapshot, lambda s=share: np.full(8, s), nobody)
        )
        told.append(np.asarray(policy.act(sight).actions)[:4])
        for _ in range(2):
            batch.advance(np.zeros((8, 4)), every)
    assert (speeds(told[0]) > 3.0).all()
    for hidden in told[1:]:
        assert hidden == pytest.approx(told[0], abs=1.0)


def test_what_is_nowhere_is_not_looked_for_in_all_starts():
    def nowhere(part, protocol):
        return [False] * len(part)

    said = r"^protocol 'flown': of 1600 starts in 'citystreet' too few have wings; 25 are needed"
    with pytest.raises(SpawnError, match=said):
        first_fitting([HOME], FLOWN, 25, SEED, fits=nowhere, wanted="wings", tried=400)
