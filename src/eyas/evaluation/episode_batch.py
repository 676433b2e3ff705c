"""The drones of a batch of episodes: one simulation for each set of settings, stepped as one."""

from collections.abc import Callable, Iterator
from itertools import groupby, islice
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from gymnasium.vector.utils import create_empty_array
from numpy.typing import NDArray

from eyas.core.clock import physics_steps
from eyas.core.errors import SpawnError
from eyas.envs.config import EnvConfig
from eyas.envs.observation import Observation, Observer
from eyas.evaluation.episode import EpisodeSpec, Place, episodes_of
from eyas.evaluation.protocol import Protocol
from eyas.settings.config import EyasConfig
from eyas.sim.build import build_simulation
from eyas.sim.simulation import Simulation
from eyas.sim.worlds import each_alone
from eyas.state.draw import DrawStage, Picture
from eyas.state.snapshot import Snapshot

__all__ = ["NEAR", "EpisodeBatch", "EpisodeGroup", "episode_groups", "episodes_with_neighbours"]

NEAR = 12.0
"""Largest distance of the other vehicle from the target [m]."""

_TRIED = 50
"""Number of seeds that are tried for each episode."""

Mask = NDArray[np.bool_]
Gathered = TypeVar("Gathered")

SIZE = 63, 84
"""Height and width of the pictures in which the target's pixels are counted."""


class EpisodeGroup(NamedTuple):
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


def episode_groups(
    episodes: list[EpisodeSpec], protocol: Protocol, env: EnvConfig
) -> list[EpisodeGroup]:
    """Return the simulations of episodes, at their start.

    Raises:
        EyasError: A setting is not supported.
    """

    def kind(row: int) -> tuple[object, ...]:
        return (episodes[row].place, episodes[row].direction)

    groups = []
    for _, numbers in groupby(sorted(range(len(episodes)), key=kind), key=kind):
        rows = np.array(list(numbers))
        config = protocol.settings_of(episodes[rows[0]], env)
        simulation = build_simulation(config, each_alone(len(rows)))
        seeds = np.array([episodes[row].seed for row in rows.tolist()])
        simulation.reseed_alone(np.arange(len(rows)), seeds)
        simulation.reset()
        if protocol.alike:
            simulation.make_alike()
        groups.append(EpisodeGroup(config, simulation, rows))
    return groups


class EpisodeBatch:
    """N drones in their episodes.

    Attributes:
        observations: Latest observation of each, shape (N, ...).

    Args:
        episodes: N episodes.
        protocol: Their protocol.
        env: What the policy sees, and how it acts.
    """

    def __init__(self, episodes: list[EpisodeSpec], protocol: Protocol, env: EnvConfig) -> None:
        self.count = len(episodes)
        self.groups = episode_groups(episodes, protocol, env)
        self._observers = [Observer(env.observation, group.simulation) for group in self.groups]
        empty: Any = create_empty_array(self._observers[0].space, self.count)
        self.observations = cast("Observation", empty)
        self._steps = physics_steps(protocol.settings.control.frequency)

    def look(self, chosen: Mask, begun: Mask) -> None:
        """Observe some drones; `begun` tells whose episode has just begun, shapes (N,)."""
        for group, observer in zip(self.groups, self._observers, strict=True):
            mine = np.flatnonzero(chosen[group.rows]).astype(np.int32)
            if len(mine):
                observer.look(mine, begun[group.rows][mine])
                observer.copy_to(self.observations, group.rows)

    def advance(self, commands: NDArray[np.float64], active: Mask) -> None:
        """Hold commands for a control step, shape (N, 4); time stands still for the inactive."""
        for group in self.groups:
            if active[group.rows].any():
                group.simulation.advance(commands[group.rows], self._steps, active[group.rows])

    def gathered(self, read: Callable[[EpisodeGroup], Gathered]) -> Gathered:
        """Return what a function reads of each group, in the order of the episodes, (N, ...).

        Args:
            read: Returns an array, or a named tuple of arrays, of the K episodes of a group.
        """
        gathered: Gathered = self._merged([read(group) for group in self.groups])
        return gathered

    def snapshot(self) -> Snapshot:
        """Return the state of all, in the order of the episodes."""
        return self.gathered(lambda group: group.simulation.snapshot)

    def _joined(self, parts: list[NDArray[Any]]) -> NDArray[Any]:
        joined = np.empty((self.count, *parts[0].shape[1:]), parts[0].dtype)
        for group, part in zip(self.groups, parts, strict=True):
            joined[group.rows] = part
        return joined

    def _merged(self, parts: list[Any]) -> Any:  # noqa: ANN401  # records, or arrays
        """Return records of arrays over a group as one over all."""
        if isinstance(parts[0], np.ndarray):
            return self._joined(parts)
        return type(parts[0])(*map(self._merged, map(list, zip(*parts, strict=True))))


def episodes_with_neighbours(
    places: list[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Return the first `count` episodes of each place and direction that have a neighbour.

    They are those of `episodes_of`, with others left out.

    Raises:
        SpawnError: There are too few.
    """
    found = []
    for place in places:
        for turn in range(len(protocol.directions)):
            tried = episodes_of([place], protocol.directions, count * _TRIED, first_seed)
            own = tried[turn :: len(protocol.directions)]
            chosen = list(islice(_with_neighbours(own, protocol, count), count))
            if len(chosen) < count:
                raise SpawnError(
                    f"protocol '{protocol.name}': only {len(chosen)} of {len(own)} starts in "
                    f"'{place.map}' have another vehicle within {NEAR:g} m of the target; "
                    f"{count} are needed"
                )
            found.append(chosen)
    return [episode for chosen in found for episode in chosen]


def _with_neighbours(
    episodes: list[EpisodeSpec], protocol: Protocol, step: int
) -> Iterator[EpisodeSpec]:
    """Yield the episodes that have a neighbour; a few are begun at a time."""
    for start in range(0, len(episodes), 4 * step):
        part = episodes[start : start + 4 * step]
        for group in episode_groups(part, protocol, EnvConfig()):
            for row in np.flatnonzero(_nearest(group) <= NEAR).tolist():
                yield part[group.rows[row]]


def _nearest(group: EpisodeGroup) -> NDArray[np.float64]:
    """Return the distance from each target to the nearest other vehicle [m], shape (K,)."""
    targets = group.simulation.snapshot.targets
    nearest = np.empty(len(group.rows))
    for tracker, actor in enumerate(targets.actor.tolist()):
        actors, _ = group.simulation.actors_around(tracker)
        away = np.linalg.norm(actors.position[0, :, :2] - targets.position[tracker, :2], axis=1)
        away = np.where(actors.present[0], away, np.inf)
        away[actor] = np.inf
        nearest[tracker] = away.min()
    return nearest
