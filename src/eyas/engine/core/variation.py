"""A setting that may be sampled anew for each episode."""

from collections.abc import Callable
from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from eyas.engine.core.config import Config
from eyas.lanes import kernel
from eyas.lanes.pcg64 import fraction, whole


class Uniform(Config):
    """A value sampled uniformly between two limits: `{"uniform": [low, high]}`."""

    notation: ClassVar[str] = '{"uniform": [low, high]}'
    uniform: tuple[float, float]
    """The two limits, in either order."""


class Mirrored(Config):
    """A magnitude sampled uniformly, with a random sign: `{"mirrored": [low, high]}`."""

    notation: ClassVar[str] = '{"mirrored": [low, high]}'
    mirrored: tuple[float, float]
    """Smallest and largest magnitude, in either order."""


class Choice(Config):
    """One of several equally likely values: `{"choice": [a, b, ...]}`."""

    notation: ClassVar[str] = '{"choice": [a, b, ...]}'
    choice: Annotated[tuple[float, ...], Field(min_length=1)]
    """The values."""


Variation = float | Uniform | Mirrored | Choice  # A number, or a rule for sampling one


def sample(variation: Variation, rng: np.random.Generator) -> float:
    """Return one value of a variation, sampled at random."""
    match variation:
        case Uniform(uniform=(low, high)):
            return float(rng.uniform(min(low, high), max(low, high)))
        case Mirrored(mirrored=(low, high)):
            small, large = sorted((abs(low), abs(high)))
            sign = 1.0 if rng.random() < 0.5 else -1.0
            return sign * float(rng.uniform(small, large))
        case Choice(choice=values):
            return float(values[int(rng.integers(len(values)))])
        case _:
            return float(variation)


class Rule(NamedTuple):
    """A variation as kernels read it."""

    kind: int  # One of the numbers below
    values: NDArray[np.float64]
    """The number, the two limits in ascending order, or the values to choose from."""


_NUMBER, _UNIFORM, _MIRRORED, _CHOICE = range(4)


def rule_of(variation: Variation) -> Rule:
    """Return a variation as kernels read it."""
    match variation:
        case Uniform(uniform=pair):
            return Rule(_UNIFORM, np.array(sorted(pair)))
        case Mirrored(mirrored=(low, high)):
            return Rule(_MIRRORED, np.array(sorted((abs(low), abs(high)))))
        case Choice(choice=values):
            return Rule(_CHOICE, np.array(values))
        case _:
            return Rule(_NUMBER, np.array([float(variation)]))


@kernel
def sampled(rule: Rule, state: NDArray[np.int64]) -> float:
    """Return one value of a variation, the one that `sample` would return.

    Args:
        rule: The variation.
        state: The random stream, see `eyas.lanes.pcg64`.
    """
    values = rule.values
    if rule.kind == _NUMBER:
        return float(values[0])
    if rule.kind == _CHOICE:
        return float(values[whole(state, len(values))])
    sign = 1.0
    if rule.kind == _MIRRORED and fraction(state) >= 0.5:
        sign = -1.0
    return sign * float(values[0] + (values[1] - values[0]) * fraction(state))


def bounds(variation: Variation) -> tuple[float, float]:
    """Return the smallest and largest value that a variation can give."""
    match variation:
        case Uniform(uniform=pair):
            return min(pair), max(pair)
        case Mirrored(mirrored=pair):
            largest = max(abs(pair[0]), abs(pair[1]))
            return -largest, largest
        case Choice(choice=values):
            return min(values), max(values)
        case _:
            return float(variation), float(variation)


def within(low: float, high: float) -> Callable[[Variation], Variation]:
    """Return a check for `pydantic.AfterValidator` that all values of a variation are in range."""

    def check(variation: Variation) -> Variation:
        smallest, largest = bounds(variation)
        if smallest < low or largest > high:
            raise ValueError(f"it must stay within {low:g} and {high:g}")
        return variation

    return check
