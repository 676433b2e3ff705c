"""N trackers of the same settings, each in a world of its own, as environments step them."""

import logging
import types
from collections.abc import Sequence
from enum import Enum
from functools import cached_property, partial
from itertools import compress
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from eyas.engine.core.clock import physics_steps
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.core.memento import Memento, recall, remember
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.envs.actions import make_actions
from eyas.engine.envs.evader_view import EvaderObserver
from eyas.engine.envs.information import Info, information
from eyas.engine.envs.observation import Observer
from eyas.engine.envs.trained_with import describe
from eyas.engine.render.renderer import CpuRenderer
from eyas.engine.sensors.table import Fitted
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import originals_named
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.episode_sampling import ModelTable, SamplingRules
from eyas.engine.sim.evaders import Evaders
from eyas.engine.sim.light import LightRules
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.starts import FreeStarts
from eyas.engine.sim.views.parked import ParkedObjects
from eyas.engine.sim.views.visible_actors import VisibleActors
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.motion import Motion
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.engine.targets.looks import LookTable
from eyas.engine.task.config import RewardConfig
from eyas.engine.task.done import DoneReason
from eyas.engine.task.journal import Journal
from eyas.engine.task.step_line import step_line
from eyas.engine.task.terms import RewardTerms
from eyas.engine.traffic.ways import Ways
from eyas.lanes import BoundCall, CompiledCall, Kernel, PackedBundle

_CODE = (types.FunctionType, types.MethodType, partial, type, CompiledCall, Kernel)
_SETTINGS = (BaseModel, Enum, gymnasium.Space)
_SHARED = (Assets, CpuRenderer, Lighting, Motion, ParkedObjects, Terrain, Ways)
_TABLES = (Fitted, SamplingRules, LightRules, LookTable, ModelTable)
"""Made of the settings and the catalogue, which may have grown in this process."""
_BOUND = (BoundCall, PackedBundle)  # To the addresses of arrays, which stay
_SCRATCH = (VisibleActors, Picture, FreeStarts)  # Worked out at each use
FIXED = (*_CODE, *_SETTINGS, *_SHARED, *_TABLES, *_BOUND, *_SCRATCH, Journal)
"""Types of parts for `eyas.engine.core.memento.remember` to leave out."""


Mask = NDArray[np.bool_]
Seeds = Sequence[int | None] | None

_STEPS = logging.getLogger("eyas.steps")  # Gets a line for each action if `verbose` is true
_STEPS.setLevel(logging.INFO)


class Outcome(NamedTuple):
    """Result of one action of each of N agents."""

    reward: NDArray[np.float64]  # Sum over the control steps that the action lasted, shape (N,)
    terms: dict[str, NDArray[np.float64]]
    """Sum of each term of the reward, without its weight, shape (N,)."""
    terminated: Mask  # Whether the episode has ended before its number of steps, shape (N,)
    truncated: Mask  # Whether it has ended by its number of steps, shape (N,)
    reason: NDArray[np.int64]  # `eyas.engine.task.done.DoneReason` of its end, shape (N,).


TARGET = "target"
"""Name among the terms of the reward of what targets get that agents move."""


class Evading:
    """Actions and rewards of targets that agents move, of an action of each.

    Attributes:
        actions: See `Evaders.actions`, shape (N, 2).
        reward: Of each target: its own terms, or what its tracker gets with the opposite sign,
            summed over control steps, shape (N,).
    """

    def __init__(self, config: EyasConfig, count: int) -> None:
        self.actions, self.reward = np.zeros((count, 2)), np.zeros(count)
        own = config.evader.reward
        self._terms = RewardTerms(RewardConfig(weight=0.0, terms=own)) if own else None

    def add(self, simulation: Simulation, reward: NDArray[np.float64], running: Mask) -> None:
        """Add the rewards of a control step, of the trackers that run."""
        gained = -reward
        if self._terms is not None:
            gained = self._terms.of(simulation.snapshot)[0]
        self.reward += np.where(running, gained, 0.0)


