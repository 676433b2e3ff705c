"""A window, and play by keys, with pygame's dummy screen."""

import gymnasium
import numpy as np
import pytest

from eyas.engine.envs.play import hover_action
from eyas.engine.envs.tracking_env import TrackingEnv


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
