"""The Gymnasium environment: one drone, one target."""

from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.rng import checked_seed
from eyas.engine.envs.batch import Batch
from eyas.engine.envs.choice import (
    EnvChoices,
    Source,
    chosen_settings,
    episode_settings,
    first_seed,
    settings_of_kinds,
)
from eyas.engine.envs.information import Info, by_term, of_one
from eyas.engine.envs.notebook import strip_html
from eyas.engine.envs.observation import Observation
from eyas.engine.envs.play import Window, keys_to_action
from eyas.engine.settings.config import EyasConfig

_ONE = np.ones(1, np.bool_)
_GOES_ON = np.zeros(1, np.bool_)


class TrackingEnv(gymnasium.Env[Observation, Any]):
    """Keep a moving target in view.

    The observation is what the camera sees, RGB uint8, shape (84, 84, 3): the configured 4:3 view
    scaled to a square, as in the original; `env.observation` changes it. `info` holds by name what
    `eyas.engine.envs.information` names, and after a step the terms of the reward.

    A copy, by `copy.deepcopy` or `pickle`, goes on where the environment is. One with live traffic
    or with logs cannot be copied.

    Args:
        config: Settings, see `eyas.engine.envs.choice.Source`.
        render_mode: `rgb_array`, `human` (a window; extra `play`) or None.
        overlay: Whether `render` draws the overlay: the ground that the camera sees, the area in
            which the target is rewarded, and a marker over the target. Observations never show it.
        choices: Settings by keyword, see `eyas.engine.envs.choice.EnvChoices`.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    metadata = {  # noqa: RUF012  # Gymnasium's
        "render_modes": ["rgb_array", "human"],
        "render_fps": 125,
    }

    def __init__(
        self,
        config: Source = None,
        *,
        render_mode: str | None = None,
        overlay: bool = False,
        **choices: Unpack[EnvChoices],
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ConfigError(
                f"render_mode: '{render_mode}' is not allowed: 'rgb_array', 'human' or None"
            )
        self.config = settings_of_kinds(chosen_settings(config, **choices))[0]
        self._own = self._batch = Batch(self.config, 1)
        self.action_space = self._batch.actions.space
        self.observation_space = self._batch.observer.space
        env = self.config.env
        rate = self.config.control.frequency / env.action_repeat
        self.metadata = {**self.metadata, "render_fps": max(round(rate), 1)}
        self.render_mode = render_mode
        self._overlay = overlay
        self._begun = self._closed = False
        self._window = Window(self.metadata["render_fps"]) if render_mode == "human" else None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        """Start a new episode; the returned observation shows its target.

        Args:
            seed: Begin the sequence of episodes of this seed; None continues the current sequence,
                at first that of the configuration's seed, or of a fresh one if it sets none.
                `info["seed"]` names it.
            options: What is different in this episode only: `map`, `weather`, `target` (names) and
                `start` (settings of `start`), see `eyas.engine.envs.choice.EpisodeChoices`.

        Raises:
            EyasError: An option or the seed is wrong; one line.
            ClosedEnvironmentError: The environment is closed; Gymnasium's, as in `step`.
        """
        self._check_open()
        if seed is not None:
            seed = checked_seed(seed)
        elif not self._begun:
            seed = first_seed(self.config)
        self._enter(episode_settings(self.config, options))
        super().reset(seed=seed)
        self._batch.begin(_ONE, [seed])
        self._begun = True
        self._batch.look(_ONE, _ONE)
        self._show()
        return self._batch.observer.one(0), of_one(self._batch.info(), 0)

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, Info]:  # noqa: ANN401  # as in Gymnasium
        """Hold an action as `control.frequency` says: for 4 physics steps of 2 ms at 125 Hz.

        Raises:
            ActionError: The action is not in the space of actions.
            ResetNeeded: No episode has begun.
        """
        self._check_begun("step")
        outcome = self._batch.step([action], _ONE)
        self._batch.look(_ONE, _GOES_ON)
        info = self._batch.info() | by_term(outcome.terms)
        self._show()
        return (
            self._batch.observer.one(0),
            float(outcome.reward[0]),
            bool(outcome.terminated[0]),
            bool(outcome.truncated[0]),
            of_one(info, 0),
        )

    def render(self) -> NDArray[np.uint8] | None:
        """Return the camera's picture in its configured size, shape (H, W, 3).

        None if `render_mode` is `human` (the window always shows the last step) or None.
        """
        self._check_begun("render")
        if self.render_mode != "rgb_array":
            return None
        picture: NDArray[np.uint8] = self._batch.render(overlay=self._overlay)[0]
        return picture

    def get_keys_to_action(self) -> dict[tuple[str, ...], Any]:
        """Return the keys of `gymnasium.utils.play`, see `eyas.engine.envs.play`."""
        return keys_to_action(self.config.env)

    def close(self) -> None:
        """Close the window and the logs, and end live traffic; may be called again."""
        self._closed = True
        self._own.close()
        self._batch.close()
        if self._window is not None:
            self._window.close()

    def _repr_html_(self) -> str:
        """Return the camera's picture and what it is of, for notebooks."""
        name = f"{self._batch.config.world.map}, {self._batch.config.world.weather}"
        if self._closed or not self._begun:
            return strip_html([], f"{name}: {'closed' if self._closed else 'call reset'}")
        pictures = self._batch.render(overlay=self._overlay)
        return strip_html(list(pictures), f"{name}: {self._batch.words_of(0)}")

    def _enter(self, config: EyasConfig) -> None:
        """Make the next episode one with these settings."""
        last = self._batch
        if config == last.config:
            return
        self._batch = self._own if config == self.config else Batch(config, 1)
        self._batch.continue_from(last)
        if last is not self._own:
            last.close()

    def _check_open(self) -> None:
        if self._closed:
            raise ClosedEnvironmentError("the environment is closed")

    def _check_begun(self, call: str) -> None:
        self._check_open()
        if not self._begun:
            raise ResetNeeded(f"{call}: call reset first")

    def _show(self) -> None:
        if self._window is not None:
            self._window.show(self._batch.render(overlay=self._overlay)[0])
