"""N environments of one or more kinds, as one: a batch of trackers for each kind in the mixture."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ActionError
from eyas.engine.envs.batch import TARGET, Batch, Evading, Outcome, Seeds, Truth
from eyas.engine.envs.choice import kinds_of, settings_of_kinds
from eyas.engine.envs.evader_view import evader_actions
from eyas.engine.envs.information import Info
from eyas.engine.envs.observation import Observation
from eyas.engine.settings.config import EyasConfig
from eyas.engine.task.terms import BUILTIN

Mask = NDArray[np.bool_]


class _Group(NamedTuple):
    """The environments of one kind."""

    batch: Batch
    rows: NDArray[np.int64]  # Their indices, shape (K,)


class MixedBatch:
    """N environments, with the methods of a `Batch`; results are in the order of their indices.

    Args:
        config: The settings.
        count: N.
        measures: Whether targets are measured in the pictures, see `truth`.
        evading: Whether targets are agents, too: then actions and observations are dictionaries
            with the parts `tracker` and `target`.

    Raises:
        EyasError: A setting is wrong; the message is one line.
    """

    def __init__(
        self, config: EyasConfig, count: int, *, measures: bool = False, evading: bool = False
    ) -> None:
        kinds = settings_of_kinds(config)
        kind_of = np.array(kinds_of(config, count))
        self._count = count
        rows_of = [np.flatnonzero(kind_of == kind) for kind in range(len(kinds))]
        self._groups = [
            _Group(Batch(kind, len(rows), numbers=rows.tolist(), measures=measures), rows)
            for kind, rows in zip(kinds, rows_of, strict=True)
            if len(rows)
        ]
        self._place = {
            int(row): (group.batch, tracker)
            for group in self._groups
            for tracker, row in enumerate(group.rows)
        }
        self._rows = [group.rows for group in self._groups]
        alike = self._groups[0].batch
        self._actions = alike.actions
        self.action_space: gymnasium.Space[Any] = alike.actions.space
        self.observation_space: gymnasium.Space[Any] = alike.observer.space
        self._evading = evading
        if evading:
            view = alike.evader_view
            spaces = gymnasium.spaces
            self.action_space = spaces.Dict({"tracker": self.action_space, "target": view.actions})
            self.observation_space = spaces.Dict(
                {"tracker": self.observation_space, "target": view.space}
            )

    def begin(self, chosen: Mask, seeds: Seeds = None) -> None:
        """Begin new episodes, see `Batch.begin`."""
        for batch, rows in self._groups:
            own = None if seeds is None else [seeds[row] for row in rows.tolist()]
            batch.begin(chosen[rows], own)

    def step(self, actions: Any, active: Mask) -> Outcome:  # noqa: ANN401  # whatever a learner returns
        """Hold an action of each agent, see `Batch.step`."""
        wanted = None
        if self._evading:
            if not isinstance(actions, Mapping) or {*actions} != {"tracker", "target"}:
                raise ActionError(
                    "actions: not allowed: a dictionary with arrays 'tracker' and 'target'"
                )
            wanted = evader_actions(actions["target"], self._count, "actions['target']")
            actions = actions["tracker"]
        array = array_of(actions, self._count)
        if len(self._groups) > 1:
            self._actions.commands(array)  # refuses before any environment has moved
        outcomes = []
        for batch, rows in self._groups:
            evading = None
            if wanted is not None:
                evading = Evading(batch.config, len(rows))
                evading.actions[:] = wanted[rows]
            outcomes.append(batch.step(array[rows], active[rows], evading))
        outcome: Outcome = joined(outcomes, self._rows)
        return outcome

    def look(self, chosen: Mask, begun: Mask) -> None:
        """Observe some trackers; `begun` tells whose episode has just begun, shapes (N,)."""
        for batch, rows in self._groups:
            if chosen[rows].any():
                batch.look(chosen[rows], begun[rows])
                if self._evading:
                    batch.evader_view.look(np.flatnonzero(chosen[rows]).astype(np.int32))

    def copy_to(self, out: Observation) -> None:
        """Copy the latest observation of each, with a leading axis of N."""
        for batch, rows in self._groups:
            mine = rows if len(self._groups) > 1 else slice(None)
            if self._evading:
                assert isinstance(out, Mapping)
                out["target"][mine] = batch.evader_view.latest
                batch.observer.copy_to(out["tracker"], mine)
            else:
                batch.observer.copy_to(out, mine)

    def one(self, index: int) -> Observation:
        """Return a copy of the latest observation of one."""
        batch, tracker = self._place[index]
        if self._evading:
            own = batch.evader_view.latest[tracker].copy()
            return {"tracker": batch.observer.one(tracker), "target": own}
        return batch.observer.one(tracker)

    def info(self) -> Info:
        """Return the state of the trackers by name, see `eyas.engine.envs.information`."""
        whole: Info = joined([batch.info() for batch, _ in self._groups], self._rows)
        return whole

    def truth(self) -> Truth:
        """Return what is true now of all, see `Batch.truth`."""
        whole: Truth = joined([batch.truth() for batch, _ in self._groups], self._rows)
        return whole

    @property
    def terms(self) -> tuple[str, ...]:
        """Names of the terms of the reward, of all kinds."""
        own = terms_of([batch.config for batch, _ in self._groups])
        return (*own, TARGET) if self._evading else own

    def config_of(self, index: int) -> EyasConfig:
        """Return the settings of one."""
        return self._place[index][0].config

    def render(self, index: int, *, overlay: bool) -> NDArray[np.uint8]:
        """Return the picture of a camera in its configured size, shape (H, W, 3)."""
        batch, tracker = self._place[index]
        pictures = batch.render(np.array([tracker], np.int32), overlay=overlay)
        picture: NDArray[np.uint8] = pictures[0]
        return picture

    def words_of(self, index: int) -> str:
        """Return the target of one in words, see `eyas.engine.sim.views.words`."""
        batch, tracker = self._place[index]
        return batch.words_of(tracker)

    def close(self) -> None:
        """Close the logs and end live traffic; may be called twice."""
        for batch, _ in self._groups:
            batch.close()


def array_of(actions: Any, count: int) -> NDArray[Any]:  # noqa: ANN401  # whatever a learner returns
    """Return N actions as an array.

    Raises:
        ActionError: There are not N.
    """
    array = np.asarray(actions)
    if array.shape[:1] != (count,):
        raise ActionError(
            f"actions: an array of shape {array.shape} is not allowed: one action for each "
            f"of {count} environments"
        )
    return array


def terms_of(configs: Sequence[EyasConfig]) -> tuple[str, ...]:
    """Return the names of the terms of the reward in any of some settings."""
    names = (name for config in configs for name in config.reward.terms)
    return tuple(dict.fromkeys((BUILTIN, *names)))


def joined(parts: Sequence[Any], rows: Sequence[Any]) -> Any:  # noqa: ANN401  # arrays, or dictionaries of arrays
    """Return results of groups of environments as one, in the order of the environments.

    Args:
        parts: An array of each group, or a dictionary, whose missing parts are 0, or a named tuple
            of such.
        rows: The indices of each group's environments.
    """
    if len(parts) == 1:
        return parts[0]
    if isinstance(parts[0], Mapping):
        names = dict.fromkeys(name for part in parts for name in part)
        return {name: joined([part.get(name, 0.0) for part in parts], rows) for name in names}
    if isinstance(parts[0], tuple):
        return type(parts[0])(*(joined(each, rows) for each in zip(*parts, strict=True)))
    count = sum(len(own) if isinstance(own, np.ndarray) else own.stop - own.start for own in rows)
    whole = max(map(np.asarray, parts), key=np.ndim)  # what a part lacks is a single 0
    result = np.empty((count, *whole.shape[1:]), whole.dtype)
    for own, part in zip(rows, parts, strict=True):
        result[own] = part
    return result
