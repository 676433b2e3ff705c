"""A setting that may be drawn anew for each episode."""

from collections.abc import Callable
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from eyas.core.config import Config

__all__ = ["Choice", "Mirrored", "Uniform", "Variation", "bounds", "sample", "within"]


class Uniform(Config):
    """A value drawn uniformly between two limits: `{"uniform": [low, high]}`."""

    written: ClassVar[str] = '{"uniform": [low, high]}'
    uniform: tuple[float, float]
    """The two limits, in either order."""


class Mirrored(Config):
    """A magnitude drawn uniformly, with a random sign: `{"mirrored": [low, high]}`."""

    written: ClassVar[str] = '{"mirrored": [low, high]}'
    mirrored: tuple[float, float]
    """Smallest and largest magnitude, in either order."""


class Choice(Config):
    """One of several equally likely values: `{"choice": [a, b, ...]}`."""

    written: ClassVar[str] = '{"choice": [a, b, ...]}'
    choice: Annotated[tuple[float, ...], Field(min_length=1)]
    """The values."""


Variation = float | Uniform | Mirrored | Choice
"""A number, or a rule for drawing one."""


def sample(variation: Variation, rng: np.random.Generator) -> float:
    """Return one value of a variation, drawn at random."""
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
    """Return a check for `pydantic.AfterValidator` that all values of a variation are in range.

    Args:
        low: Smallest allowed value.
        high: Largest allowed value.
    """

    def check(variation: Variation) -> Variation:
        smallest, largest = bounds(variation)
        if smallest < low or largest > high:
            raise ValueError(f"it must stay within {low:g} and {high:g}")
        return variation

    return check