class Truth(NamedTuple):
    """True state of N agents and their targets, for teachers; later steps change it."""

    snapshot: Snapshot  # Their state
    visible: NDArray[np.float64]
    """Share of each target that the latest picture shows, shape (N,); 0 if nothing is measured."""


class Batch:
    """N trackers of the same settings.

    Attributes:
        config: The settings.
        actions: What an agent chooses from.
        observer: What an agent sees.

    Args:
        config: The settings.
        count: N.
        shared: Whether all are in one world, where they see each other; its time goes on for all.
        numbers: Number of each, for logs, shape (N,); None: 0, 1, ...
        measures: Whether targets are measured in the pictures, see `truth`.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    def __init__(
        self,
        config: EyasConfig,
        count: int,
        *,
        shared: bool = False,
        numbers: Sequence[int] | None = None,
        measures: bool = False,
    ) -> None:
        self.config = config
        self._made = config, count, shared, numbers, measures
        self._shared, self._seed = shared, config.seed
        with originals_named(config):
            self._simulation = build_simulation(config, (together if shared else each_alone)(count))
        self.actions = make_actions(config.env)
        describe(self.actions.space, config)
        self.observer = Observer(config.env.observation, self._simulation, measures=measures)
        self._steps = physics_steps(config.control.frequency)
        self._all = np.arange(count, dtype=np.int32)
        self._picture: Picture | None = None
        folder, kind = config.env.log_folder, config.tracker.original_name
        self._names = [f"{kind}{number}" for number in numbers or range(count)]
        self._journal = Journal(
            None if folder is None else Path(folder), self._names, numbers, verbose=config.verbose
        )

    def close(self) -> None:
        """Close the logs and end live traffic; may be called again."""
        self._journal.close()
        self._simulation.close()

    def __reduce__(self) -> tuple[Any, ...]:
        """Describe a copy, which goes on where this is: settings, and what these trackers remember.

        Raises:
            EyasError: There can be no second one.
        """
        if self._simulation.traffic.live:
            raise EyasError("traffic.live: an environment with live traffic cannot be copied")
        if self._journal.writes:
            raise EyasError(
                f"env.log_folder: an environment that writes logs ({self.config.env.log_folder}) "
                "cannot be copied"
            )
        return _again, (*self._made, remember(self, FIXED))

    def continue_from(self, other: "Batch") -> None:
        """Continue the sequences of episodes of others, which may have other settings."""
        self._simulation.continue_from(other._simulation)

    def begin(self, chosen: Mask, seeds: Seeds = None) -> None:
        """Begin new episodes of trackers with worlds of their own; `look` comes next.

        Args:
            chosen: The trackers, shape (N,).
            seeds: For each of the N trackers, the seed whose sequence of episodes begins, or None
                to continue its sequence; None: all continue.
        """
        pairs = zip(np.flatnonzero(chosen).tolist(), compress(seeds or (), chosen), strict=False)
        for tracker, seed in pairs:
            if seed is not None:
                self._simulation.reseed_alone(np.array([tracker]), np.array([seed]))
        self._simulation.reset(chosen)

    def begin_together(
        self,
        seed: int | None = None,  # The seed whose sequence of episodes begins; None: it continues
    ) -> None:
        """Begin new episodes of all trackers in their shared world, at any time of its traffic."""
        simulation, episodes = self._simulation, self._simulation.snapshot.episodes
        if seed is not None:
            self._seed = seed
            simulation.reseed(seed)
        simulation.rewind()
        first = self.config.start.warm_up_steps
        last = simulation.steps_left - self.config.done.total_steps
        key = EpisodeKey(self._seed, 0, int(episodes.number[0]) + 1)
        episodes.tick[:] = key.stream("time").integers(first, last + 1)
        simulation.reset()

    @cached_property
    def evader_view(self) -> EvaderObserver:
        """What targets that agents move see and may do."""
        assert self.evaders is not None
        return EvaderObserver(self.config, self._simulation)

    @property
    def evaders(self) -> Evaders:
        """The targets, which agents move.

        Raises:
            ConfigError: They move as recorded, or fixed drivers move them.
        """
        found = self._simulation.evaders
        if found is None or not found.ahead_of_time:
            raise ConfigError(
                f"evader.driver: {self.config.evader.driver} is not allowed where targets are "
                "agents; allowed: 'agent'"
            )
        return found

    def step(
        self,
        actions: Any,  # noqa: ANN401  # whatever a learner returns
        active: Mask,
        evading: Evading | None = None,
    ) -> Outcome:
        """Hold an action of each agent; `begin` or `look` comes next.

        Args:
            actions: N actions.
            active: The trackers that fly, shape (N,); for the others, whose rewards are 0 and who
                have no end, time stands still, or they hover in the world that they share.
            evading: What targets that agents move do, and where their rewards are added up.

        Raises:
            ActionError: An action is not in the space of actions.
        """
        commands = self.actions.commands(actions)
        if evading is not None:
            self.evaders.act(np.arange(len(active)), evading.actions)
            whole = self.config.env.action_repeat * self._steps
            self.evaders.advance(whole, None if self._shared else active)
        reward = np.zeros(len(active))
        terms: dict[str, NDArray[np.float64]] = {}
        running, reason = active, np.zeros(len(active), np.int64)
        for _ in range(self.config.env.action_repeat):
            if self._shared:
                commands[~running] = 0.0
            flying = None if self._shared else running
            result = self._simulation.advance(commands, self._steps, flying)
            reward += np.where(running, result.reward, 0.0)
            if evading is not None:
                evading.add(self._simulation, result.reward, running)
            for name, values in result.terms.items():
                terms[name] = np.where(running, values, 0.0) + terms.get(name, 0.0)
            reason[running] = result.reason[running]
            running = running & ~result.done
            if not running.any():
                break
        if evading is not None:
            terms[TARGET] = evading.reward
        if self.config.verbose:
            snapshot = self._simulation.snapshot
            self._journal.step(snapshot)
            for tracker in np.flatnonzero(active).tolist():
                _STEPS.info("%s", step_line(snapshot, tracker, self._names[tracker]))
        done, at_limit = reason > DoneReason.NONE, reason == DoneReason.STEP_LIMIT
        return Outcome(reward, terms, done & ~at_limit, at_limit, reason)

    def look(self, chosen: Mask, begun: Mask) -> None:
        """Observe some trackers; `begun` tells whose episode has just begun; shapes (N,)."""
        self.observer.look(self._all[chosen], begun[chosen])

    def info(self) -> Info:
        """Return the state of the trackers by name, see `eyas.engine.envs.information`."""
        return information(self._simulation)

    def truth(self) -> Truth:
        """Return what is true now."""
        return Truth(self._simulation.snapshot, self.observer.visible)

    def words_of(self, tracker: int) -> str:
        """Return the target of a tracker in words, see `eyas.engine.sim.views.words`."""
        camera = self.config.camera
        return self._simulation.view.words(tracker, camera.height / camera.width)

    def render(
        self, chosen: NDArray[np.int32] | None = None, *, overlay: bool
    ) -> NDArray[np.uint8]:
        """Return cameras' pictures in their configured size, shape (V, H, W, 3)."""
        camera = self.config.camera
        chosen = self._all if chosen is None else chosen
        if self._picture is None:
            self._picture = Picture.create(len(self._all), camera.height, camera.width)
        picture = self._picture.first(len(chosen))
        self._simulation.draw(chosen, picture, overlay=overlay)
        assert picture.rgb is not None
        return picture.rgb.copy()


def _again(
    config: EyasConfig,
    count: int,
    shared: bool,  # as pickle calls it
    numbers: Sequence[int] | None,
    measures: bool,
    memento: Memento,
) -> Batch:
    """Return a copy of a batch."""
    batch = Batch(config, count, shared=shared, numbers=numbers, measures=measures)
    recall(batch, memento)
    return batch
