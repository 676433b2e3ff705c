"""Targets that are agents: what they may do, what they see and get, and that bytes are the same."""

import copy
from typing import Any

import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.sim.scenes import load_network
from eyas.engine.traffic.steering import Others, SteeredCars
from eyas.engine.traffic.ways import LEFT, RIGHT, STRAIGHT, ways_of

SMALL: dict[str, Any] = {"observation": {"width": 16, "height": 16}, "action_repeat": 25}
LONG = {
    "done": {"total_steps": 15_000, "no_reward_steps": 2**31 - 1},
    "start": {"vehicles": ["passenger"]},
    "extras": [],
}
WALK = {**LONG, "start": {}}


def pursuit(count: int, config: Any = LONG, **choices: Any) -> EyasVectorEnv:
    return EyasVectorEnv(count, config, agents="tracker+target", **SMALL, **choices)


def act(count: int, *target: float) -> dict[str, Any]:
    return {"tracker": np.full(count, 6), "target": np.tile(np.array(target), (count, 1))}


@pytest.mark.slow
@pytest.mark.parametrize("sees", ["tracker", "picture"])
def test_pettingzoos_own_tests_pass_with_targets_that_act(official, sees):
    env_class = pytest.importorskip("eyas.engine.envs.pettingzoo").EyasParallelEnv
    changes = {"done": {"total_steps": 160}, "evader": {"sees": sees}, "extras": []}

    def make(**more: Any) -> Any:
        return env_class(config=changes | more, agents="tracker+target", **SMALL)

    official.parallel_api_test(make(), num_cycles=20)
    official.parallel_seed_test(make, num_cycles=20)


@pytest.mark.slow
def test_drones_with_one_target_have_one_opponent_which_gets_what_they_lose():
    env_class = pytest.importorskip("eyas.engine.envs.pettingzoo").EyasParallelEnv
    env = env_class(2, LONG | {"same_target": True}, agents="tracker+target", **SMALL)
    env.reset(seed=3)
    assert env.agents == ["drone_0", "drone_1", "target_0"]
    _, reward, *_ = env.step({"drone_0": 6, "drone_1": 6, "target_0": np.array([10.0, 0.0])})
    assert reward["drone_0"] > 0.0
    assert reward["target_0"] == -(reward["drone_0"] + reward["drone_1"])


@pytest.mark.slow
@pytest.mark.parametrize(("target", "config"), [("SUMO_VEHICLE", LONG), ("Pedestrian", WALK)])
def test_bytes_depend_neither_on_the_number_of_environments_nor_on_the_place_among_them(
    target, config
):
    def flown(count: int, seed: int) -> list[bytes]:
        env = pursuit(count, config, target=target, max_episode_steps=8)
        parts = [b""] * count
        seen, _ = env.reset(seed=seed)
        for step in range(12):  # over the end of an episode
            rng = np.random.default_rng(step)
            wish = rng.uniform(env.single_action_space["target"].low, [3.0, 1.0])
            seen, reward, *_, info = env.step(act(count, *wish))
            for n in range(count):
                told = seen["tracker"][n], seen["target"][n], reward[n], info["reward/target"][n]
                parts[n] += b"".join(one.tobytes() for one in told)
        return parts

    together = flown(8, 5)
    assert [flown(1, 5)[0], flown(1, 11)[0]] == [together[0], together[6]]
    assert together[0] != together[6]


@pytest.mark.slow
def test_a_target_that_turns_leaves_the_way_it_was_on_and_stays_on_the_roads():
    turned, ways = {}, ways_of(load_network("citystreet", 0))
    for wish in (-1.0, 0.0, 1.0):
        env = pursuit(6)
        env.reset(seed=2)
        places = []
        for _ in range(120):
            env.step(act(6, 9.0, wish))
            targets = env.truth().snapshot.targets
            places.append(np.column_stack([targets.position[:, :2], targets.yaw]))
        turned[wish] = np.array(places)
    driven = np.concatenate([*turned.values()]).reshape(-1, 3)[::7]
    away = driven[:, None, :2] - ways.place[None]
    assert np.sqrt((away**2).sum(axis=-1).min(axis=1)).max() < 3.6  # as it changes lanes
    change = {wish: places[-1, :, 2] - places[0, :, 2] for wish, places in turned.items()}
    assert change[1.0].max() > 1.2
    assert change[-1.0].min() < -1.2
    apart = np.linalg.norm(turned[1.0][-1, :, :2] - turned[-1.0][-1, :, :2], axis=1)
    assert np.median(apart) > 20.0  # they drive elsewhere


def test_turns_lead_where_they_say_and_lanes_at_the_kerb_turn_to_its_side():
    network = load_network("citystreet", 0)
    ways = ways_of(network)
    for lane in range(len(network.lane_width)):
        for way, sign in ((LEFT, 1.0), (RIGHT, -1.0)):
            if (turn := ways.onward[lane, way]) >= 0:
                first, last = ways.first[turn], ways.first[turn + 1] - 1
                assert sign * (ways.heading[last] - ways.heading[first]) > 0.5
                after = ways.after[turn]
                gap = ways.place[ways.first[after]] - ways.place[last]
                assert np.abs(gap).max() < 1e-6
        if ways.onward[lane, LEFT] >= 0 and ways.onward[lane, STRAIGHT] >= 0:
            assert ways.beside[lane, 0] < 0  # it is the leftmost


