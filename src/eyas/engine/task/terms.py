"""The reward as a weighted sum of named terms: the built-in one, published ones, a user's own."""

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError, nearest
from eyas.engine.core.own_code import imported, running
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.config import RewardConfig
from eyas.engine.task.published import TERMS
from eyas.engine.task.quantities import QUANTITIES, Setting

Floats = NDArray[np.float64]

RewardTerm = Callable[[Snapshot, Setting], Floats]
"""Function that returns one number for each tracker of a snapshot, shape (N,)."""

_ALLOWED = (
    f"allowed: {', '.join(TERMS)}, or 'package.module:function', which takes a snapshot or named "
    "quantities"
)

_ANY = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)

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
            with running("reward.terms", name):
                values = _numbers(term(snapshot, self._setting))
            if values is None:
                raise ConfigError(
                    f"reward.terms.{name}: it returned no numbers; allowed: an array of shape "
                    f"{total.shape}, a number for each tracker"
                )
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
        ConfigError: There is no such function, or a parameter is not the name of a
            quantity.
    """
    function = TERMS[name] if name in TERMS else _function(name)
    wanted = _wanted(name, function)
    if not wanted:
        return lambda snapshot, _: function(snapshot)
    return lambda snapshot, setting: function(
        **{quantity: QUANTITIES[quantity](snapshot, setting) for quantity in wanted}
    )


def _function(name: str) -> Callable[..., Floats]:
    """Return a user's function."""
    if ":" not in name:
        raise ConfigError(
            f"reward.terms: '{name}' cannot be imported (no term has that name"
            f"{nearest(name, TERMS)}); {_ALLOWED}"
        )
    try:
        found: Any = imported(name, "reward.terms")
    except ImportError as error:
        raise ConfigError(
            f"reward.terms: '{name}' cannot be imported ({error}); {_ALLOWED}"
        ) from error
    if not callable(found) or inspect.isclass(found):
        raise ConfigError(f"reward.terms: '{name}' is not a function")
    function: Callable[..., Floats] = found
    return function


def _wanted(name: str, function: Callable[..., Floats]) -> list[str]:
    """Return the quantities that a function wants by name; none: it wants the snapshot.

    What was not written to be a term is refused before it is called, as far as parameters tell.
    """
    try:
        parameters = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):  # many functions in C do not tell
        parameters = []
    needed = [p for p in parameters if p.kind not in _ANY and p.default is p.empty]
    asked = [p for p in parameters if p in needed or p.name in QUANTITIES]
    if not asked or inspect.isbuiltin(function):
        raise ConfigError(
            f"reward.terms: '{name}' asks for no snapshot and for no quantity; {_ALLOWED}"
        )
    (first, *others) = asked
    misspelt = nearest(first.name, QUANTITIES)
    if not (others or misspelt or first.name in QUANTITIES or first.kind is first.KEYWORD_ONLY):
        return []
    for each in asked:
        if each.name not in QUANTITIES or each.kind is each.POSITIONAL_ONLY:
            raise ConfigError(
                f"reward.terms: '{name}' asks for '{each.name}'{nearest(each.name, QUANTITIES)}; "
                f"allowed: a snapshot, or {', '.join(QUANTITIES)}"
            )
    return [each.name for each in asked]


def _numbers(answer: object) -> Floats | None:
    """Return a copy of an answer as numbers; None if it is something else."""
    try:
        return np.array(answer, np.float64)
    except (TypeError, ValueError):
        return None
