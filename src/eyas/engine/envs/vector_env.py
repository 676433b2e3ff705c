"""The Gymnasium vector environment: N drones, each in a world of its own."""

from collections.abc import Sequence
from typing import Any, Unpack, cast

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space, create_empty_array
from numpy.typing import NDArray

from eyas.engine.core.doors import brought, brought_object, installed
from eyas.engine.core.errors import ConfigError, EyasError, UnknownNameError
from eyas.engine.core.rng import checked_seed
from eyas.engine.envs.batch import Outcome, Truth
from eyas.engine.envs.choice import (
    EnvChoices,
    Source,
    checked_options,
    chosen_settings,
    evading_settings,
    first_seed,
    steps_per_action,
    targets_act,
)
from eyas.engine.envs.information import Info, by_term, masked
from eyas.engine.envs.mixed_batch import MixedBatch
from eyas.engine.envs.notebook import LONGEST_STRIP, strip_html
from eyas.engine.envs.observation import Observation
from eyas.engine.settings.config import EyasConfig
from eyas.lanes.device import Device

# One environment of N, as `call`, `get_attr` and `set_attr` of the vector environment see it.


class SubEnv:
    """One of N environments. It has the attributes that libraries ask for by name, and any that
    `set_attr` gives it.
    """

    def __init__(self, whole: "EyasVectorEnv", index: int) -> None:
        self._whole = whole
        self.index = index
        self.metadata, self.render_mode = whole.metadata, whole.render_mode
        self.observation_space = whole.single_observation_space
        self.action_space = whole.single_action_space

    @property
    def config(self) -> EyasConfig:
        """The settings of this environment."""
        return self._whole.config_of(self.index)

    @property
    def spec(self) -> Any:  # noqa: ANN401  # Gymnasium's
        """The specification, which `gymnasium.make_vec` adds later."""
        return self._whole.spec

    @property
    def _max_episode_steps(self) -> int:
        """Largest number of actions in an episode; LeRobot asks for it by this name."""
        return -(-self.config.done.total_steps // steps_per_action(self.config))

    @property
    def task(self) -> str:
        """The task in words; LeRobot's name."""
        return "track"

    @property
    def task_description(self) -> str:
        """The task in a sentence; LeRobot's name."""
        world = self.config.world
        target = self._whole.words_of(self.index)
        return (
            f"Keep the target, {target}, in view of the drone's camera "
            f"({world.map}, {world.weather})."
        )

    @property
    def unwrapped(self) -> "SubEnv":
        """This environment, which wraps none."""
        return self

    def render(self) -> NDArray[np.uint8] | None:
        """Return the camera's picture in its configured size, shape (H, W, 3)."""
        return self._whole.render_one(self.index)


Mask = NDArray[np.bool_]
Seed = int | Sequence[int | None] | None
Stepped = tuple[Observation, NDArray[np.float64], Mask, Mask, Info]


class EyasVectorEnv(gymnasium.vector.VectorEnv[Observation, Any, Any]):
    """N environments that are stepped together, and drawn with all threads.

    Environment i gives the same as `TrackingEnv` with seed s + i if reset with seed s. Without a
    seed, the first reset takes that of the configuration for s, or a fresh one if it sets none.
    Copies are as those of `TrackingEnv`.

    Args:
        num_envs: N.
        config: Settings, see `eyas.engine.envs.choice.Source`.
        agents: Who acts: `tracker`, or `tracker+target`. Then actions and observations are
            dictionaries with the parts `tracker` and `target`, rewards are those of the trackers,
            and `info["reward/target"]` has those of the targets: see docs/pursuit.md.
        autoreset_mode: When the next episode begins: next step, same step, or by `reset_mask`.
        copy: Whether each step returns new arrays; False: they are written again two steps later.
        render_mode: `rgb_array` or None.
        overlay: As for `TrackingEnv`.
        measures: Whether targets are measured in the pictures, see `truth`.
        device: Where simulation and pictures are computed, and where observations, rewards and ends
            are then arrays, or its name: see `docs/gpu.md`. None: on this processor.
        choices: Settings by keyword, see `eyas.engine.envs.choice.EnvChoices`.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    metadata = {  # noqa: RUF012  # Gymnasium's
        "render_modes": ["rgb_array"],
        "render_fps": 125,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        config: Source = None,
        *,
        agents: str = "tracker",
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        render_mode: str | None = None,
        overlay: bool = False,
        measures: bool = False,
        device: Device | str | None = None,
        **choices: Unpack[EnvChoices],
    ) -> None:
        if not isinstance(num_envs, int | np.integer) or num_envs < 1:
            raise ConfigError(f"num_envs: {num_envs} is not allowed: a whole number, at least 1")
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ConfigError(f"render_mode: '{render_mode}' is not allowed: 'rgb_array' or None")
        self.config = chosen_settings(config, **choices)
        evading = targets_act(agents)
        if evading:
            self.config = evading_settings(self.config)
        if device is not None and self.config.evader.driver is not None:
            raise ConfigError(
                f"evader.driver: '{self.config.evader.driver}' is not allowed with device: targets "
                "move on this processor; allowed there: null"
            )
        self._there: Any = None  # environments on a device, which a house brings
        self._here: MixedBatch | None = None
        if device is None:
            self._here = MixedBatch(self.config, num_envs, measures=measures, evading=evading)
        else:
            kind = device.partition(":")[0] if isinstance(device, str) else "host"
            elsewhere = brought_object("eyas.devices", kind)
            if elsewhere is None:
                known = (*brought("eyas.devices"), *installed("eyas.devices"))
                raise UnknownNameError("device", kind, known)
            self._there = elsewhere(self.config, num_envs, device, measures=measures)
        self.num_envs = num_envs
        self.render_mode = render_mode
        envs = self._there or self._batch
        self.single_action_space = envs.action_space
        self.single_observation_space = envs.observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        env = self.config.env
        rate = round(self.config.control.frequency / env.action_repeat)
        self.metadata = {
            **self.metadata,
            "render_fps": max(rate, 1),
            "autoreset_mode": self.autoreset_mode,
        }
        self._overlay = overlay
        self._all = np.ones(num_envs, np.bool_)
        self._begun, self._ended = np.zeros((2, num_envs), np.bool_)
        self._ring = [] if copy else [self._new_observations() for _ in range(2)]
        self._sub_envs = [SubEnv(self, index) for index in range(num_envs)]

    def reset(
        self,
        *,
        seed: Seed = None,
        options: dict[str, Any] | None = None,
        out: Observation | None = None,
    ) -> tuple[Observation, Info]:
        """Begin new episodes.

        Args:
            seed: s, s + 1, ... for a number s; or a list with the seed of each, or None to continue
                its sequence of episodes.
            options: `reset_mask` chooses the environments to reset, bool, shape (N,); the
                observations of the others stay as they are.
            out: Arrays to write the observations into; they are returned.

        Raises:
            EyasError: An option or a seed is wrong; one line.
            ClosedEnvironmentError: The environments are closed; Gymnasium's, as in `step`.
        """
        self._check_open()
        chosen = self._chosen(options)
        envs = self._there or self._batch
        envs.begin(chosen, self._seeds(seed, chosen))
        self._begun |= chosen
        envs.look(chosen, chosen)
        self._ended[chosen] = False
        if self._there is not None:
            return self._observations(out), masked({"seed": self._there.seeds}, chosen)
        info = masked(self._batch.info(), chosen)
        # Names are those after a step: TorchRL stacks all information.
        none = {name: np.zeros(self.num_envs) for name in self._batch.terms}
        info |= masked(by_term(none), np.zeros(self.num_envs, np.bool_))
        return self._observations(out), info

    def step(self, actions: Any, *, out: Observation | None = None) -> Stepped:  # noqa: ANN401  # as in Gymnasium
        """Hold an action in each environment.

        Args:
            actions: N actions.
            out: Arrays to write the observations into; they are returned.

        Returns:
            Observations, rewards, terminations, truncations, information: see
            `eyas.engine.envs.information`, and, in the mode `SAME_STEP`, the last observation
            (`final_obs`) and information (`final_info`) of the episodes that have ended.

        Raises:
            ActionError: An action is not in the space of actions.
            ResetNeeded: No episode has begun.
        """
        self._check_open()
        if not self._begun.any():
            raise ResetNeeded("step: call reset first")
        begin = self._ended
        if self.autoreset_mode == AutoresetMode.DISABLED:
            assert not begin.any(), f"environments {np.flatnonzero(begin)} must be reset first"
        if self._there is not None:
            return self._step_there(self._there, actions, out)
        outcome = self._batch.step(actions, ~begin)
        self._ended, final = outcome.terminated | outcome.truncated, {}
        if self.autoreset_mode == AutoresetMode.SAME_STEP:
            begin, self._ended = self._ended, np.zeros(self.num_envs, np.bool_)
            final = self._final(begin, outcome)
        if begin.any():
            self._batch.begin(begin)
        self._batch.look(self._all, begin)
        info = {**masked(self._batch.info(), self._all), **final}
        info |= masked(by_term(outcome.terms), ~begin)
        return (
            self._observations(out),
            outcome.reward,
            outcome.terminated,
            outcome.truncated,
            info,
        )

    def _step_there(
        self,
        envs: Any,  # noqa: ANN401  # see `_there`
        actions: Any,  # noqa: ANN401  # as in Gymnasium
        out: Observation | None,
    ) -> Stepped:
        """Hold an action in each environment on a device, see `step`."""
        begin = self._ended
        reward, terminated, truncated = envs.step(actions, ~begin)
        self._ended, info = envs.ended, {}
        if self.autoreset_mode == AutoresetMode.SAME_STEP:
            begin, self._ended = self._ended, np.zeros(self.num_envs, np.bool_)
            if begin.any():
                envs.look(begin, self._ended, final=True)
                info = {"final_obs": envs.latest(final=True), "_final_obs": begin}
        if begin.any():
            envs.begin(begin)
        envs.look(self._all, begin)
        return self._observations(out), reward, terminated, truncated, info

    @property
    def _batch(self) -> MixedBatch:
        """The environments on this processor; `EyasError` if they are on a device."""
        if self._here is None:
            raise EyasError("device: it is not known here what only this processor knows")
        return self._here

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return the cameras' pictures in their configured sizes, each of shape (H, W, 3)."""
        if self.render_mode is None:
            return None
        return tuple(map(self.render_one, range(self.num_envs)))

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:  # noqa: ANN401  # anything
        """Return an attribute of each environment, or call it if it is a method.

        The attributes are those of `eyas.engine.envs.vector_env.SubEnv`.
        """
        values = self.get_attr(name)
        return tuple(value(*args, **kwargs) if callable(value) else value for value in values)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return an attribute of each environment."""
        return tuple(getattr(sub_env, name) for sub_env in self._sub_envs)

    def set_attr(self, name: str, values: Any) -> None:  # noqa: ANN401  # anything
        """Give each environment an attribute: one value for all, or a list or tuple with N."""
        each = values if isinstance(values, list | tuple) else [values] * self.num_envs
        for sub_env, value in zip(self._sub_envs, each, strict=True):
            setattr(sub_env, name, value)

    def sub_env(self, index: int) -> SubEnv:
        """Return what libraries see of one environment."""
        return self._sub_envs[index]

    def truth(self) -> Truth:
        """Return what is true now, for teachers; an observation shows none of it."""
        return self._batch.truth() if self._there is None else self._there.truth()

    def config_of(self, index: int) -> EyasConfig:
        """Return the settings of one environment."""
        return self.config if self._here is None else self._here.config_of(index)

    def words_of(self, index: int) -> str:
        """Return the target of one environment in words that tell it from what else is in view."""
        return self._batch.words_of(index)

    def render_one(self, index: int) -> NDArray[np.uint8]:
        """Return the picture of one camera in its configured size, shape (H, W, 3)."""
        return self._batch.render(index, overlay=self._overlay)

    def _repr_html_(self) -> str:
        """Return a strip of the first cameras' pictures, for notebooks."""
        name = f"{self.num_envs} environments: {self.config.world.map}, {self.config.world.weather}"
        if self._here is None or self.closed or not self._begun.any():
            return strip_html([], name)
        shown = range(min(self.num_envs, LONGEST_STRIP))
        return strip_html([self.render_one(index) for index in shown], name)

    def close_extras(self, **_: Any) -> None:  # noqa: ANN401  # Gymnasium's
        """Close the logs and end live traffic."""
        if self._here is not None:
            self._here.close()

    def _final(self, ended: Mask, outcome: Outcome) -> Info:
        """Return the last observations and information of episodes that have ended."""
        if not ended.any():
            return {}
        self._batch.look(ended, np.zeros(self.num_envs, np.bool_))
        observations = np.full(self.num_envs, None, object)
        for index in np.flatnonzero(ended).tolist():
            observations[index] = self._batch.one(index)
        info = self._batch.info() | by_term(outcome.terms)
        return masked({"final_obs": observations, "final_info": info}, ended)

    def _observations(self, out: Observation | None) -> Observation:
        """Return the latest observations in the caller's arrays, the next of the ring, or new."""
        if out is None and self._ring:
            self._ring.reverse()
            out = self._ring[0]
        if self._there is not None:
            latest: Observation = self._there.latest(out)
            return latest
        out = self._new_observations() if out is None else out
        self._batch.copy_to(out)
        return out

    def _new_observations(self) -> Observation:
        if self._there is not None:
            return cast("Observation", self._there.latest())
        new: Any = create_empty_array(self.single_observation_space, self.num_envs)
        return cast("Observation", new)

    def _chosen(self, options: dict[str, Any] | None) -> Mask:
        """Return which environments to reset."""
        advice = "; `env.mixture` gives environments settings of their own"
        if options is None or "reset_mask" not in checked_options(options, ["reset_mask"], advice):
            return self._all
        mask = options.pop("reset_mask")  # Gymnasium's environments take it out, too
        fits = isinstance(mask, np.ndarray) and mask.dtype == np.bool_
        if not fits or mask.shape != (self.num_envs,) or not mask.any():
            raise ConfigError(
                "options['reset_mask']: not allowed: a bool array of shape "
                f"({self.num_envs},) with at least one True"
            )
        chosen: Mask = mask.copy()
        return chosen

    def _seeds(self, seed: Seed, chosen: Mask) -> list[int | None]:
        """Return the seed of each environment, None where it continues."""
        each: list[int | None] = [None] * self.num_envs
        if seed is None:
            pass
        elif isinstance(seed, str) or not isinstance(seed, Sequence | np.ndarray):
            each = self._seeds_from(checked_seed(seed))
        elif len(seed) != self.num_envs:
            raise ConfigError(f"seed: {len(seed)} are given for {self.num_envs} environments")
        else:
            each = [None if one is None else checked_seed(one) for one in seed]
        if self._begun[chosen].all():
            return each
        first = self._seeds_from(first_seed(self.config))
        pairs = zip(each, first, self._begun.tolist(), strict=True)
        return [own if begun or own is not None else other for own, other, begun in pairs]

    def _seeds_from(self, first: int) -> list[int | None]:
        """Return a seed and those that follow, one for each environment."""
        checked_seed(first + self.num_envs - 1)
        return list(range(first, first + self.num_envs))

    def _check_open(self) -> None:
        if self.closed:
            raise ClosedEnvironmentError("the environments are closed")
