"""The interface of a policy that flies N drones at once."""

from abc import abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from traceback import format_exception
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.config import shown, updated
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.envs.observation import Observation
from eyas.engine.settings.env import EnvConfig, ObservationPart
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.snapshot import Snapshot

BLIND = {"observation": {"parts": [ObservationPart.PRIVILEGED]}}
"""Changes of `EnvConfig` for policies that see no picture, so that none is drawn."""


def _all_open(row: int, places: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.ones(len(places), np.bool_)


class Instruction(NamedTuple):
    """Descriptions of N targets in words, given to policies at the start."""

    words: tuple[str, ...]  # a phrase for each
    attributes: NDArray[np.float32]  # what the phrase says, as numbers, shape (N, A)


COME_BACK = "come back to where you began"  # Words that name no target


class Start(NamedTuple):
    """The start of N episodes."""

    seeds: NDArray[np.int64]
    """Seed of each episode, shape (N,)."""
    boxes: Callable[[], NDArray[np.int32]]
    """Returns the true box of each target in its first picture, visible or hidden: left, top,
    right, bottom, the last two exclusive [pixels]; all 0 if it is outside, or if the protocol does
    not tell it, shape (N, 4)."""
    told: Instruction | None = None
    """The instruction in words; None where the protocol has none."""
    roads: Callable[[], list[RoadNetwork]] = list
    """Returns the roads around each drone, N, one object for those on the same map: for oracles."""
    is_open: Callable[[int, NDArray[np.float64]], NDArray[np.bool_]] = _all_open
    """Returns whether nothing stands over places around a drone, shape (P,), which are east and
    north [m], shape (P, 2): for oracles."""


class PolicyInput(NamedTuple):
    """Observations of a policy at one instant."""

    observation: Observation
    """Latest observation of each episode, shape (N, ...); not to be changed or kept."""
    deciding: NDArray[np.bool_]
    """Mask of those whose action is asked for now, shape (N,); the observations of others may be
    old, and memories of theirs must not change."""
    snapshot: Callable[[], Snapshot]
    """Returns the true state of all N: for oracles."""
    visible: Callable[[], NDArray[np.float64]]
    """Returns the share of each target that its camera sees now, 0 while the camera is covered,
    shape (N,): for oracles."""
    covered: NDArray[np.bool_]
    """Mask of those whose camera is covered now: the picture is black, shape (N,)."""
    heard: NDArray[np.float64] | None = None
    """Latest messages of each drone's mates, NaN before their first, shape (N, mates, numbers);
    None where drones fly alone."""
    clock: float | None = None
    """Time since the start of the flight [s], as any drone's computer knows it; None: one action
    lasts from one look to the next."""
    told: Instruction | None = None
    """Latest instructions, which are new in the middle of some flights; observations with the parts
    `words` and `attributes` have them, too. None where the protocol has no words."""


class Failure(NamedTuple):
    """Error of a policy."""

    line: str  # The error
    traceback: str | None  # Lines of its traceback

    @classmethod
    def of(cls, error: BaseException, *, traced: bool = True) -> "Failure":
        """Return an error that was raised; `traced`: by the policy's own code."""
        if isinstance(error, PolicyFailedError):
            return error.failure
        line = " ".join(f"{type(error).__name__}: {error}".split())[:500]
        return cls(line, "".join(format_exception(error)) if traced else None)


class PolicyFailedError(Exception):
    """A policy has failed elsewhere, in its own process."""

    def __init__(self, failure: Failure) -> None:
        super().__init__(failure.line)
        self.failure = failure


class Decision(NamedTuple):
    """Actions of N drones."""

    actions: Any
    """An action for each drone, shape (N, ...) or a list; those who do not decide are not read."""
    failed: Mapping[int, Failure] = {}  # never changed
    """Drones whose policy has failed, and how; their episodes end."""
    messages: NDArray[np.float64] | None = None
    """Messages of the drones to their mates, shape (N, numbers); None: nothing new."""


class Policy(Protocol):
    """A policy for N episodes that begin together. An error that it raises fails all of them."""

    env: EnvConfig
    """Its observations, and the meaning of its actions."""
    sampled: bool
    """Whether its actions are sampled at random, from the seeds of the episodes."""
    told: frozenset[str]
    """Names of what it gets beside its observations: `box`, the target's first box; `words` and
    `attributes`; `truth`, the true state."""

    def begin(self, start: Start) -> None:
        """Forget everything: N episodes begin."""
        ...

    @abstractmethod
    def act(self, sight: PolicyInput) -> Decision:
        """Choose actions."""
        ...


def settings_in(path: Path, place: str, settings: object) -> Mapping[str, Any]:
    """Return the changes of the defaults of `env` that a policy's file holds.

    Raises:
        DataFileError: Something else stands there, or a setting is wrong.
    """
    if not isinstance(settings, Mapping) or not all(isinstance(key, str) for key in settings):
        raise DataFileError(f"{path}: {place}: {shown(settings)} is not allowed: settings of env")
    try:
        env_config(settings)
    except ConfigError as error:
        raise DataFileError(f"{path}: {place}: {error}") from None
    return settings


def env_config(
    settings: Mapping[str, Any],  # Changes of the defaults that belong to the policy
    changes: Mapping[str, Any] | None = None,  # Changes of the user's, which win
) -> EnvConfig:
    """Return what a policy sees and does.

    Raises:
        ConfigError: A setting is wrong.
    """
    return updated(updated(EnvConfig(), settings), changes or {})
