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
from eyas.engine.envs.batch import Batch, Evading, Outcome
from eyas.engine.envs.choice import (
    EnvChoices,
    EpisodeChoices,
    Source,
    chosen_settings,
    evading_settings,
    first_seed,
    settings_of_kinds,
    targets_act,
)
from eyas.engine.envs.evader_view import evader_actions
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

    With `agents="tracker+target"`, the targets are agents, too, `target_0` to `target_<N - 1>`
    (`target_0` alone if `same_target` is true): docs/pursuit.md. A target leaves `agents` with the
    last drone that follows it.

    Args:
        num_drones: N; None: 2, or 1 if targets are agents.
        config: Settings, see `eyas.engine.envs.choice.Source`.
        agents: Who acts: `tracker`, or `tracker+target`.
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
        num_drones: int | None = None,
        config: Source = None,
        *,
        agents: str = "tracker",
        render_mode: str | None = None,
        overlay: bool = False,
        **choices: Unpack[EnvChoices],
    ) -> None:
        evading = targets_act(agents)
        if num_drones is None:
            num_drones = 1 if evading else 2
        if not isinstance(num_drones, int | np.integer) or num_drones < 1:
            raise ConfigError(
                f"num_drones: {num_drones} is not allowed: a whole number, at least 1"
            )
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ConfigError(
                f"render_mode: '{render_mode}' is not allowed: 'rgb_array', 'human' or None"
            )
        self.config = settings_of_kinds(chosen_settings(config, **choices))[0]
        if evading:
            self.config = evading_settings(self.config)
        self._batch = Batch(self.config, num_drones, shared=True)
        self._drones = [f"drone_{n}" for n in range(num_drones)]
        self._targets: list[str] = []
        if evading:
            count = 1 if self.config.same_target else num_drones
            self._targets = [f"target_{n}" for n in range(count)]
        self.possible_agents = [*self._drones, *self._targets]
        self.agents: list[str] = []
        self.observation_spaces: dict[str, gymnasium.Space[Any]] = {}
        self.action_spaces: dict[str, gymnasium.Space[Any]] = {}
        for agent in self._drones:  # of their own, since spaces hold random numbers
            self.observation_spaces[agent] = deepcopy(self._batch.observer.space)
            self.action_spaces[agent] = deepcopy(self._batch.actions.space)
        for agent in self._targets:
            view = self._batch.evader_view
            self.observation_spaces[agent] = deepcopy(view.space)
            self.action_spaces[agent] = deepcopy(view.actions)
        rate = self.config.control.frequency / self.config.env.action_repeat
        self.metadata = {**self.metadata, "render_fps": max(round(rate), 1)}
        self.render_mode = render_mode
        self._overlay = overlay
        self._begun = self._closed = False
        self._window = Window(self.metadata["render_fps"]) if render_mode == "human" else None

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the space of an agent's observations."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the space of an agent's actions."""
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
        return observations, {agent: of_one(info, n) for n, agent in self._acting()}

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
            missing = [agent for agent in self.agents if agent not in actions]
            others = [str(agent) for agent in actions if agent not in self.agents]
            wrong = f"no {', '.join(missing)}" if missing else f"{', '.join(others):.80}"
            raise ActionError(
                f"actions: {wrong}: not allowed: one for each of {', '.join(self.agents)}"
            )
        active = np.array([agent in actions for agent in self._drones])
        rest = hover_action(self._batch.actions.space)
        evading = self._evading(actions)
        outcome = self._batch.step(
            [actions.get(agent, rest) for agent in self._drones], active, evading
        )
        observations, acting = self._look(begun=False), self._acting()
        info = self._batch.info() | by_term(outcome.terms)
        info["done_reason"] = np.where(active, outcome.reason, info["done_reason"])
        rewards = {}
        for n, agent in acting:
            if agent in self._drones:
                rewards[agent] = float(outcome.reward[n])
            else:
                assert evading is not None
                rewards[agent] = float(evading.reward[self._followers(n)].sum())
        terminated, truncated = self._ends(outcome, active, acting)
        self.agents = [a for _, a in acting if not (terminated[a] or truncated[a])]
        self._show()
        told = {agent: of_one(info, n) for n, agent in acting}
        return observations, rewards, terminated, truncated, told

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

    def _acting(self) -> list[tuple[int, str]]:
        """Return number and name of each agent in `agents`, the drones first."""
        every = (*enumerate(self._drones), *enumerate(self._targets))
        return [(n, agent) for n, agent in every if agent in self.agents]

    def _followers(self, target: int) -> NDArray[np.bool_]:
        """Return which drones follow a target, shape (N,)."""
        return np.asarray(self._batch.evaders.owner == target)

    def _evading(self, actions: dict[str, Any]) -> Evading | None:
        """Return what targets do; None: they are no agents."""
        if not self._targets:
            return None
        evading = Evading(self.config, len(self._drones))
        evading.actions[:] = self._batch.evaders.wanted(np.arange(len(self._drones)))
        for n, agent in enumerate(self._targets):
            if agent in actions:
                own = evader_actions([actions[agent]], 1, f"actions[{agent!r}]")
                evading.actions[self._followers(n)] = own
        return evading

    def _ends(
        self, outcome: Outcome, active: NDArray[np.bool_], acting: list[tuple[int, str]]
    ) -> tuple[dict[str, bool], dict[str, bool]]:
        """Return whose episodes have ended, and by the number of steps."""
        terminated, truncated = {}, {}
        goes_on = active & ~outcome.terminated & ~outcome.truncated
        for n, agent in acting:
            mine = np.arange(len(active)) == n
            if agent in self._targets:
                mine = self._followers(n)
            over = not goes_on[mine].any()
            truncated[agent] = bool(over and outcome.truncated[mine].any())
            terminated[agent] = bool(over and not truncated[agent])
        return terminated, truncated

    def _look(self, *, begun: bool) -> dict[str, Observation]:
        """Return the observations of the agents in `agents`."""
        acting = self._acting()
        chosen = np.zeros(len(self._drones), np.bool_)
        chosen[[n for n, agent in acting if agent in self._drones]] = True
        self._batch.look(chosen, np.full(len(chosen), begun))
        seen = {a: self._batch.observer.one(n) for n, a in acting if a in self._drones}
        driven = [(n, agent) for n, agent in acting if agent in self._targets]
        if driven:
            told = self._batch.evader_view.look(np.array([n for n, _ in driven], np.int32))
            seen |= {agent: told[n].copy() for n, agent in driven}
        return seen

    def _pictures(self) -> NDArray[np.uint8]:
        return np.concatenate(self._batch.render(overlay=self._overlay), axis=1)

    def _show(self) -> None:
        if self._window is not None:
            self._window.show(self._pictures())
