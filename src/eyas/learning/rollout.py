"""Rollouts: what environments, network and teacher did in T decisions."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from torch import Tensor

from eyas.benchmark.policies.predictors import ConstantVelocity
from eyas.benchmark.policies.sighted import Clue, SightOracle
from eyas.engine.envs.batch import Truth
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.policies.policy import PolicyInput, Start
from eyas.engine.settings.config import EyasConfig
from eyas.learning.algorithm import phases_of
from eyas.learning.config import TeacherKind, TrainConfig
from eyas.learning.network import AnyNetwork, torch_device


class _ExactOracle(SightOracle):
    """Knows where the target is even while it is hidden."""

    def _places(self, clue: Clue, sight: PolicyInput) -> NDArray[np.float64]:
        places: NDArray[np.float64] = sight.snapshot().targets.centre[:, :2]
        return places


_ORACLES = {TeacherKind.SIGHTED: SightOracle, TeacherKind.EXACT: _ExactOracle}


class Teacher:
    """Tells the right actions in N environments."""

    def __init__(self, config: EyasConfig, count: int) -> None:
        changes = config.env.model_dump(include={"action_repeat", "speeds"})
        learned = TrainConfig.of(config).dagger
        self._oracle = _ORACLES[learned.teacher](changes, ConstantVelocity())
        self._fade = learned.fade
        self._all, self._nobody = np.ones(count, np.bool_), np.zeros(count, np.bool_)

    def begin(self) -> None:
        """Forget everything: N episodes begin."""
        self._oracle.begin(Start(np.zeros(len(self._all), np.int64), _no_boxes))

    def forget(self, ended: NDArray[np.bool_]) -> None:
        """Forget the episodes that have ended, shape (N,)."""
        self._oracle.forget(ended)

    def lesson(self, truth: Truth) -> tuple[Tensor, Tensor]:
        """Return the right actions and their weights, shapes (N,).

        The longer a target has been hidden, the less the network can know where it is, and the less
        the teacher does.
        """
        nothing = np.zeros(0)  # oracles do not look at observations
        sight = PolicyInput(
            nothing, self._all, lambda: truth.snapshot, lambda: truth.visible, self._nobody
        )
        actions = torch.from_numpy(self._oracle.act(sight).actions)
        age = torch.from_numpy(self._oracle.clue.age)
        return actions, torch.exp(-age / self._fade).float()


def _no_boxes() -> NDArray[np.int32]:
    return np.zeros((0, 4), np.int32)


@dataclass
class Rollout:
    """T decisions in N environments."""

    pictures: Tensor
    """uint8, shape (T, N, C, H, W)."""
    states: Tensor
    """What the network carried, shape (T, N, S)."""
    actions: Tensor
    """Shape (T, N)."""
    log_probability: Tensor
    """Logarithms of the actions' probabilities, shape (T, N)."""
    rewards: Tensor
    """Scaled; with the value of what was cut off, shape (T, N)."""
    values: Tensor
    """Shape (T + 1, N)."""
    ended: Tensor
    """Whether the episode ended with each decision, shape (T, N)."""
    labels: Tensor
    """What a teacher would have done, if there is one, shape (T, N)."""
    weights: Tensor
    """Weights of the labels, shape (T, N)."""

    @staticmethod
    def joined(shards: Sequence["Rollout"]) -> "Rollout":
        """Return the rollouts of shards as one."""
        if len(shards) == 1:
            return shards[0]
        parts = zip(*(vars(shard).values() for shard in shards), strict=True)
        return Rollout(*(torch.cat(part, 1) for part in parts))

    def advantages(self, gamma: float, gae_lambda: float) -> Tensor:
        """Return generalised advantage estimates (Schulman et al. 2016, arXiv:1506.02438), (T, N).

        Args:
            gamma: Discount of rewards, per decision.
            gae_lambda: Discount of errors of the values; 1: what follows less the value.
        """
        estimates = torch.zeros_like(self.rewards)
        following = torch.zeros_like(self.rewards[0])
        for step in reversed(range(len(self.rewards))):
            goes_on = 1.0 - self.ended[step]
            error = self.rewards[step] + gamma * goes_on * self.values[step + 1] - self.values[step]
            following = error + gamma * gae_lambda * goes_on * following
            estimates[step] = following
        return estimates


@dataclass
class Finished:
    """The episodes that have ended since the block began."""

    returns: list[float] = field(default_factory=list)  # Sum of the unscaled rewards of each
    lengths: list[float] = field(default_factory=list)  # Decisions in each


