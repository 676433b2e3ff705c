"""The drones of a batch of episodes: one simulation for each set of settings, stepped as one."""

from collections.abc import Callable, Sequence
from itertools import groupby
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from gymnasium.vector.utils import create_empty_array
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.clock import physics_steps
from eyas.engine.envs.observation import Observation, Observer
from eyas.engine.policies.policy import Instruction
from eyas.engine.policies.sight import SIZE, subjects, visible_shares
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import EnvConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import reliefs
from eyas.engine.targets.grammar.attributes import ATTRIBUTES

Mask = NDArray[np.bool_]
Gathered = TypeVar("Gathered")


_ROOF = 1.3  # Height of a car's roof, which is seen longest [m]
_EYE = 22.0  # Height of the protocols' drones [m]


class EpisodeGroup(NamedTuple):
    """The episodes with the same settings but for their start directions."""

    config: EyasConfig
    simulation: Simulation
    rows: NDArray[np.int64]  # Index of each episode in the batch, shape (K,)
    staged: Sequence[Any] = ()
    """What the protocol's `stage` has returned for each; empty: there is none."""

    def subjects(self, size: tuple[int, int] = SIZE) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return the pixels of each target, visible and all, shape (K, 2), and its box (K, 4)."""
        return subjects(self.simulation, np.arange(len(self.rows), dtype=np.int32), size)


def episode_groups(
    episodes: Sequence[EpisodeSpec], protocol: Protocol, env: EnvConfig
) -> list[EpisodeGroup]:
    """Return the simulations of episodes, at their start.

    Raises:
        EyasError: A setting is not supported.
    """

    def kind(row: int) -> tuple[object, ...]:
        episode = episodes[row]
        changed = episode.variant if protocol.variants.get(episode.variant) else ""
        return (episode.place, episode.traffic or 0, changed)

    groups = []
    for _, numbers in groupby(sorted(range(len(episodes)), key=kind), key=kind):
        rows = np.array(list(numbers))
        config = protocol.settings_of(episodes[rows[0]]._replace(direction=0.0), env)
        simulation = build_simulation(config, each_alone(len(rows)))
        chosen = [episodes[row] for row in rows.tolist()]
        simulation.turn_starts(np.array([episode.direction for episode in chosen]))
        seeds = np.array([episode.seed for episode in chosen])
        simulation.reseed_alone(np.arange(len(rows)), seeds)
        simulation.reset()
        if protocol.alike:
            simulation.make_alike()
        staged = () if protocol.stage is None else protocol.stage(simulation, chosen)
        groups.append(EpisodeGroup(config, simulation, rows, staged))
    return groups


class EpisodeBatch:
    """N drones in their episodes.

    Attributes:
        observations: Latest observation of each, shape (N, ...).
        covered: Mask of drones whose camera is covered, shape (N,); the flight writes it.
    """

    def __init__(self, episodes: Sequence[EpisodeSpec], protocol: Protocol, env: EnvConfig) -> None:
        self.count = len(episodes)
        self.covered = np.zeros(self.count, np.bool_)
        self.groups = episode_groups(episodes, protocol, env)
        self._observers = [Observer(env.observation, group.simulation) for group in self.groups]
        empty: Any = create_empty_array(self._observers[0].space, self.count)
        self.observations = cast("Observation", empty)
        self._steps = physics_steps(protocol.settings.control.frequency)
        self._pixels: NDArray[np.int64] | None = None

    def look(self, chosen: Mask, begun: Mask) -> None:
        """Observe some drones; `begun` tells whose episode has just begun, shapes (N,)."""
        for group, observer in zip(self.groups, self._observers, strict=True):
            mine = np.flatnonzero(chosen[group.rows]).astype(np.int32)
            if len(mine):
                rows = group.rows[mine]
                observer.look(mine, begun[rows], self.covered[rows])
                observer.copy_to(self.observations, group.rows)

    def tell(self, told: Instruction | None) -> None:
        """Tell policies their targets in words; None: nothing, as in protocols without words."""
        for group, observer in zip(self.groups, self._observers, strict=True):
            count = len(group.rows)
            words, attributes = [""] * count, np.zeros((count, len(ATTRIBUTES)), np.float32)
            if told is not None:
                words = [told.words[row] for row in group.rows.tolist()]
                attributes = told.attributes[group.rows]
            observer.tell(words, attributes)

    def advance(self, commands: NDArray[np.float64], active: Mask) -> None:
        """Hold commands for a control step, shape (N, 4); time stands still for the inactive."""
        self._pixels = None
        for group in self.groups:
            if active[group.rows].any():
                group.simulation.advance(commands[group.rows], self._steps, active[group.rows])

    def pixels(self) -> NDArray[np.int64]:
        """Return the pixels of each target now, visible and all, shape (N, 2); not to be changed.

        They are counted in pictures of `SIZE`, at most once in a control step.
        """
        if self._pixels is None:
            self._pixels = self.gathered(lambda group: group.subjects()[0])
        return self._pixels

    def visible(self) -> NDArray[np.float64]:
        """Return the visible share of each target, shape (N,); 0 while the camera is covered."""
        return np.where(self.covered, 0.0, visible_shares(self.pixels()))

    def roads(self) -> list[RoadNetwork]:
        """Return the roads around each drone, N; those on the same map share one object."""
        found: dict[int, RoadNetwork] = {}
        for group in self.groups:
            found |= dict.fromkeys(group.rows.tolist(), group.simulation.scene.network)
        return [found[row] for row in range(self.count)]

    def heights(self) -> NDArray[np.float64]:
        """Return how high each drone is above the ground below it [m], shape (N,)."""

        def above(group: EpisodeGroup) -> NDArray[np.float64]:
            terrain = group.simulation.scene.terrain
            place = group.simulation.snapshot.trackers.position
            heights: NDArray[np.float64] = place[:, 2] - reliefs(terrain, place[:, :2])
            return heights - terrain.floor

        return self.gathered(above)

    def is_open(self, row: int, places: NDArray[np.float64]) -> Mask:
        """Return whether nothing stands over cars at places around a drone, shape (P,).

        Args:
            places: East and north [m], shape (P, 2).
        """
        simulation = next(group for group in self.groups if row in group.rows).simulation
        terrain = simulation.scene.terrain
        ground = terrain.floor + reliefs(terrain, places)
        roofs, eyes = (
            np.concatenate([places, (ground + height)[:, None]], axis=1) for height in (_ROOF, _EYE)
        )
        seen: Mask = simulation.clearance.in_sight(eyes, roofs[:, None])[:, 0]
        return seen

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
