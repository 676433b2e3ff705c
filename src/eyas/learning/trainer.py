"""A training run: stages, blocks of updates, checkpoints, evaluations, curves."""

import math
import time
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from eyas.benchmark.episodes.episode import EpisodeSpec, Place, episodes_of
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.protocols.table import protocol_named
from eyas.engine.camera.config import ColourLayout
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.named_code import origin_of
from eyas.engine.core.rng import TEST_SEEDS, stream
from eyas.engine.envs.choice import steps_per_action
from eyas.engine.envs.observation import observation_space
from eyas.engine.policies.policy import Decision, PolicyInput, Start
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import ActionKind, EnvConfig, ObservationPart
from eyas.engine.world.maps import MAPS
from eyas.learning.algorithm import Learner, phases_of
from eyas.learning.checkpoint import RunFolder, Stateful, TrainingProgress
from eyas.learning.config import ALGORITHMS, NetworkKind, NumberType, Stage, TrainConfig
from eyas.learning.export import export
from eyas.learning.loggers import LOGGERS, Loggers
from eyas.learning.network import (
    AnyNetwork,
    NetworkShape,
    fastest_numbers,
    network_of,
    torch_device,
)
from eyas.learning.rollout import Finished
from eyas.learning.shards import LocalShards, MakeShards, Shards, TorchThreads

_SILENCE = 10.0  # Longest time without a line [s]

Say = Callable[[str], None]

Columns = dict[str, float]  # Numbers of a block, by the names of the curve's columns


class EvaluationScores(NamedTuple):
    """Means over the episodes, see `eyas.benchmark.records.record.EpisodeRecord`."""

    cr: float
    tsr: float


NO_SCORES = EvaluationScores(float("nan"), float("nan"))
"""Figures of a block that no evaluation follows."""


