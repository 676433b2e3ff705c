"""The reward as a weighted sum of named terms: the built-in one, published ones, a user's own."""

import inspect
from collections.abc import Callable
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ConfigError, nearest
from eyas.state.snapshot import Snapshot
from eyas.task.config import RewardConfig
from eyas.task.published import TERMS
from eyas.task.quantities import QUANTITIES, Setting

__all__ = ["BUILTIN", "RewardTerm", "RewardTerms"]

Floats = NDArray[np.float64]

RewardTerm = Callable[[Snapshot, Setting], Floats]
"""Function that returns one number for each tracker of a snapshot, shape (N,)."""

BUILTIN = "builtin"
"""Name of the term that the step's kernel computes, set by `reward.type` and `reward.mode`."""


class RewardTerms:
    """Evaluates the reward once per control step.

    Args:
        config: Terms and their weights.
        setting: What quantities depend on.

    Raises:
        ConfigError: A term cannot be imported, or asks for a quantity that does not exist.
    """

    def __init__(self, config: RewardConfig, setting: Setting | None = None) -> None:
        self._weight, self._setting = config.weight, setting or Setting()
        self._terms = [(name, load_term(name), weight) for name, weight in config.terms.items()]

    def of(self, snapshot: Snapshot) -> tuple[Floats, dict[str, Floats]]:
        """Return the reward, shape (N,), and each term by name, without its weight.

        Raises:
            ConfigError: A term did not return a number for each tracker.
        """
        terms = {BUILTIN: snapshot.episodes.reward.copy()}
        total = self._weight * terms[BUILTIN]
        for name, term, weight in self._terms:
            values = np.array(term(snapshot, self._setting), np.float64)
            if values.shape != total.shape:
                raise ConfigError(
                    f"reward.terms.{name}: it returned an array of shape {values.shape}; "
                    f"allowed: {total.shape}, a number for each tracker"
                )
            terms[name] = values
            total = total + weight * values
        return total, terms


def load_term(name: str) -> RewardTerm:
    """Return a term by its name, or by the path `package.module:function`.

    Raises:
        ConfigError: There is no such function, or its parameters are no quantities.
    """
    function = TERMS.get(name) or _imported(name)
    if not callable(function):
        raise ConfigError(f"reward.terms: '{name}' is not a function")
    parameters = inspect.signature(function).parameters.values()
    wanted = [p.name for p in parameters if p.default is p.empty or p.name in QUANTITIES]
    if len(wanted) == 1 and wanted[0] not in QUANTITIES:
        return lambda snapshot, _: function(snapshot)
    for quantity in wanted:
        if quantity not in QUANTITIES:
            raise ConfigError(
                f"reward.terms: '{name}' asks for '{quantity}'{nearest(quantity, QUANTITIES)}; "
                f"allowed: a snapshot, or {', '.join(QUANTITIES)}"
            )
    return lambda snapshot, setting: function(
        **{quantity: QUANTITIES[quantity](snapshot, setting) for quantity in wanted}
    )


def _imported(name: str) -> Callable[..., Floats]:
    module, colon, attribute = name.partition(":")
    try:
        if not colon:
            raise ImportError(f"no term has that name{nearest(name, TERMS)}")
        if module.startswith("."):
            raise ImportError("no module has such a name")
        function: Callable[..., Floats] = getattr(import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise ConfigError(
            f"reward.terms: '{name}' cannot be imported ({error}); allowed: {', '.join(TERMS)}, or "
            "'package.module:function', which takes a snapshot or named quantities"
        ) from error
    return function
