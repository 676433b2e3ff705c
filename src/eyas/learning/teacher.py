"""A teacher: tells the action that an oracle would choose, and how much it is worth."""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from eyas.benchmark.policies.predictors import ConstantVelocity
from eyas.benchmark.policies.sighted import Clue, SightOracle
from eyas.engine.envs.batch import Truth
from eyas.engine.policies.policy import PolicyInput, Start
from eyas.engine.settings.config import EyasConfig
from eyas.learning.config import TeacherKind, TrainConfig


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