def train(
    config: EyasConfig,
    folder: Path,
    *,
    resume: bool = False,
    say: Say = print,
    make_shards: MakeShards = LocalShards,
) -> Path:
    """Train a network; return the path of the ONNX file.

    The result depends only on the settings: each block of updates begins with new episodes and
    random numbers of its own, so a resumed run gives the same.

    Args:
        config: The settings; `env` and `train` say what is seen and how it is learned.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    run = _Run(config, RunFolder(folder), say, make_shards)
    run.files.begin(config, resume=resume)
    settings = config.model_dump(mode="json")
    run.loggers = Loggers(TrainConfig.of(config).loggers, folder, settings)
    learned = TrainConfig.of(config)
    each = learned.update_decisions
    for number, stage in enumerate(learned.stages):
        updates = learned.updates_of(stage)
        if updates * each != stage.total_timesteps:
            say(
                f"stage {number}: {stage.total_timesteps:,} decisions are rounded up to "
                f"{updates:,} updates of {each:,}: {updates * each:,}"
            )
    if resume:
        run.progress = run.files.load(run.parts, run.code)
    if run.progress.stage < len(learned.stages):  # environments take a while to be made
        left = learned.run_decisions - run.progress.decisions
        say(f"{left:,} decisions by {learned.method}, in updates of {each:,}")
    try:
        while run.progress.stage < len(learned.stages):
            run.stage()
    finally:
        run.loggers.end()
    return run.files.policy


class _Run:
    """A run and how far it has come."""

    def __init__(
        self, config: EyasConfig, files: RunFolder, say: Say, make_shards: MakeShards
    ) -> None:
        if TrainConfig.of(config).number_type is NumberType.FASTEST:  # here, not in each shard
            numbers = fastest_numbers(torch_device(TrainConfig.of(config).device))
            config = updated(config, {"train": {"number_type": numbers.value}})
        self.config, self.files, self._say = config, files, say
        self._learned = learned = TrainConfig.of(config)
        self._make_shards = make_shards
        _refuse_later_errors(config)
        phases = phases_of(learned)
        # Before the network is made, because it sets PyTorch's threads.
        threads = TorchThreads(learned.parts)
        self.network = network_of(_shape(config), learned)
        generator = torch.Generator().manual_seed(config.seed)
        self.network.initialise(generator)
        if (first := learned.begin_from) is not None:
            RunFolder(Path(first)).load_network(self.network)
        self.network.to(torch_device(learned.device))
        optimiser = torch.optim.Adam(self.network.parameters(), learned.learning_rate, eps=1e-5)
        self._learner = Learner(self.network, optimiser, learned, torch.Generator(), threads)
        self._phases = [
            (phase.algorithm(self._learner, phase.settings), phase.end) for phase in phases
        ]
        self.parts: dict[str, Stateful] = {
            "network": self.network,
            "optimiser": optimiser,
            **{each.name: own for each, (own, _) in zip(phases, self._phases, strict=True)},
        }
        own = (ALGORITHMS.path(each.name) for each in phases)
        self.code = [str(origin_of(path)) for path in own if path is not None]
        self.progress = TrainingProgress()
        self.loggers = Loggers((), files.path, {})
        self._total = learned.run_decisions
        self._told = -math.inf  # When it was last told how it goes [s]

    def stage(self) -> None:
        """Do the current stage, or what is left of it."""
        stage = self._learned.stages[self.progress.stage]
        settings = updated(self.config, stage.changes(self.config.world))
        shards = self._make_shards(settings, self.network)
        done = self.progress.stage_decisions >= stage.total_timesteps
        while not done:
            done = self._block(shards, stage)
            if done:
                self.progress.stage += 1
                self.progress.stage_decisions = 0
            self.files.save(self.progress, self.parts, self.code)
            export(self.network, settings.env, self.files.policy)
        shards.close()

    def _block(self, shards: Shards, stage: Stage) -> bool:
        """Do a block of updates; return whether the stage is done."""
        config, progress, start = self._learned, self.progress, time.monotonic()
        rng = stream(self.config.seed, "learning", progress.block)
        shards.begin(rng.spawn(config.shards))
        self._learner.generator.manual_seed(int(rng.integers(2**62)))
        algorithm, end = next(each for each in self._phases if progress.decisions < each[1])
        updates = self._updates(stage, end)
        algorithm.begin(updates)
        for number in range(1, updates + 1):
            self._set_rate(algorithm.learning_rate, end)
            data = shards.roll(algorithm.guided(progress.decisions))
            figures = algorithm.update(data).tolist()
            progress.decisions += config.update_decisions
            progress.stage_decisions += config.update_decisions
            self._tell_meanwhile(number * config.update_decisions / (time.monotonic() - start))
        seconds = time.monotonic() - start
        rate = updates * config.update_decisions / seconds
        progress.block += 1
        scores = self._evaluated(stage)
        learned = dict(zip(algorithm.columns, figures, strict=True))
        row = self._row(shards.finished(), learned) | scores._asdict()
        progress.rows.append(row)
        self._tell(row, rate, algorithm.report(learned))
        good = stage.until_tsr is not None and scores.tsr >= stage.until_tsr
        return good or progress.stage_decisions >= stage.total_timesteps

    def _evaluated(self, stage: Stage) -> EvaluationScores:
        """Return the scores after a block: of an evaluation, if it is time for one."""
        every = self._learned.evaluation.every
        stage_done = self.progress.stage_decisions >= stage.total_timesteps
        if every and (self.progress.block % every == 0 or stage_done):
            return evaluated(self.network, self.config)
        return NO_SCORES

    def _updates(self, stage: Stage, end: int) -> int:
        """Return the updates of the next block, all of one algorithm."""
        config, progress = self._learned, self.progress
        left = config.updates_of(stage) - progress.stage_decisions // config.update_decisions
        before = (end - progress.decisions) // config.update_decisions
        return min(left, config.updates_per_block, before)

    def _set_rate(self, rate: float, end: int) -> None:
        """Set the rate of learning, which falls until the decision with which a phase ends."""
        left = max(1.0 - self.progress.decisions / end, self._learned.final_rate)
        for group in self._learner.optimiser.param_groups:
            group["lr"] = rate * left

    def _row(self, shards: list[Finished], learned: Columns) -> Columns:
        """Return the curve's row of a block; all rows of a run have the same columns."""
        names = dict.fromkeys(name for own, _ in self._phases for name in own.columns)
        returns = [each for finished in shards for each in finished.returns]
        lengths = [each for finished in shards for each in finished.lengths]
        return {
            "stage": self.progress.stage,
            "decisions": self.progress.decisions,
            "episodes": len(returns),
            "return": round(float(np.mean(returns or [np.nan])), 6),
            "length": round(float(np.mean(lengths or [np.nan])), 6),
            **{name: learned.get(name, math.nan) for name in names},
        }

    def _tell_meanwhile(self, rate: float) -> None:
        """Tell how far it is after the first update, and whenever nothing was told for a while."""
        now, done = time.monotonic(), self.progress.decisions
        if now >= self._told + _SILENCE and done < self._total:
            self._told = now
            left = (self._total - done) / rate
            self._say(
                f"{done:>9,} of {self._total:,} decisions  {rate:,.0f} decisions/s  "
                f"{left / 60:.1f} min left"
            )

    def _tell(self, row: Columns, rate: float, report: str) -> None:
        """Tell how it goes."""
        progress, self._told = self.progress, time.monotonic()
        left = max(self._total - progress.decisions, 0) / rate
        physics = rate * steps_per_action(self.config)
        tested = "" if np.isnan(row["tsr"]) else f"CR {row['cr']:.1f}  TSR {row['tsr']:.3f}  "
        self._say(
            f"{progress.decisions:>9,} of {self._total:,} decisions  return {row['return']:7.2f}  "
            f"{tested}{report and f'{report}  '}"
            f"{rate:,.0f} decisions/s ({physics / 500:,.0f} s of flight per s)  "
            f"{left / 60:.1f} min left"
        )
        self.loggers.add(progress.decisions, {**row, "decisions_per_second": rate})


