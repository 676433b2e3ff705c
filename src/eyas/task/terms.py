"""The reward as a weighted sum of named terms: the built-in term and user-defined ones."""

from collections.abc import Callable
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ConfigError
from eyas.state.snapshot import Snapshot
from eyas.task.config import RewardConfig

__all__ = ["BUILTIN", "RewardTerm", "RewardTerms"]

Floats = NDArray[np.float64]

RewardTerm = Callable[[Snapshot], Floats]
"""Function that returns one number for each tracker of a snapshot, shape (N,)."""

BUILTIN = "builtin"
"""Name of the term that the step's kernel computes, set by `reward.type` and `reward.mode`."""


class RewardTerms:
    """Evaluates the reward once per control step.

    Args:
        config: Terms and their weights.

    Raises:
        ConfigError: A term cannot be imported.
    """

    def __init__(self, config: RewardConfig) -> None:
        self._weight = config.weight
        self._terms = [(name, load_term(name), weight) for name, weight in config.terms.items()]

    def of(self, snapshot: Snapshot) -> tuple[Floats, dict[str, Floats]]:
        """Return the reward, shape (N,), and each term by name, without its weight.

        Raises:
            ConfigError: A term did not return a number for each tracker.
        """
        terms = {BUILTIN: snapshot.episodes.reward.copy()}
        total = self._weight * terms[BUILTIN]
        for name, term, weight in self._terms:
            values = np.array(term(snapshot), np.float64)
            if values.shape != total.shape:
                raise ConfigError(
                    f"reward.terms.{name}: it returned an array of shape {values.shape}; "
                    f"allowed: {total.shape}, a number for each tracker"
                )
            terms[name] = values
            total = total + weight * values
        return total, terms


def load_term(name: str) -> RewardTerm:
    """Return a term by its path, `package.module:function`.

    Raises:
        ConfigError: There is no such function.
    """
    module, _, function = name.partition(":")
    try:
        if module.startswith("."):
            raise ImportError("no module has such a name")
        term = getattr(import_module(module), function)
    except (ImportError, AttributeError, ValueError) as error:
        raise ConfigError(
            f"reward.terms: '{name}' cannot be imported ({error}); "
            "allowed: 'package.module:function', which takes a snapshot"
        ) from error
    if not callable(term):
        raise ConfigError(f"reward.terms: '{name}' is not a function")
    loaded: RewardTerm = term
    return loaded
