"""N environments in several processes, as one."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.core.memento import Memento
from eyas.envs.actions import make_actions
from eyas.envs.batch import Outcome, Seeds
from eyas.envs.block import Block, Calls
from eyas.envs.choice import kinds_of, settings_of_kinds
from eyas.envs.fleet import array_of, joined, terms_of
from eyas.envs.information import Info
from eyas.envs.observation import Observation, observation_space
from eyas.envs.shared import SharedObservations
from eyas.envs.workers import Workers
from eyas.lanes import thread_count
from eyas.settings.config import EyasConfig

__all__ = ["WorkerFleet"]

Mask = NDArray[np.bool_]


class WorkerFleet:
    """N environments with the methods of a `Fleet`, in a block of neighbours for each process.

    Calls that tell nothing, and so all errors in them, wait for the next one that does.

    Args:
        config: The settings.
        count: N.
        workers: Number of processes, 1 to N.

    Raises:
        EyasError: A setting is wrong, or a process could not be started; one line.
    """

    def __init__(self, config: EyasConfig, count: int, workers: int) -> None:
        self._made = config, count, workers
        self._count = count
        kinds = settings_of_kinds(config)
        self._configs = [kinds[kind] for kind in kinds_of(config, count)]
        self._actions = make_actions(config.env.actions, config.env.speeds)
        self.action_space: gymnasium.Space[Any] = self._actions.space
        self.observation_space = observation_space(config.env.observation, config.lidar)
        self.terms = terms_of(self._configs)
        shared = SharedObservations(self.observation_space, count)
        self._latest = shared.of(slice(0, count))
        ends = [count * number // workers for number in range(workers + 1)]
        self._rows = [slice(*pair) for pair in pairwise(ends)]
        self._waiting: list[Calls] = [[] for _ in self._rows]
        threads = max(thread_count() // workers, 1)
        self._workers = Workers([Block(config, rows, threads, shared) for rows in self._rows])

    def __reduce__(self) -> tuple[Any, ...]:
        """Describe a copy with processes of its own, which goes on where this is."""
        return _again, (*self._made, self._ask("mementos"))

    def begin(self, chosen: Mask, seeds: Seeds = None) -> None:
        """Begin new episodes, see `Batch.begin`."""
        self._wait("begin", chosen, seeds)

    def step(self, actions: Any, active: Mask) -> Outcome:  # noqa: ANN401  # whatever a learner returns
        """Hold an action of each agent, see `Batch.step`."""
        array = array_of(actions, self._count)
        self._actions.commands(array)  # refuses before any environment has moved
        parts = self._ask("step", array, active)
        return Outcome(*(joined(each, self._rows) for each in zip(*parts, strict=True)))

    def look(self, chosen: Mask, begun: Mask) -> None:
        """Observe some trackers; `begun` tells whose episode has just begun, shapes (N,)."""
        self._wait("look", chosen, begun)

    def copy_to(self, out: Observation) -> None:
        """Copy the latest observation of each, with a leading axis of N."""
        self._catch_up()
        if isinstance(out, Mapping):
            for part, array in out.items():
                array[:] = self._latest[part]
        else:
            out[:] = self._latest

    def one(self, index: int) -> Observation:
        """Return a copy of the latest observation of one."""
        self._catch_up()
        if isinstance(self._latest, Mapping):
            return {part: array[index].copy() for part, array in self._latest.items()}
        latest: NDArray[Any] = self._latest[index].copy()
        return latest

    def info(self) -> Info:
        """Return the state of the trackers by name, see `eyas.envs.information`."""
        told: Info = joined(self._ask("info"), self._rows)
        return told

    def config_of(self, index: int) -> EyasConfig:
        """Return the settings of one."""
        return self._configs[index]

    def render(self, index: int, *, overlay: bool) -> NDArray[np.uint8]:
        """Return the picture of a camera in its configured size, shape (H, W, 3)."""
        picture: NDArray[np.uint8] = self._ask_one("picture", index, overlay)
        return picture

    def words_of(self, index: int) -> str:
        """Return the target of one in words, see `eyas.sim.words`."""
        words: str = self._ask_one("words_of", index)
        return words

    def close(self) -> None:
        """End the processes."""
        self._workers.close()

    def recall(self, mementos: Sequence[list[Memento]]) -> None:
        """Go on where others of the same settings and processes were."""
        for calls, own in zip(self._waiting, mementos, strict=True):
            calls.append(("recall", (own,)))

    def _wait(self, name: str, *arguments: Any) -> None:  # noqa: ANN401  # None, or a row for each
        """Let a call wait, in each process with its own rows of the arguments."""
        for rows, calls in zip(self._rows, self._waiting, strict=True):
            own = (None if whole is None else whole[rows] for whole in arguments)
            calls.append((name, tuple(own)))

    def _ask(self, name: str, *arguments: Any) -> list[Any]:  # noqa: ANN401  # the same
        """Make a call in each process, after those that wait; return the results."""
        self._wait(name, *arguments)
        return self._catch_up()

    def _ask_one(self, name: str, index: int, *arguments: Any) -> Any:  # noqa: ANN401  # the same
        """Make a call about one environment in its process; return the result."""
        for rows, calls in zip(self._rows, self._waiting, strict=True):
            if rows.start <= index < rows.stop:
                calls.append((name, (index - rows.start, *arguments)))
                worker = self._rows.index(rows)
        return self._catch_up()[worker]

    def _catch_up(self) -> list[Any]:
        """Make the calls that wait; return the results of the last ones."""
        if not any(self._waiting):
            return []
        calls, self._waiting = self._waiting, [[] for _ in self._rows]
        return self._workers.ask(calls)


def _again(
    config: EyasConfig, count: int, workers: int, mementos: Sequence[list[Memento]]
) -> WorkerFleet:
    """Return a copy of a fleet."""
    fleet = WorkerFleet(config, count, workers)
    fleet.recall(mementos)
    return fleet