def _refuse_later_errors(config: EyasConfig) -> None:
    """Refuse at once what would end the run only after minutes or hours."""
    evaluation_episodes(config)
    for name in TrainConfig.of(config).loggers:
        LOGGERS.get(name)
    _refuse_test_seeds(config, "")
    for number, stage in enumerate(TrainConfig.of(config).stages):
        changed = updated(config, stage.changes(config.world))
        if TrainConfig.of(changed) != TrainConfig.of(config):
            raise ConfigError(
                f"train.stages.{number}.settings.train: not allowed: all stages learn alike"
            )
        _refuse_test_seeds(changed, f"train.stages.{number}.settings.")
    for number, part in enumerate(config.env.mixture):
        _refuse_test_seeds(updated(config, part.settings), f"env.mixture.{number}.settings.")


def _refuse_test_seeds(config: EyasConfig, path: str) -> None:
    """Refuse maps and traffic that are kept for tests."""
    for group in ("world", "traffic"):
        seed = getattr(config, group).seed
        if seed is not None and seed >= TEST_SEEDS:
            raise ConfigError(
                f"{path}{group}.seed: {seed} is not allowed: seeds from {TEST_SEEDS} on are kept "
                "for tests (eyas evaluate --protocol unseen)"
            )


def _shape(config: EyasConfig) -> NetworkShape:
    """Return the shape of the network for what is seen."""
    env = config.env
    if env.actions is not ActionKind.DISCRETE:
        raise ConfigError(f"env.actions: '{env.actions}' cannot be trained yet: 'discrete' can")
    seen = env.observation
    if seen.parts != (ObservationPart.IMAGE,) or seen.layout is not ColourLayout.CHW:
        raise ConfigError(
            "env.observation: only pictures alone are trained, with channels first: "
            'parts ["image"], layout "chw"'
        )
    shape = observation_space(seen, config).shape
    assert shape is not None
    if min(shape[1:]) < 20:
        raise ConfigError("env.observation: too small to be trained: at least 20x20 pixels")
    train = TrainConfig.of(config)
    channels, height, width = shape
    if train.network is NetworkKind.GC_VAT and not (train.memory and min(height, width) >= 36):
        raise ConfigError(
            "train.network: 'gc-vat' needs train.memory=true and pictures of 36x36 pixels or more"
        )
    return NetworkShape(channels, height, width, train.hidden, train.memory, train.network.value)


class _NetworkPolicy:
    """The network as a policy."""

    sampled = False
    told: frozenset[str] = frozenset()

    def __init__(self, network: AnyNetwork, env: EnvConfig) -> None:
        self.env = env
        self._network = network
        self._state = torch.zeros(0)

    def begin(self, start: Start) -> None:
        self._state = torch.zeros(len(start.seeds), self._network.shape.state)

    @torch.no_grad()
    def act(self, sight: PolicyInput) -> Decision:
        assert isinstance(sight.observation, np.ndarray)
        logits, _, memory = self._network(torch.from_numpy(sight.observation), self._state)
        action: Tensor = logits.argmax(1)
        deciding = torch.from_numpy(sight.deciding)[:, None]
        after = self._network.next_state(action, memory)
        self._state = torch.where(deciding, after, self._state)
        return Decision(action.numpy())


def evaluated(network: AnyNetwork, config: EyasConfig) -> EvaluationScores:
    """Return how the network does, on this processor, in the episodes of `train.evaluation`."""
    episodes, protocol = evaluation_episodes(config)
    env = config.env.model_copy(update={"mixture": ()})
    flight = BatchFlight(
        episodes, protocol, _NetworkPolicy(deepcopy(network).cpu().eval(), env), delay_from("0")
    )
    records = [record for ended in flight.fly() for record in ended]
    means = [
        np.mean([getattr(record, name) for record in records]) for name in EvaluationScores._fields
    ]
    return EvaluationScores(*(round(float(mean), 6) for mean in means))


def evaluation_episodes(config: EyasConfig) -> tuple[list[EpisodeSpec], Protocol]:
    """Return the episodes of `train.evaluation`, and their protocol.

    Raises:
        UnknownNameError: There is no such protocol, or no such weather on the map.
    """
    asked, world = TrainConfig.of(config).evaluation, config.world
    protocol = protocol_named(asked.protocol, "train.evaluation.protocol")
    weathers = asked.weathers or (world.weather,)
    for weather in weathers:
        MAPS.get(world.map).light(weather)
    places = [Place(world.map, weather, config.target) for weather in weathers]
    return episodes_of(places, protocol.directions, asked.episodes, asked.seed), protocol
