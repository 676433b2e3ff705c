"""Several drones in one world as a PettingZoo environment."""

import logging
from copy import deepcopy
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from numpy.typing import NDArray

from eyas.engine.core.errors import ActionError, ConfigError, MissingExtraError
from eyas.engine.core.rng import checked_seed
from eyas.engine.envs.batch import Batch
from eyas.engine.envs.choice import (
    EnvChoices,
    EpisodeChoices,
    Source,
    chosen_settings,
    first_seed,
    settings_of_kinds,
)
from eyas.engine.envs.information import Info, by_term, of_one
from eyas.engine.envs.observation import Observation
from eyas.engine.envs.play import Window, hover_action

try:
    from pettingzoo import ParallelEnv
except ImportError as error:
    raise MissingExtraError("eyas.engine.envs.pettingzoo", "pettingzoo") from error

_LOG = logging.getLogger("eyas")

Stepped = tuple[
    dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Info]
]


class EyasParallelEnv(ParallelEnv[str, Observation, Any]):  # type: ignore[misc]  # no types where it is not installed
    """N drones, `drone_0` to `drone_<N - 1>`, that share a world and see each other in it.

    Each has a target of its own; if `same_target` is true, all have the same and start on different
    sides of it. A drone whose episode has ended leaves `agents` and hovers where it is; when the
    last has left, `reset` begins new episodes at another time of the traffic. Drones do not
    collide. Observations, actions, rewards and information are those of `TrackingEnv`.

    Args:
        num_drones: N.
        config: Settings, see `eyas.engine.envs.choice.Source`.
        render_mode: `rgb_array`, `human` (a window; extra `play`) or None.
        overlay: As for `TrackingEnv`.
        choices: Settings by keyword, see `eyas.engine.envs.choice.EnvChoices`.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012  # PettingZoo's
        "name": "eyas_v0",
        "render_modes": ["rgb_array", "human"],
        "render_fps": 125,
        "is_parallelizable": True,
    }

    def __init__(
        self,
        num_drones: int = 2,
        config: Source = None,
        *,
        render_mode: str | None = None,
        overlay: bool = False,
        **choices: Unpack[EnvChoices],
    ) -> None:
        if num_drones < 1:
            raise ConfigError(
                f"num_drones: {num_drones} is not allowed: a whole number, at least 1"
            )
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ConfigError(
                f"render_mode: '{render_mode}' is not allowed: 'rgb_array', 'human' or None"
            )
        self.config = settings_of_kinds(chosen_settings(config, **choices))[0]
        self._batch = Batch(self.config, num_drones, shared=True)
        self.possible_agents = [f"drone_{n}" for n in range(num_drones)]
        self.agents: list[str] = []
        self.observation_spaces: dict[str, gymnasium.Space[Any]] = {}
        self.action_spaces: dict[str, gymnasium.Space[Any]] = {}
        for agent in self.possible_agents:  # of their own, since spaces hold random numbers
            self.observation_spaces[agent] = deepcopy(self._batch.observer.space)
            self.action_spaces[agent] = deepcopy(self._batch.actions.space)
        rate = self.config.control.frequency / self.config.env.action_repeat
        self.metadata = {**self.metadata, "render_fps": max(round(rate), 1)}
        self.render_mode = render_mode
        self._overlay = overlay
        self._begun = self._closed = False
        self._window = Window(self.metadata["render_fps"]) if render_mode == "human" else None

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the space of a drone's observations."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the space of a drone's actions."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, Info]]:
        """Begin new episodes of all drones.

        Args:
            seed: Begin the sequence of episodes of this seed; None continues the current sequence,
                at first that of the configuration's seed, or of a fresh one if it sets none.
                `info["seed"]` names it.
            options: Without effect. PettingZoo's checker gives unknown ones, so these are only
                logged.

        Raises:
            EyasError: The seed is wrong, or an option is one of `TrackingEnv`; one line.
            ClosedEnvironmentError: The environment is closed; Gymnasium's, as in `step`.
        """
        self._check_open()
        self._check_options(options)
        if seed is not None:
            seed = checked_seed(seed)
        elif not self._begun:
            seed = first_seed(self.config)
        self._batch.begin_together(seed)
        self._begun = True
        self.agents = self.possible_agents[:]
        observations = self._look(begun=True)
        info = self._batch.info()
        self._show()
        return observations, {agent: of_one(info, n) for n, agent in self._flying()}

    def step(self, actions: dict[str, Any]) -> Stepped:
        """Hold an action of each drone in `agents`.

        Raises:
            ActionError: An action is missing, not in the space of actions, or of another drone.
            ResetNeeded: No episode has begun.
        """
        self._check_open()
        if not self._begun:
            raise ResetNeeded("step: call reset first")
        if not self.agents:  # as other environments of PettingZoo do
            return {}, {}, {}, {}, {}
        if set(actions) != set(self.agents):
            raise ActionError(
                f"actions: {', '.join(map(str, actions)) or 'none'}: not allowed: one for each of "
                f"{', '.join(self.agents)}"
            )
        active = np.array([agent in actions for agent in self.possible_agents])
        rest = hover_action(self._batch.actions.space)
        outcome = self._batch.step(
            [actions.get(agent, rest) for agent in self.possible_agents], active
        )
        observations, flying = self._look(begun=False), self._flying()
        info = self._batch.info() | by_term(outcome.terms)
        info["done_reason"] = np.where(active, outcome.reason, info["done_reason"])
        ended = outcome.terminated | outcome.truncated
        self.agents = [agent for n, agent in flying if not ended[n]]
        self._show()
        return (
            observations,
            {agent: float(outcome.reward[n]) for n, agent in flying},
            {agent: bool(outcome.terminated[n]) for n, agent in flying},
            {agent: bool(outcome.truncated[n]) for n, agent in flying},
            {agent: of_one(info, n) for n, agent in flying},
        )

    def render(self) -> NDArray[np.uint8] | None:
        """Return the pictures of all cameras side by side, shape (H, N W, 3).

        None if `render_mode` is `human` (the window always shows the last step) or None.
        """
        return self._pictures() if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Close the window and the logs, and end live traffic; may be called again."""
        self._closed = True
        self._batch.close()
        if self._window is not None:
            self._window.close()

    def _check_options(self, options: dict[str, Any] | None) -> None:
        """Refuse options that elsewhere have an effect; log others."""
        for name in options or {}:
            if name in EpisodeChoices.__annotations__:
                raise ConfigError(
                    f"options: '{name}' is not allowed in a shared world: give it to the "
                    "constructor"
                )
            _LOG.warning("options: %r is without effect", name)

    def _check_open(self) -> None:
        if self._closed:
            raise ClosedEnvironmentError("the environment is closed")

    def _flying(self) -> list[tuple[int, str]]:
        """Return number and name of each drone in `agents`."""
        return [(n, agent) for n, agent in enumerate(self.possible_agents) if agent in self.agents]

    def _look(self, *, begun: bool) -> dict[str, Observation]:
        """Return the observations of the drones in `agents`."""
        flying = self._flying()
        chosen = np.zeros(len(self.possible_agents), np.bool_)
        chosen[[n for n, _ in flying]] = True
        self._batch.look(chosen, np.full(len(chosen), begun))
        return {agent: self._batch.observer.one(n) for n, agent in flying}

    def _pictures(self) -> NDArray[np.uint8]:
        return np.concatenate(self._batch.render(overlay=self._overlay), axis=1)

    def _show(self) -> None:
        if self._window is not None:
            self._window.show(self._pictures())
