"""How long a policy takes to answer: nothing, a fixed time, sampled times, or measured ones."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from eyas.core.errors import ConfigError, DataFileError
from eyas.core.files import read_limited
from eyas.core.rng import stream

__all__ = ["Delay", "Fixed", "Measured", "SampledDelay", "delay_from"]

_LARGEST = 10_000.0
"""Largest latency [ms]."""

_GRACE = 3
"""First answers whose measured latency does not count: libraries warm up."""


class Delay(Protocol):
    """The latency of a policy."""

    name: str
    """As the user has written it."""

    def begin(self, seeds: list[int]) -> None:
        """Episodes with these seeds begin."""
        ...

    def next(self, row: int, taken: float) -> float:
        """Return the latency of the next answer of an episode [s].

        Args:
            row: The episode's place in the batch.
            taken: How long the policy has really taken [s].
        """
        ...


@dataclass
class Fixed:
    """Always the same."""

    name: str
    seconds: float

    def begin(self, seeds: list[int]) -> None:
        """Do nothing."""

    def next(self, row: int, taken: float) -> float:
        """Return the fixed latency [s]."""
        return self.seconds


@dataclass
class SampledDelay:
    """SampledDelay from measured ones, by the seed of each episode."""

    name: str
    values: list[float]
    """[s]"""

    def begin(self, seeds: list[int]) -> None:
        """Begin the random numbers of each episode."""
        self._streams = [stream(seed, "latency") for seed in seeds]

    def next(self, row: int, taken: float) -> float:
        """Sample one."""
        return self.values[int(self._streams[row].integers(len(self.values)))]


@dataclass
class Measured:
    """That of this machine; episodes must be flown one by one."""

    name: str = "measured"

    def begin(self, seeds: list[int]) -> None:
        """Begin with the first answers, which are free."""
        assert len(seeds) == 1, "only the latency of single answers can be measured"
        self._answers = 0

    def next(self, row: int, taken: float) -> float:
        """Return how long the policy has taken [s]."""
        self._answers += 1
        return 0.0 if self._answers <= _GRACE else taken


def delay_from(text: str) -> Delay:
    """Return the latency that a user has written: milliseconds, a file, or `measured`.

    A file has one latency [ms] in each line.

    Raises:
        ConfigError: It is out of range.
        DataFileError: The file cannot be read, or holds something else.
    """
    if text == "measured":
        return Measured()
    try:
        value = float(text)
    except ValueError:
        return SampledDelay(text, [ms * 1e-3 for ms in _read(Path(text))])
    if not 0.0 <= value <= _LARGEST:
        raise ConfigError(f"--latency: {text} is not allowed: 0 to {_LARGEST:g} ms")
    return Fixed(f"{value:g}", value * 1e-3)


def _read(path: Path) -> list[float]:
    values: list[float] = []
    lines = read_limited(path, 1 << 24).decode("utf-8", "replace").splitlines()
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            value = float(line)
        except ValueError:
            value = math.nan
        if not 0.0 <= value <= _LARGEST:
            raise DataFileError(
                f"{path}: line {number}: {line.strip()[:40]!r} is not a latency: 0 to "
                f"{_LARGEST:g} ms, one in each line"
            )
        values.append(value)
    if not values:
        raise DataFileError(f"{path}: no latencies: one in each line [ms]")
    return values
