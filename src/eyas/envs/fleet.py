"""N environments of one or more kinds, as one: a batch of trackers for each kind in the mixture."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ActionError
from eyas.envs.batch import Batch, Outcome, Seeds
from eyas.envs.choice import kinds_of, settings_of_kinds
from eyas.envs.information import Info
from eyas.envs.observation import Observation
from eyas.settings.config import EyasConfig
from eyas.task.terms import BUILTIN

__all__ = ["Fleet"]

Mask = NDArray[np.bool_]


class _Squad(NamedTuple):
    """The environments of one kind."""

    batch: Batch
    rows: NDArray[np.int64]
    """Their indices, shape (K,)."""


class Fleet:
    """N environments, with the methods of a `Batch`; results are in the order of their indices.

    Args:
        config: The settings.
        count: N.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    def __init__(self, config: EyasConfig, count: int) -> None:
        kinds, kind_of = settings_of_kinds(config), np.array(kinds_of(config, count))
        self._count = count
        rows_of = [np.flatnonzero(kind_of == kind) for kind in range(len(kinds))]
        self._squads = [
            _Squad(Batch(kind, len(rows)), rows)
            for kind, rows in zip(kinds, rows_of, strict=True)
            if len(rows)
        ]
        self._place = {
            int(row): (squad.batch, tracker)
            for squad in self._squads
            for tracker, row in enumerate(squad.rows)
        }
        first = self._squads[0].batch
        self.action_space: gymnasium.Space[Any] = first.actions.space
        self.observation_space: gymnasium.Space[Any] = first.observer.space

    def begin(self, chosen: Mask, seeds: Seeds = None) -> None:
        """Begin new episodes, see `Batch.begin`."""
        for batch, rows in self._squads:
            own = None if seeds is None else [seeds[row] for row in rows.tolist()]
            batch.begin(chosen[rows], own)

    def step(self, actions: Any, active: Mask) -> Outcome:  # noqa: ANN401  # whatever a learner returns
        """Hold an action of each agent, see `Batch.step`."""
        array = np.asarray(actions)
        if array.shape[:1] != (self._count,):
            raise ActionError(
                f"actions: an array of shape {array.shape} is not allowed: one action for each "
                f"of {self._count} environments"
            )
        outcomes = [batch.step(array[rows], active[rows]) for batch, rows in self._squads]
        return Outcome(*(self._joined(parts) for parts in zip(*outcomes, strict=True)))

    def look(self, chosen: Mask, begun: Mask) -> None:
        """Observe some trackers; `begun` tells whose episode has just begun, shapes (N,)."""
        for batch, rows in self._squads:
            if chosen[rows].any():
                batch.look(chosen[rows], begun[rows])

    def copy_to(self, out: Observation) -> None:
        """Copy the latest observation of each, with a leading axis of N."""
        for batch, rows in self._squads:
            batch.observer.copy_to(out, rows if len(self._squads) > 1 else slice(None))

    def one(self, index: int) -> Observation:
        """Return a copy of the latest observation of one."""
        batch, tracker = self._place[index]
        return batch.observer.one(tracker)

    def info(self) -> Info:
        """Return the state of the trackers by name, see `eyas.envs.information`."""
        joined: Info = self._joined([batch.info() for batch, _ in self._squads])
        return joined

    @property
    def terms(self) -> tuple[str, ...]:
        """Names of the terms of the reward, of all kinds."""
        names = (name for batch, _ in self._squads for name in batch.config.reward.terms)
        return tuple(dict.fromkeys((BUILTIN, *names)))

    def config_of(self, index: int) -> EyasConfig:
        """Return the settings of one."""
        return self._place[index][0].config

    def render(self, index: int, *, overlay: bool) -> NDArray[np.uint8]:
        """Return the picture of a camera in its configured size, shape (H, W, 3)."""
        batch, tracker = self._place[index]
        pictures = batch.render(np.array([tracker], np.int32), overlay=overlay)
        picture: NDArray[np.uint8] = pictures[0]
        return picture

    def _joined(self, parts: Any) -> Any:  # noqa: ANN401  # arrays, or dictionaries of arrays
        """Return the results of all squads as one, in the order of the environments."""
        if len(self._squads) == 1:
            return parts[0]
        if isinstance(parts[0], Mapping):
            names = dict.fromkeys(name for part in parts for name in part)
            return {name: self._joined([part.get(name, 0.0) for part in parts]) for name in names}
        whole = np.asarray(parts[0])
        joined = np.empty((self._count, *whole.shape[1:]), whole.dtype)
        for (_, rows), part in zip(self._squads, parts, strict=True):
            joined[rows] = part
        return joined
