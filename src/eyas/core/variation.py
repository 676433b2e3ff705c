"""A setting that may be drawn anew for each episode."""

from typing import Annotated

import numpy as np
from pydantic import Field

from eyas.core.config import Config

__all__ = ["Choice", "Mirrored", "Uniform", "Variation", "bounds", "draw"]


class Uniform(Config):
    """A value drawn evenly between two limits: `{"uniform": [low, high]}`."""

    uniform: tuple[float, float]
    """Lower and upper limit."""


class Mirrored(Config):
    """A magnitude drawn evenly, with a random sign: `{"mirrored": [low, high]}`."""

    mirrored: tuple[float, float]
    """Smallest and largest magnitude."""


class Choice(Config):
    """One of several values, each as likely: `{"choice": [a, b, ...]}`."""

    choice: Annotated[tuple[float, ...], Field(min_length=1)]
    """The values."""


Variation = float | Uniform | Mirrored | Choice
"""A number, or how to draw one."""


def draw(variation: Variation, rng: np.random.Generator) -> float:
    """Return one value of a variation."""
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
