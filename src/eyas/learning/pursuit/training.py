"""Trains a tracker and the driver of its target against each other, both by PPO, both at once."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from torch import Tensor

from eyas.engine.behaviours.evading import CAR_SEEN
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.rng import TEST_SEEDS, stream
from eyas.engine.envs.choice import evading_settings, steps_per_action
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import ActionKind
from eyas.engine.targets.config import TargetName
from eyas.learning.checkpoint import RunFolder, Stateful, TrainingProgress
from eyas.learning.config import TrainConfig
from eyas.learning.network import ACTIONS
from eyas.learning.pursuit.network import (
    DRIVER_ACTIONS,
    DuelNetwork,
    driver_actions,
    export_driver,
    scales,
)
from eyas.learning.pursuit.sight import SEEN, DuelSight

HELD: Final = 5
"""Actions of the tracker that one of the driver lasts: about half a second, as a change of speed
that is drawn anew ten times a second comes to nothing."""

_PHYSICS: Final = 0.002  # [s]

Say = Callable[[str], None]


class Player:
    """One side of the duel: a network, and what teaches it."""

    def __init__(self, inputs: int, actions: int, config: TrainConfig, seed: int) -> None:
        generator = torch.Generator().manual_seed(seed)
        self.network = DuelNetwork(inputs, actions, config.hidden, generator)
        self.optimiser = torch.optim.Adam(self.network.parameters(), config.learning_rate, eps=1e-5)
        self._config = config

    @torch.no_grad()
    def act(self, seen: Tensor, generator: torch.Generator) -> tuple[Tensor, Tensor, Tensor]:
        """Return actions, the logarithms of their probabilities, and values, shapes (N,)."""
        logits, value = self.network(seen)
        chosen = torch.multinomial(logits.softmax(1), 1, generator=generator)
        return chosen[:, 0], logits.log_softmax(1).gather(1, chosen)[:, 0], value

    def learn(self, data: "Moves", generator: torch.Generator, left: float) -> float:
        """Improve by what was done; return the entropy of the policy.

        Args:
            left: Share of the learning rate.
        """
        config, ppo = self._config, self._config.ppo
        for group in self.optimiser.param_groups:
            group["lr"] = config.learning_rate * left
        gains = data.advantages(config.gamma, config.gae_lambda)
        targets = (gains + data.values[:-1]).flatten()
        scaled = ((gains - gains.mean()) / (gains.std() + 1e-8)).flatten()
        seen, actions = data.seen.flatten(0, 1), data.actions.flatten()
        before, entropy = data.log_probability.flatten(), torch.zeros(())
        for _ in range(ppo.n_epochs):
            for part in torch.randperm(len(seen), generator=generator).chunk(ppo.minibatches):
                logits, values = self.network(seen[part])
                all_log = logits.log_softmax(1)
                change = all_log.gather(1, actions[part, None])[:, 0] - before[part]
                ratio, gain = change.exp(), scaled[part]
                clipped = ratio.clamp(1.0 - ppo.clip_range, 1.0 + ppo.clip_range)
                policy_loss = -torch.min(ratio * gain, clipped * gain).mean()
                value_loss = (values - targets[part]).square().mean()
                entropy = -(all_log.exp() * all_log).sum(1).mean()
                loss = policy_loss + config.vf_coef * value_loss - ppo.ent_coef * entropy
                self.optimiser.zero_grad()
                loss.backward()
                torch.nn.utils.clip_grad_norm_(self.network.parameters(), config.max_grad_norm)
                self.optimiser.step()
        return float(entropy.detach())


class Moves(NamedTuple):
    """T decisions of a player in N environments."""

    seen: Tensor  # Shape (T, N, C)
    actions: Tensor  # Shape (T, N)
    log_probability: Tensor  # Shape (T, N)
    rewards: Tensor  # Scaled, shape (T, N)
    values: Tensor  # Shape (T + 1, N)
    ended: Tensor  # Whether the episode ended with each, shape (T, N)

    @classmethod
    def create(cls, steps: int, count: int, inputs: int) -> "Moves":
        """Return room for decisions."""
        plane = steps, count
        return cls(
            seen=torch.zeros(*plane, inputs),
            actions=torch.zeros(plane, dtype=torch.long),
            log_probability=torch.zeros(plane),
            rewards=torch.zeros(plane),
            values=torch.zeros(steps + 1, count),
            ended=torch.zeros(plane),
        )

    def advantages(self, gamma: float, gae_lambda: float) -> Tensor:
        """Return generalised advantage estimates, see `eyas.learning.rollout`, shape (T, N)."""
        estimates, following = torch.zeros_like(self.rewards), torch.zeros_like(self.rewards[0])
        for step in reversed(range(len(self.rewards))):
            goes_on = 1.0 - self.ended[step]
            after = gamma * goes_on * self.values[step + 1]
            error = self.rewards[step] + after - self.values[step]
            following = error + gamma * gae_lambda * goes_on * following
            estimates[step] = following
        return estimates


class Duel:
    """N environments in which two players act."""

    def __init__(self, config: EyasConfig) -> None:
        self._config = TrainConfig.of(config)
        count = self._config.environments
        self.env = EyasVectorEnv(
            count,
            updated(config, {"env": {"observation": {"parts": ["privileged"]}}}),
            agents="tracker+target",
            autoreset_mode=AutoresetMode.SAME_STEP,
        )
        aspect = config.camera.height / config.camera.width
        self._sight = DuelSight(config.world, count, aspect)
        self._period = steps_per_action(config) * _PHYSICS
        self._scales = torch.from_numpy(scales())
        self._driver = np.zeros((count, len(CAR_SEEN)), np.float32)
        self._tracker = torch.zeros(count, SEEN)
        self.seen = 0.0  # Sum over steps of the share of trackers that see their targets
        self.lost = 0  # Episodes in which the target was lost

    def begin(self, seed: int) -> None:
        """Begin new episodes."""
        observation, _ = self.env.reset(seed=seed)
        assert isinstance(observation, dict)
        self._driver = observation["target"]
        self._tracker = torch.from_numpy(self._sight.begin(self.env.truth().snapshot)).float()
        self.seen, self.lost = 0.0, 0

    def play(
        self, tracker: Player, driver: Player, generator: torch.Generator
    ) -> tuple[Moves, Moves]:
        """Return the next decisions of both."""
        steps, count = self._config.n_steps, self.env.num_envs
        mine = Moves.create(steps, count, SEEN)
        theirs = Moves.create(steps // HELD, count, len(CAR_SEEN))
        held = torch.zeros(count, dtype=torch.long)
        for step in range(steps):
            turn = step // HELD
            if step % HELD == 0:
                theirs.seen[turn] = torch.from_numpy(self._driver) * self._scales
                held, theirs.log_probability[turn], theirs.values[turn] = driver.act(
                    theirs.seen[turn], generator
                )
                theirs.actions[turn] = held
            mine.seen[step] = self._tracker
            action, mine.log_probability[step], mine.values[step] = tracker.act(
                self._tracker, generator
            )
            mine.actions[step] = action
            reward, ended = self._step(action.numpy(), driver_actions(held.numpy(), self._driver))
            mine.rewards[step], mine.ended[step] = reward, ended
            theirs.rewards[turn] -= reward * (1.0 - theirs.ended[turn])
            theirs.ended[turn] = torch.maximum(theirs.ended[turn], ended)
        mine.values[-1] = tracker.act(self._tracker, generator)[2]
        last = torch.from_numpy(self._driver) * self._scales
        theirs.values[-1] = driver.act(last, generator)[2]
        return mine, theirs

    def _step(
        self, actions: NDArray[np.int64], driving: NDArray[np.float64]
    ) -> tuple[Tensor, Tensor]:
        """Take a step; return the tracker's scaled rewards, and whose episodes have ended."""
        observation, reward, terminated, truncated, _ = self.env.step(
            {"tracker": actions, "target": driving}
        )
        assert isinstance(observation, dict)
        self._driver = observation["target"]
        ended = terminated | truncated
        look = self._sight.look(self.env.truth().snapshot, self._period, ended)
        self._tracker = torch.from_numpy(look).float()
        seen = self._sight.seen & ~ended
        self.lost += int(np.count_nonzero(terminated))
        # What is hidden is not tracked: only this lets a driver gain by hiding.
        gained = reward * seen * self._config.reward_scale
        self.seen += float(seen.mean())
        return torch.from_numpy(gained).float(), torch.from_numpy(ended.astype(np.float32))


