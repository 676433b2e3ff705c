"""The drones of a batch of episodes: one simulation for each set of settings, stepped as one."""

from collections.abc import Callable
from itertools import groupby
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from gymnasium.vector.utils import create_empty_array
from numpy.typing import NDArray

from eyas.core.clock import physics_steps
from eyas.envs.config import EnvConfig
from eyas.envs.observation import Observation, Observer
from eyas.evaluation.episode import Episode
from eyas.evaluation.protocol import Protocol
from eyas.settings.config import EyasConfig
from eyas.sim.build import build_simulation
from eyas.sim.simulation import Simulation
from eyas.sim.worlds import each_alone
from eyas.state.draw import DrawStage, Picture
from eyas.state.snapshot import Snapshot

__all__ = ["Flock", "Squad", "squads_of"]

Mask = NDArray[np.bool_]
Record = TypeVar("Record")

SIZE = 63, 84
"""Height and width of the pictures in which the target's pixels are counted."""


class Squad(NamedTuple):
    """The episodes with the same settings."""

    config: EyasConfig
    simulation: Simulation
    rows: NDArray[np.int64]
    """Their places in the batch, shape (K,)."""

    def subjects(self, size: tuple[int, int] = SIZE) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return the pixels of each target, visible and all, shape (K, 2), and its box (K, 4).

        Args:
            size: Height and width of the picture.
        """
        picture = Picture.create(len(self.rows), *size, rgb=False, class_id=True, subject=True)
        every = np.arange(len(self.rows), dtype=np.int32)
        self.simulation.draw(every, picture, until=DrawStage.RASTERISING)
        assert picture.subject_pixels is not None
        assert picture.subject_box is not None
        return picture.subject_pixels, picture.subject_box


def squads_of(episodes: list[Episode], protocol: Protocol, env: EnvConfig) -> list[Squad]:
    """Return the simulations of episodes, at their start.

    Raises:
        EyasError: A setting is not supported.
    """

    def kind(row: int) -> tuple[object, ...]:
        return (episodes[row].place, episodes[row].direction)

    squads = []
    for _, group in groupby(sorted(range(len(episodes)), key=kind), key=kind):
        rows = np.array(list(group))
        config = protocol.settings_of(episodes[rows[0]], env)
        simulation = build_simulation(config, each_alone(len(rows)))
        seeds = np.array([episodes[row].seed for row in rows.tolist()])
        simulation.reseed_alone(np.arange(len(rows)), seeds)
        simulation.reset()
        if protocol.alike:
            simulation.make_alike()
        squads.append(Squad(config, simulation, rows))
    return squads


class Flock:
    """N drones in their episodes.

    Attributes:
        observations: Latest observation of each, shape (N, ...).

    Args:
        episodes: N episodes.
        protocol: Their protocol.
        env: What the policy sees, and how it acts.
    """

    def __init__(self, episodes: list[Episode], protocol: Protocol, env: EnvConfig) -> None:
        self.count = len(episodes)
        self.squads = squads_of(episodes, protocol, env)
        self._observers = [Observer(env.observation, squad.simulation) for squad in self.squads]
        empty: Any = create_empty_array(self._observers[0].space, self.count)
        self.observations = cast("Observation", empty)
        self._steps = physics_steps(protocol.settings.control.frequency)

    def look(self, chosen: Mask, begun: Mask) -> None:
        """Observe some drones; `begun` tells whose episode has just begun, shapes (N,)."""
        for squad, observer in zip(self.squads, self._observers, strict=True):
            mine = np.flatnonzero(chosen[squad.rows]).astype(np.int32)
            if len(mine):
                observer.look(mine, begun[squad.rows][mine])
                observer.copy_to(self.observations, squad.rows)

    def advance(self, commands: NDArray[np.float64], active: Mask) -> None:
        """Hold commands for a control step, shape (N, 4); time stands still for the inactive."""
        for squad in self.squads:
            if active[squad.rows].any():
                squad.simulation.advance(commands[squad.rows], self._steps, active[squad.rows])

    def gathered(self, read: Callable[[Squad], NDArray[Any]]) -> NDArray[Any]:
        """Return what a function reads of each squad, in the order of the episodes, (N, ...)."""
        parts = [read(squad) for squad in self.squads]
        return self._joined(parts)

    def snapshot(self) -> Snapshot:
        """Return the state of all, in the order of the episodes."""
        snapshot: Snapshot = self._merged([squad.simulation.snapshot for squad in self.squads])
        return snapshot

    def _joined(self, parts: list[NDArray[Any]]) -> NDArray[Any]:
        joined = np.empty((self.count, *parts[0].shape[1:]), parts[0].dtype)
        for squad, part in zip(self.squads, parts, strict=True):
            joined[squad.rows] = part
        return joined

    def _merged(self, parts: list[Any]) -> Any:  # noqa: ANN401  # records, or arrays
        """Return records of arrays over a squad as one over all."""
        if isinstance(parts[0], np.ndarray):
            return self._joined(parts)
        return type(parts[0])(*map(self._merged, map(list, zip(*parts, strict=True))))
