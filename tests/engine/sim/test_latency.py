"""Late actions and late sight."""

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.envs.observation import Observer
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.env import ObservationConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import ControlConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture

rng = np.random.default_rng(5)
COMMANDS = rng.uniform([-20, -20, -0.01, -2], [20, 20, 0.01, 2], (12, 2, 4))
CHOICE = {"choice": [0.0, 3.0, 10.0]}


def simulation_of(config, **control):
    late = config.model_copy(update={"control": ControlConfig(**control)})
    simulation = build_simulation(late, each_alone(2))
    simulation.reset()
    return simulation


def track(simulation, commands, steps=4):
    """Positions after each command."""
    places = []
    for command in commands:
        simulation.advance(command, steps)
        places.append(simulation.snapshot.trackers.position.copy())
    return np.array(places)


def by_step(commands, late):
    """Each physics step's command, if commands of 4 steps take effect late."""
    every = np.repeat(commands, 4, axis=0)
    return np.concatenate([np.zeros((late, 2, 4)), every])[: len(every)]


@pytest.mark.parametrize("late", [1, 3, 4, 7, 40])
def test_actions_take_effect_so_many_steps_later(config, late):
    seen = track(simulation_of(config, action_latency_steps=float(late)), COMMANDS)
    expected = track(simulation_of(config), by_step(COMMANDS, late), 1)[3::4]
    assert np.array_equal(seen, expected)


def test_each_episode_has_a_latency_of_its_own_and_begins_hovering(config):
    simulation = simulation_of(config, action_latency_steps=CHOICE)
    drawn = set()
    for _ in range(8):
        simulation.reset()
        start = simulation.snapshot.trackers.position.copy()
        moved = track(simulation, np.tile([5.0, 0.0, 0.0, 0.0], (20, 2, 1)), 1) != start
        drawn |= set(moved.any(axis=2).argmax(axis=0).tolist())
    assert drawn == {0, 3, 10}


def test_a_reset_forgets_commands_that_are_under_way(config):
    simulation = simulation_of(config, action_latency_steps=10.0)
    track(simulation, np.full((3, 2, 4), 5.0))
    simulation.reset()
    start = simulation.snapshot.trackers.position.copy()
    assert (track(simulation, np.zeros((10, 2, 4))) == start).all()


def test_a_tracker_whose_time_stands_still_keeps_its_commands_for_later(config):
    simulation = simulation_of(config, action_latency_steps=6.0)
    simulation.advance(COMMANDS[0], 4)
    for command in COMMANDS[1:4]:
        simulation.advance(command, 4, np.array([True, False]))
    alone = track(simulation_of(config, action_latency_steps=6.0), COMMANDS[:4])[-1]
    assert np.array_equal(simulation.snapshot.trackers.position[0], alone[0])


@pytest.mark.parametrize("late", [2, 4, 9])
def test_agents_see_the_state_of_so_many_steps_ago(config, late):
    simulation = simulation_of(config, observation_latency_steps=float(late))
    steps = by_step(COMMANDS, 0)
    now = simulation_of(config)
    past = [now.snapshot.copy()]
    for command in steps:
        now.advance(command, 1)
        past.append(now.snapshot.copy())
    for k, command in enumerate(COMMANDS):
        simulation.advance(command, 4)
        seen = simulation.view.state.snapshot
        then = past[max(4 * (k + 1) - late, 0)]
        for record, expected in zip(seen[:4], then[:4], strict=True):
            for array, other in zip(record, expected, strict=True):
                assert np.array_equal(array, other)
    # The truth is on time.
    assert np.array_equal(simulation.snapshot.trackers.position, now.snapshot.trackers.position)


def test_pictures_and_sensors_are_those_of_then(config):
    late, now = simulation_of(config, observation_latency_steps=8.0), simulation_of(config)
    sight = ObservationConfig(parts=("image", "sensors"), width=32, height=24)
    every, begun = np.arange(2, dtype=np.int32), np.zeros(2, np.bool_)
    seen = {"image": np.zeros((2, 24, 32, 3), np.uint8), "sensors": np.zeros((2, 19), np.float32)}
    then = [{name: array.copy() for name, array in seen.items()} for _ in range(6)]
    observers = Observer(sight, late), Observer(sight, now)
    for k, command in enumerate(COMMANDS[:6]):
        for simulation in (late, now):
            simulation.advance(command, 4)
        observers[1].look(every, begun)
        observers[1].copy_to(then[k], slice(None))
        observers[0].look(every, begun)
        observers[0].copy_to(seen, slice(None))
        if k >= 2:
            for name, array in seen.items():
                assert np.array_equal(array, then[k - 2][name])
    picture = Picture.create(2, 24, 32)
    late.draw(every, picture)  # recordings are on time
    assert np.array_equal(picture.rgb, then[5]["image"])


def test_a_reset_forgets_what_was_seen_before_it(config):
    simulation = simulation_of(config, observation_latency_steps=50.0)
    track(simulation, COMMANDS)
    simulation.reset(np.array([True, False]))
    seen, now = simulation.view.state.snapshot, simulation.snapshot
    assert np.array_equal(seen.trackers.position[0], now.trackers.position[0])
    assert not np.array_equal(seen.trackers.position[1], now.trackers.position[1])
    first = now.trackers.position[0].copy()
    simulation.advance(COMMANDS[0], 4)
    assert np.array_equal(seen.trackers.position[0], first)


def test_environments_are_late_too_and_no_draw_changes_another():
    changes = {"control": {"action_latency_steps": CHOICE, "observation_latency_steps": 6.0}}
    runs = []
    for config in ({}, changes, changes):
        env = EyasVectorEnv(2, config, observation={"width": 16, "height": 16})
        first, info = env.reset(seed=4)
        steps = [env.step(np.array([0, 4])) for _ in range(4)]
        runs.append((first, info["position"], steps))
    plain, late, again = runs
    assert np.array_equal(plain[0], late[0])
    assert np.array_equal(plain[1], late[1])
    assert np.array_equal(late[2][0][0], late[0])  # after 4 steps, what is seen is the start
    assert not np.array_equal(plain[2][0][0], late[2][0][0])
    for one, other in zip(late[2], again[2], strict=True):
        assert np.array_equal(one[0], other[0])
        assert np.array_equal(one[1], other[1])


def test_a_latency_out_of_range_is_told_in_one_line():
    with pytest.raises(ConfigError, match=r"^action_latency_steps: -1\.0 is not allowed: "):
        ControlConfig(action_latency_steps=-1.0)
