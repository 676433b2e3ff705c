"""What a driver does who wants to be lost, and whether a drone keeps him through it."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.episodes.first_fitting import first_fitting
from eyas.benchmark.episodes.from_above import seen_from_above
from eyas.benchmark.episodes.target_losses import LEAST_VISIBLE, hidden_spans
from eyas.benchmark.flight.meter import LOOK
from eyas.benchmark.flight.recovery import time_to_see
from eyas.benchmark.flight.scenario import Scenario
from eyas.benchmark.protocols.protocol import Protocol
from eyas.lanes import exact

KINDS = ("stop", "turn", "dash", "hiding")
"""Evasions that a target's path shows: a stop on the road, an about-turn, a dash over every speed
limit, a while out of sight (order: that of the printed figures)."""

_PERIOD = 0.25  # Time between two looks [s]
_STANDING = 0.5  # Speed below which a target stands [m/s]
_FAST = 17.0  # Speed of a dash [m/s]: others drive at most 16.5.
_LEAST = {"stop": 1.5, "dash": 1.0, "hiding": 2.0}  # Shortest duration of each [s]
_ABOUT_TURN = 2.6  # Least change of heading of who turns round [rad]
_TURNING = 4.0  # Longest time that it takes [s]
_BEGUN = 3.0  # Earliest time at which one counts [s]
_HELD = 3.0  # Time within which the target must be seen after one [s]
_EACH = 2  # Least number of them in an episode

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


class Evasion(NamedTuple):
    """Something that a driver has done to be lost."""

    kind: str  # One of `KINDS`
    start: float  # [s]
    end: float  # [s]


def evasions_of(
    shares: Floats,  # Share of it that nothing hides, shape (K,)
    places: Floats,  # Its centre, east and north [m], shape (K, 2)
    period: float = _PERIOD,  # Time between two looks [s]
) -> list[Evasion]:
    """Return what a driver does, told from what is seen of his car at looks."""
    step = np.diff(places, axis=0)
    speed = np.asarray(exact.hypot(step[:, 0], step[:, 1])) / period
    found = [
        *(Evasion("stop", *span) for span in _spans(speed < _STANDING, period)),
        *(Evasion("dash", *span) for span in _spans(speed > _FAST, period)),
        *(Evasion("hiding", *span) for span in hidden_spans(shares, period)),
    ]
    long = [one for one in found if one.end - one.start >= _LEAST[one.kind]]
    return sorted((*long, *_turns(step, speed, period)), key=lambda one: one.start)


def _spans(does: Mask, period: float) -> list[tuple[float, float]]:
    """Return when something begins and ends that is done between looks, shape (K - 1,)."""
    edges = np.diff(np.concatenate([[False], does, [False]]).astype(np.int8))
    spans = zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)
    return [((int(first) + 1) * period, (int(last) + 1) * period) for first, last in spans]


def _turns(step: Floats, speed: Floats, period: float) -> Iterator[Evasion]:
    """Yield when a car turns round; only where it drives has it a heading."""
    drives = np.flatnonzero(speed > 2.0 * _STANDING)
    heading = np.unwrap(exact.atan2(step[drives, 1], step[drives, 0]))
    last = 0
    for first in range(len(drives)):
        if first < last:
            continue
        within = drives <= drives[first] + round(_TURNING / period)
        turned = np.flatnonzero(within & (abs(heading - heading[first]) > _ABOUT_TURN))
        later = turned[turned > first]
        if len(later):
            last = int(later[0])
            yield Evasion("turn", (drives[first] + 1) * period, (drives[last] + 2) * period)


def evasions_in(episodes: Sequence[EpisodeSpec], protocol: Protocol) -> list[list[Evasion]]:
    """Return what the target of each episode does, early enough to be judged.

    None of those where it does too little; buses and trucks, who only stop, are among them.
    """
    last = protocol.steps * protocol.period - _HELD - 1.0
    found = []
    for shares, places in zip(*seen_from_above(episodes, protocol, _PERIOD), strict=True):
        own = [one for one in evasions_of(shares, places) if _BEGUN <= one.start < one.end <= last]
        willed = any(one.kind in ("turn", "dash") for one in own)
        visible = shares[: round(1.0 / _PERIOD)].min() >= LEAST_VISIBLE
        found.append(own if willed and visible and len(own) >= _EACH else [])
    return found


def evading(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first episodes of each place and direction whose target evades at least twice.

    Raises:
        SpawnError: There are too few.
    """
    wanted = "a target that evades"
    return first_fitting(places, protocol, count, first_seed, fits=evasions_in, wanted=wanted)


class EvasionScenario(Scenario):
    """Measures after which evasions a drone still has its target."""

    def __init__(
        self, batch: EpisodeBatch, protocol: Protocol, episodes: Sequence[EpisodeSpec]
    ) -> None:
        super().__init__(batch.count)
        self._batch, self._period = batch, protocol.period
        self._evasions = evasions_in(episodes, protocol)
        self._sees = np.zeros((batch.count, protocol.steps // LOOK), np.bool_)

    def measure(self, step: int, active: Mask) -> None:
        """Remember at every look who sees the target."""
        if (step + 1) % LOOK == 0:
            seen = self._batch.visible() >= LEAST_VISIBLE
            self._sees[:, step // LOOK] = active & seen

    def figures(self, row: int) -> dict[str, float | None]:
        """Return the share of evasions of each kind after which the target is seen."""
        period = LOOK * self._period
        held = [
            (one.kind, time_to_see(self._sees[row], one.end, period, _HELD) is not None)
            for one in self._evasions[row]
        ]
        figures = {"held": _share([own for _, own in held])}
        for kind in KINDS:
            figures[f"held_{kind}"] = _share([own for each, own in held if each == kind])
        return figures


def _share(held: list[bool]) -> float | None:
    return float(np.mean(held)) if held else None
