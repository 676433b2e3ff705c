"""A window, and play by keys, with pygame's dummy screen."""

import gymnasium
import numpy as np
import pytest

from eyas.engine.envs.play import hover_action, keys_to_action
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.settings.env import EnvConfig


@pytest.fixture
def pygame(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    return pytest.importorskip("pygame")


def test_the_window_shows_the_camera(pygame):
    env = TrackingEnv(render_mode="human")
    other = TrackingEnv(render_mode="rgb_array")
    env.reset(seed=1), other.reset(seed=1)
    env.step(0), other.step(0)
    assert env.render() is None
    shown = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
    assert np.array_equal(shown, other.render())
    env.close()
    assert pygame.display.get_surface() is None


@pytest.mark.parametrize("actions", ["discrete", "shares", "velocity"])
@pytest.mark.filterwarnings("ignore:.*matplotlib:UserWarning")
def test_keys_fly_the_drone(pygame, actions):
    from gymnasium.utils import play

    env = gymnasium.make("eyas/citystreet-day-v0", actions=actions, render_mode="rgb_array")
    told = []

    def after(*step):
        told.append(step[2])
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_w))
        if len(told) == 4:
            pygame.event.post(pygame.event.Event(pygame.QUIT))

    play.play(env, callback=after, noop=hover_action(env.action_space), fps=1000, seed=0)
    forward = {"discrete": 0, "shares": [1, 0, 0, 0], "velocity": [40, 0, 0, 0]}[actions]
    assert np.array_equal(told[0], hover_action(env.action_space))
    assert np.array_equal(told[-1], forward)
    assert TrackingEnv(actions=actions).action_space.contains(told[-1])


def test_each_key_moves_as_its_place_on_the_keyboard_says():
    keys = keys_to_action(EnvConfig(actions="shares"))
    axes = {"w": 0, "a": 1, "r": 2, "q": 3}  # forward, left, up, counter-clockwise
    against = {"s": 0, "d": 1, "f": 2, "e": 3}
    for pressed, sign in ((axes, 1.0), (against, -1.0)):
        for key, axis in pressed.items():
            assert keys[key,].tolist() == (sign * np.eye(4)[axis]).tolist()
    assert keys["w", "a"].tolist() == [1.0, 1.0, 0.0, 0.0]
    assert ("w", "s") not in keys
    numbered = keys_to_action(EnvConfig(actions="discrete"))
    assert numbered == {("w",): 0, ("s",): 1, ("a",): 2, ("d",): 3, ("q",): 4, ("e",): 5}
