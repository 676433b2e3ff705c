"""How long a policy takes to answer: nothing, a fixed time, sampled times, those of a published
system, or measured ones.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

from eyas.engine.core.errors import ConfigError, DataFileError, UnknownNameError
from eyas.engine.core.files import read_limited
from eyas.engine.core.rng import stream
from eyas.lanes import exact

_LARGEST = 10_000.0  # Largest latency [ms]
_GRACE = 3  # First answers that count as immediate: libraries warm up


class Profile(NamedTuple):
    """How fast a measured system decides."""

    rate: float  # Decisions in a second, at most
    mean: float  # Latency, mean [ms]
    p95: float  # Latency that 95 % of its answers keep [ms]


PROFILES = {
    "aerialvla": Profile(6.2, 160.0, 260.0),
    "openfly": Profile(3.1, 330.0, 520.0),
    "openuav": Profile(1.6, 620.0, 950.0),
    "spf": Profile(1.1, 850.0, 1250.0),
    "aerialvln": Profile(9.0, 110.0, 180.0),
    "rule": Profile(50.0, 20.0, 35.0),
}
"""Systems for aerial navigation by vision and language, and a controller of rules ("50+ Hz"), as
measured in CARLA-Air (arXiv 2605.31066, table 13)."""

_P95 = 1.6448536269514722  # The quantile of the normal distribution that `Profile.p95` is of.


class Delay(Protocol):
    """The latency of a policy."""

    name: str  # Text of the option `--latency`
    period: float  # Shortest time from one look to the next [s]

    def begin(self, seeds: list[int]) -> None:
        """Episodes with these seeds begin."""
        ...

    def next(self, row: int, taken: float) -> float:
        """Return the latency of the next answer of an episode [s].

        Args:
            taken: How long the policy has really taken [s].
        """
        ...


@dataclass
class Fixed:
    """A fixed latency."""

    name: str
    seconds: float
    period: float = 0.0

    def begin(self, seeds: list[int]) -> None:
        """Do nothing."""

    def next(self, row: int, taken: float) -> float:
        """Return the fixed latency [s]."""
        return self.seconds


@dataclass
class SampledDelay:
    """Latencies sampled from a list, by the seed of each episode."""

    name: str
    values: list[float]  # [s]
    period: float = 0.0

    def begin(self, seeds: list[int]) -> None:
        """Begin the random numbers of each episode."""
        self._streams = [stream(seed, "latency") for seed in seeds]

    def next(self, row: int, taken: float) -> float:
        """Sample one."""
        return self.values[int(self._streams[row].integers(len(self.values)))]


class Profiled:
    """Sampled by each episode's seed from a lognormal with a system's mean and 95th percentile."""

    def __init__(self, name: str) -> None:
        profile = PROFILES[name]
        self.name, self.period = name, 1.0 / profile.rate
        # mean = exp(m + s^2 / 2) and p95 = exp(m + 1.645 s): of both solutions the narrow one.
        ratio = float(exact.log(profile.p95 / profile.mean))
        self._spread = _P95 - math.sqrt(_P95 * _P95 - 2.0 * ratio)
        half = 0.5 * self._spread * self._spread
        self._middle = float(exact.log(profile.mean * 1e-3)) - half

    def begin(self, seeds: list[int]) -> None:
        """Begin the random numbers of each episode."""
        self._streams = [stream(seed, "latency") for seed in seeds]

    def next(self, row: int, taken: float) -> float:
        """Sample one."""
        normal = float(exact.normal(self._streams[row]))
        return float(exact.exp(self._middle + self._spread * normal))


@dataclass
class Measured:
    """Time that this machine takes; episodes must be flown one by one."""

    name: str = "measured"
    period: float = 0.0

    def begin(self, seeds: list[int]) -> None:
        """Begin with the first answers, which are free."""
        assert len(seeds) == 1, "only the latency of single answers can be measured"
        self._answers = 0

    def next(self, row: int, taken: float) -> float:
        """Return how long the policy has taken [s]."""
        self._answers += 1
        return 0.0 if self._answers <= _GRACE else taken


def delay_from(text: str) -> Delay:
    """Return the latency that a user has written: milliseconds, a profile, a file, or `measured`.

    A file has one latency [ms] in each line.

    Raises:
        ConfigError: It is out of range, or neither a profile nor a file.
        DataFileError: The file cannot be read, or holds something else.
    """
    if text == "measured":
        return Measured()
    if text in PROFILES:
        return Profiled(text)
    try:
        value = float(text)
    except ValueError:
        if not Path(text).exists() and text.isalpha():
            others = "milliseconds, or a file with one latency in each line"
            raise UnknownNameError("--latency", text, (*PROFILES, "measured"), "", others) from None
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