def train(config: EyasConfig, folder: Path, *, resume: bool = False, say: Say = print) -> Path:
    """Train both; return the path of the driver, an ONNX file.

    The tracker is written beside it, as `tracker.pt`: it sees numbers that no sensor tells, and is
    no policy of a protocol. The result depends only on the settings, also where a run is resumed.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    config = evading_settings(config)
    _refuse(config)
    files, learned = RunFolder(folder), TrainConfig.of(config)
    files.begin(config, resume=resume)
    torch.set_num_threads(1)
    tracker = Player(SEEN, ACTIONS, learned, config.seed)
    driver = Player(len(CAR_SEEN), DRIVER_ACTIONS, learned, config.seed + 1)
    parts: dict[str, Stateful] = {
        "network": tracker.network,
        "optimiser": tracker.optimiser,
        "driver": driver.network,
        "driver_optimiser": driver.optimiser,
    }
    progress = files.load(parts) if resume else TrainingProgress()
    total = learned.run_decisions
    duel = Duel(config) if progress.decisions < total else None
    while duel is not None and progress.decisions < total:
        _block(config, duel, tracker, driver, progress, say)
        files.save(progress, parts)
        export_driver(driver.network, config.env, files.policy)
    if duel is not None:
        duel.env.close()
    return files.policy


def _block(
    config: EyasConfig,
    duel: Duel,
    tracker: Player,
    driver: Player,
    progress: TrainingProgress,
    say: Say,
) -> None:
    """Play and learn for a block, with new episodes and random numbers of its own."""
    learned, began = TrainConfig.of(config), time.process_time()
    rng = stream(config.seed, "pursuit", progress.block)
    duel.begin(int(rng.integers(2**31, 2**62)))
    generator = torch.Generator().manual_seed(int(rng.integers(2**62)))
    total, rewards, entropies = learned.run_decisions, [], (0.0, 0.0)
    first = progress.decisions
    for _ in range(learned.updates_per_block):
        left = max(1.0 - progress.decisions / total, learned.final_rate)
        mine, theirs = duel.play(tracker, driver, generator)
        rewards.append(float(mine.rewards.mean()))
        entropies = (tracker.learn(mine, generator, left), driver.learn(theirs, generator, left))
        progress.decisions += learned.update_decisions
        if progress.decisions >= total:
            break
    progress.block += 1
    played = (progress.decisions - first) / learned.environments
    minutes = played * learned.environments * steps_per_action(config) * _PHYSICS / 60.0
    row: dict[str, Any] = {
        "decisions": progress.decisions,
        "reward": round(float(np.mean(rewards)), 6),
        "seen": round(duel.seen / played, 4),
        "losses_per_minute": round(duel.lost / minutes, 4),
        "tracker_entropy": round(entropies[0], 4),
        "driver_entropy": round(entropies[1], 4),
    }
    progress.rows.append(row)
    seconds = time.process_time() - began
    say(
        f"{progress.decisions:>9,} of {total:,} decisions  seen {row['seen']:.3f}  "
        f"losses a minute {row['losses_per_minute']:.2f}  CPU {seconds:.0f} s"
    )


def _refuse(config: EyasConfig) -> None:
    """Refuse settings that cannot be trained."""
    learned = TrainConfig.of(config)
    if config.target is not TargetName.SUMO_VEHICLE or config.custom is not None:
        raise ConfigError(f"target: '{config.target}' cannot be trained in a pursuit: cars can")
    if config.env.actions is not ActionKind.DISCRETE:
        raise ConfigError(f"env.actions: '{config.env.actions}' cannot be trained: 'discrete' can")
    if learned.n_steps % HELD:
        raise ConfigError(
            f"train.n_steps: {learned.n_steps} is not allowed: a multiple of {HELD}, as an action "
            "of the driver lasts so many of the tracker's"
        )
    for name in ("world", "traffic"):
        seed = getattr(config, name).seed
        if seed is not None and seed >= TEST_SEEDS:
            raise ConfigError(
                f"{name}.seed: {seed} is not allowed: seeds from {TEST_SEEDS} on are kept for tests"
            )
