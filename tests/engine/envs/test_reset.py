"""What may be given to a reset, and when environments may be used."""

import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError, ResetNeeded

from eyas.engine.core.errors import EyasError
from eyas.engine.envs.choice import chosen_settings
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv

SMALL = {"env": {"observation": {"height": 16, "width": 16}}}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "same"),
    [
        ({"weather": "snow"}, {"weather": "snow"}),
        ({"map": "lake", "target": "Pedestrian"}, {"map": "lake", "target": "Pedestrian"}),
    ],
)
def test_options_hold_for_one_episode(options, same):
    env, plain = TrackingEnv(SMALL), TrackingEnv(SMALL)
    changed = TrackingEnv(SMALL, **same)
    seen, _ = env.reset(seed=4, options=options)
    expected, _ = changed.reset(seed=4)
    assert np.array_equal(seen, expected)
    assert all(np.array_equal(env.step(2)[0], changed.step(2)[0]) for _ in range(3))
    plain.reset(seed=4)
    after, _ = env.reset()  # the second episode of seed 4, in the environment's own world
    expected, _ = plain.reset()
    assert np.array_equal(after, expected)
    assert not np.array_equal(seen, after)


def test_an_option_sets_the_start():
    env = TrackingEnv(SMALL)
    _, far = env.reset(seed=4, options={"start": {"height": 60.0}})
    _, near = env.reset(seed=4, options={"start": {"height": 20.0}})
    assert far["position"][2] - near["position"][2] == pytest.approx(40.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"wether": "snow"}, "options: 'wether' is not allowed; did you mean 'weather'?; known"),
        ({"weather": "snwo"}, "world.weather: 'snwo' is not allowed"),
        ({"start": {"hight": 3}}, "start.hight: unknown key"),
        (5, "options: 5 is not allowed: a dictionary or None"),
        ([1], "options: [1] is not allowed: a dictionary or None"),
    ],
)
def test_wrong_options_are_one_line_and_change_nothing(options, message):
    env, alike = TrackingEnv(SMALL), TrackingEnv(SMALL)
    env.reset(seed=1)
    alike.reset(seed=1)
    with pytest.raises(EyasError) as refusal:
        env.reset(options=options)
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)
    assert np.array_equal(env.step(0)[0], alike.step(0)[0])


def test_a_vector_environment_names_the_mixture_for_settings_of_each():
    env = EyasVectorEnv(2, SMALL)
    with pytest.raises(EyasError, match=r"options: 'weather' is not allowed.*env\.mixture"):
        env.reset(options={"weather": "snow"})


@pytest.mark.parametrize("seed", [2**63, 2**64, -1, 1.5, "1", True])
def test_a_wrong_seed_is_one_line(seed):
    env, several = TrackingEnv(SMALL), EyasVectorEnv(2, SMALL)
    for call in (env.reset, several.reset):
        with pytest.raises(EyasError, match=r"^seed: .* is not allowed"):
            call(seed=seed)
    with pytest.raises(EyasError, match=r"^seed: .* is not allowed"):
        several.reset(seed=[0, seed])


def test_the_largest_seeds_are_taken():
    TrackingEnv(SMALL).reset(seed=2**63 - 1)
    EyasVectorEnv(2, SMALL).reset(seed=2**63 - 2)
    with pytest.raises(EyasError, match=f"^seed: {2**63} is not allowed"):
        EyasVectorEnv(2, SMALL).reset(seed=2**63 - 1)


def test_a_step_needs_a_reset_first():
    env, several = TrackingEnv(SMALL), EyasVectorEnv(2, SMALL)
    for call in (lambda: env.step(0), env.render, lambda: several.step([0, 0])):
        with pytest.raises(ResetNeeded):
            call()


def test_a_closed_environment_does_nothing_more():
    env, several = TrackingEnv(SMALL), EyasVectorEnv(2, SMALL)
    env.reset()
    several.reset()
    for closed in (env, several):
        closed.close()
        closed.close()
    for call in (lambda: env.step(0), env.reset, lambda: several.step([0, 0]), several.reset):
        with pytest.raises(ClosedEnvironmentError):
            call()


def test_drones_in_one_world_are_as_strict():
    pytest.importorskip("pettingzoo")
    from eyas.engine.envs.pettingzoo import EyasParallelEnv

    env = EyasParallelEnv(2, SMALL)
    with pytest.raises(ResetNeeded):
        env.step({"drone_0": 0, "drone_1": 0})
    with pytest.raises(EyasError, match=r"^options: 'weather' is not allowed in a shared world"):
        env.reset(options={"weather": "snow"})
    with pytest.raises(EyasError, match=r"^seed: "):
        env.reset(seed=2**63)
    env.close()
    with pytest.raises(ClosedEnvironmentError):
        env.reset()


@pytest.mark.parametrize("config", [5, [], 1.5, b"easy"])
def test_settings_of_a_wrong_type_are_one_line(config):
    with pytest.raises(EyasError, match=r"^config: .* is not allowed: an EyasConfig"):
        chosen_settings(config)