class Roller:
    """Runs the N environments of a shard with a network.

    Attributes:
        env: The environments.
        finished: Episodes that have ended since `begin`.

    Args:
        config: The settings; N is their number of environments divided by that of shards.
        network: Chooses the actions.
    """

    def __init__(self, config: EyasConfig, network: AnyNetwork) -> None:
        count = TrainConfig.of(config).environments // TrainConfig.of(config).shards
        taught = any(phase.algorithm.taught for phase in phases_of(TrainConfig.of(config)))
        self._teacher = Teacher(config, count) if taught else None
        self.env = EyasVectorEnv(
            count,
            config,
            autoreset_mode=AutoresetMode.SAME_STEP,
            copy=False,
            measures=taught,
            device=TrainConfig.of(config).device,
        )
        self.finished = Finished()
        self._network = network
        self._config = TrainConfig.of(config)
        self._device = torch_device(TrainConfig.of(config).device)
        self._data = self._new_rollout(count)
        self._picture = torch.zeros(0)
        self._state = torch.zeros(count, network.shape.state, device=self._device)
        self._return = torch.zeros(count, dtype=torch.float64, device=self._device)
        """Rewards of each episode so far."""
        self._length, self._nobody = np.zeros(count, np.int64), np.zeros(count, np.bool_)
        self._generator = torch.Generator(self._device)

    def _new_rollout(self, count: int) -> Rollout:
        """Return an empty rollout of N environments."""
        shape, steps = self._network.shape, self._config.n_steps
        zeros = partial(torch.zeros, steps, count, device=self._device)
        return Rollout(
            pictures=zeros(shape.channels, shape.height, shape.width, dtype=torch.uint8),
            states=zeros(shape.state),
            actions=zeros(dtype=torch.long),
            log_probability=zeros(),
            rewards=zeros(),
            values=torch.zeros(steps + 1, count, device=self._device),
            ended=zeros(),
            labels=zeros(dtype=torch.long),
            weights=zeros(),
        )

    def begin(self, rng: np.random.Generator) -> None:
        """Begin new episodes and new random choices of actions."""
        observation, _ = self.env.reset(seed=int(rng.integers(2**31, 2**62)))
        self._generator.manual_seed(int(rng.integers(2**62)))
        self._picture = torch.as_tensor(observation)
        self._state = torch.zeros_like(self._state)
        self._return[:], self._length[:] = 0.0, 0
        self.finished = Finished()
        if self._teacher is not None:
            self._teacher.begin()

    @torch.no_grad()
    def roll(self, guided: float | None = None) -> Rollout:
        """Return the next T decisions; the arrays are overwritten by the next call.

        Args:
            guided: Share of the environments that the teacher flies; None: it is not asked.
        """
        data = self._data
        for step in range(self._config.n_steps):
            logits, value, memory = self._network(self._picture, self._state)
            action = torch.multinomial(logits.softmax(1), 1, generator=self._generator)[:, 0]
            if guided is not None:
                action = self._taught(step, action, guided)
            chosen = logits.log_softmax(1).gather(1, action[:, None])[:, 0]
            data.pictures[step], data.states[step] = self._picture, self._state
            data.actions[step], data.log_probability[step] = action, chosen
            data.values[step] = value
            state = self._network.next_state(action, memory)
            ended = self._step(step, action, state)
            self._state = torch.where(ended[:, None], 0.0, state)
        data.values[-1] = self._network(self._picture, self._state)[1]
        return data

    def _taught(self, step: int, action: Tensor, guided: float) -> Tensor:
        """Keep what the teacher tells; return the actions, its own where it flies."""
        assert self._teacher is not None
        labels, weights = self._teacher.lesson(self.env.truth())
        labels = labels.to(self._device)
        self._data.labels[step], self._data.weights[step] = labels, weights
        flown = torch.arange(len(action), device=self._device) < round(guided * len(action))
        return torch.where(flown, labels, action)

    def _step(self, step: int, action: Tensor, state: Tensor) -> Tensor:
        """Take a step in the environments; return which episodes have ended."""
        given = action.numpy() if self._config.device is None else action
        observation, *told, info = self.env.step(given)
        self._picture = torch.as_tensor(observation)
        reward, terminated, truncated = map(torch.as_tensor, told)
        ended = info.get("_final_obs", self._nobody)  # known on the host
        if self._teacher is not None:
            self._teacher.forget(ended)
        self._count(reward, ended)
        scaled = (reward * self._config.reward_scale).float()
        if ended.any() and len(cut := truncated.nonzero()[:, 0]):
            # What would have followed counts as its value.
            last = _rows(info["final_obs"], cut)
            scaled[cut] += self._config.gamma * self._network(last, state[cut])[1]
        gone = terminated | truncated
        self._data.rewards[step], self._data.ended[step] = scaled, gone.float()
        return gone

    def _count(self, reward: Tensor, ended: NDArray[np.bool_]) -> None:
        self._return += reward
        self._length += 1
        which = np.flatnonzero(ended)
        if len(which):
            self.finished.returns.extend(self._return[which].tolist())
            self.finished.lengths.extend(self._length[which].tolist())
            self._return[which], self._length[which] = 0.0, 0


def _rows(final: Any, cut: Tensor) -> Tensor:  # noqa: ANN401  # as environments tell it
    """Return the last observations of some environments: rows of a tensor, or one array each."""
    if isinstance(final, np.ndarray) and final.dtype == object:
        return torch.from_numpy(np.stack(list(final[cut.numpy()])))
    return torch.as_tensor(final)[cut]