def test_a_car_stops_behind_what_stands_on_its_way_and_slows_down_before_curves():
    ways = ways_of(load_network("citystreet", 0))
    lane = int(np.argmax(ways.length[: len(ways.onward)]))
    cars, rows, turn = SteeredCars(ways, 1), np.array([0]), np.array([STRAIGHT])
    begin, stop = ways.at(np.array([lane]), np.array([5.0])), 60.0
    place = ways.at(np.array([lane]), np.array([5.0 + stop])).place
    cars.begin(rows, begin.place, begin.heading, np.array([13.0]), np.array([4.4]))
    still = Others(place[None], np.zeros((1, 1, 2)), np.full((1, 1), 2.2), np.ones((1, 1), bool))
    nobody = still._replace(there=np.zeros((1, 1), bool))
    for _ in range(150):
        cars.advance(rows, np.array([20.0]), turn, still, 0.1)
    gap = np.linalg.norm(cars.place(rows)[0] - place[0]) - 4.4
    assert cars.speed[0] < 0.05
    assert 1.0 < gap < 6.0
    fastest = 0.0
    for _ in range(300):  # round corners, whichever way there is
        cars.advance(rows, np.array([20.0]), np.array([LEFT]), nobody, 0.1)
        on = ways.at(cars.piece, cars.along)
        fastest = max(fastest, float((cars.speed - on.fastest)[0]))
    assert fastest < 1.0


@pytest.mark.slow
def test_a_walker_goes_where_it_wants_but_not_through_solids():
    env = pursuit(8, WALK, target="Pedestrian")
    env.reset(seed=1)
    walkers: Any = env._batch._groups[0].batch._simulation.evaders._walkers
    begun = walkers.at.copy()
    shapely = pytest.importorskip("shapely")
    for _ in range(160):
        env.step(act(8, 0.0, 4.0))
        assert not walkers._blocked(shapely.points(walkers.at), 0.9 * walkers._radius).any()
    went = walkers.at - begun
    assert went[:, 0].max() > 15.0  # east, if nothing is in the way
    assert env.truth().snapshot.targets.speed.max() <= walkers.top + 1e-6


@pytest.mark.slow
def test_the_reward_is_the_trackers_loss_or_the_users_terms():
    env = pursuit(2)
    env.reset(seed=4)
    _, reward, *_, info = env.step(act(2, 8.0, 0.0))
    assert (info["reward/target"] == -reward).all()
    assert reward.any()
    own = pursuit(2, LONG | {"evader": {"reward": {"tests.engine.envs.test_evader:pace": 2.0}}})
    own.reset(seed=4)
    *_, info = own.step(act(2, 8.0, 0.0))
    speed = own.truth().snapshot.targets.speed
    assert info["reward/target"] == pytest.approx(25 * 2.0 * speed, rel=0.2)


def pace(snapshot: Any) -> Any:
    """Return how fast targets are: a term of a reward of one's own."""
    return snapshot.targets.speed.copy()


@pytest.mark.slow
@pytest.mark.parametrize("driver", ["cruise", "abrupt", "hide"])
@pytest.mark.parametrize(("target", "config"), [("SUMO_VEHICLE", LONG), ("Pedestrian", WALK)])
def test_fixed_drivers_drive_and_copies_go_on_as_their_originals(driver, target, config):
    env = EyasVectorEnv(2, config | {"evader": {"driver": driver}}, target=target, **SMALL)
    env.reset(seed=6)
    for _ in range(20):
        env.step(np.full(2, 6))
    other = copy.deepcopy(env)
    for _ in range(20):
        seen, again = env.step(np.full(2, 6))[0], other.step(np.full(2, 6))[0]
        assert (seen == again).all()
    targets, theirs = (each.truth().snapshot.targets for each in (env, other))
    assert (targets.position == theirs.position).all()
    assert targets.travelled.max() > 0.0


@pytest.mark.parametrize(
    ("config", "said"),
    [
        ({"target": "Quadrotor"}, "evader.driver: 'agent': 'Quadrotor' cannot be driven; allowed"),
        (
            {"start": {"vehicles": ["bus"]}, "traffic": {"vehicle_type": {"bus": 1.0}}},
            "evader.driver: 'agent': the traffic has no cars; allowed: traffic.vehicle_type",
        ),
        ({"evader": {"driver": "hide"}}, "evader.driver: 'hide' is not allowed with agents="),
        ({"evader": {"driver": "hidden"}}, "evader.driver: 'hidden' is not allowed"),
    ],
)
def test_what_does_not_fit_is_said_in_a_line(config, said):
    if "traffic" in config:
        pytest.importorskip("libsumo")
    with pytest.raises(EyasError) as error:
        EyasVectorEnv(1, config, agents="tracker+target")
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_other_agents_and_actions_are_refused():
    with pytest.raises(EyasError, match="agents: 'target' is not allowed: 'tracker' or"):
        EyasVectorEnv(1, agents="target")
    with pytest.raises(EyasError, match=r"evader\.driver: 'hide' is not allowed with device"):
        EyasVectorEnv(1, {"evader": {"driver": "hide"}}, device="host")
    env = pursuit(1)
    env.reset(seed=1)
    with pytest.raises(EyasError, match="a dictionary with arrays 'tracker' and 'target'"):
        env.step(np.zeros(1, np.int64))
    with pytest.raises(EyasError, match=r"actions\['target'\]: .* two finite numbers each"):
        env.step(act(1, np.nan, 0.0))
