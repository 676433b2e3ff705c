"""Losses: when a target cannot be seen for a while, by what stands there or by a covered camera.

They are computed from the truth, for a drone exactly above the target, so that they are the
episode's and the same for all policies.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.first_fitting import first_fitting
from eyas.benchmark.episodes.from_above import seen_from_above
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.errors import SpawnError
from eyas.engine.core.rng import stream
from eyas.engine.sim.cover import cover_of
from eyas.lanes import exact

LEAST_VISIBLE = 0.15  # Share of the target that must be visible, else it is out of sight
SEARCH_LIMIT = 15.0  # Time within which a target must be seen again to count as recovered [s]

COVERED = {"covered-2s": 2.0, "covered-5s": 5.0, "covered-10s": 10.0, "covered-15s": 15.0}
"""How long cameras are covered, by the name of the variant [s]."""

_LENGTH = (4.0, 12.0)  # Shortest and longest loss by things [s]
_MOST = 3  # Largest number of losses by things in an episode

PERIOD = 0.256
"""Time between two looks: a whole number of control steps, so that covers begin with one [s]."""

_FAR = 12.0
"""Least distance between where a target vanishes and where it comes out [m]. Nearer, a drone that
waits where it has lost it has it in its picture again, whose half is 9 m wide at the most."""

_STEADY = 0.77  # Shorter glimpses than this do not end a loss [s]: no more than two looks
BEGUN = 3.0  # Earliest time of a loss: before, a policy must get hold of its target [s]

_ONSETS = (5.0, 20.0), (42.0, 58.0)
"""Between which times a camera is covered, twice in an episode [s]."""

Floats = NDArray[np.float64]


class TargetLoss(NamedTuple):
    """A target cannot be seen for a while."""

    start: float  # [s]
    end: float  # When it can be seen again [s]


def hidden_spans(
    shares: Floats,  # Visible share of it at each look, as from `seen_from_above`, shape (K,)
    period: float = PERIOD,  # Time between two looks [s]
) -> list[TargetLoss]:
    """Return when a target is out of sight."""
    hidden = np.concatenate([[False], shares < LEAST_VISIBLE, [False]])
    edges = np.flatnonzero(hidden[1:] != hidden[:-1])
    spans: list[TargetLoss] = []
    for first, last in edges.reshape(-1, 2).tolist():
        loss = TargetLoss((first + 1) * period, (last + 1) * period)
        if spans and loss.start - spans[-1].end <= _STEADY:
            loss = TargetLoss(spans.pop().start, loss.end)
        spans.append(loss)
    return spans


def losses_by_things(episodes: Sequence[EpisodeSpec], protocol: Protocol) -> list[list[TargetLoss]]:
    """Return the losses of each episode; empty for episodes that the protocol does not choose.

    An episode of the protocol has one to three of 4 to 12 s each and none that is longer; its
    target is visible at the start, comes out of each loss far from where it vanished, and the last
    loss ends early enough for a search. Shorter ones do not count.
    """
    length = protocol.steps * protocol.period
    seen = seen_from_above(episodes, protocol, PERIOD)
    found = []
    for shares, places in zip(*seen, strict=True):
        spans = hidden_spans(shares)
        losses = [loss for loss in spans if loss.end - loss.start >= _LENGTH[0]]
        fits = (
            1 <= len(losses) <= _MOST
            and spans[0].start >= 1.0
            and losses[0].start >= BEGUN
            and losses[-1].end <= length - SEARCH_LIMIT
            and all(loss.end - loss.start <= _LENGTH[1] for loss in losses)
            and all(moved(places, loss) >= _FAR for loss in losses)
        )
        found.append(losses if fits else [])
    return found


def moved(places: Floats, loss: TargetLoss) -> float:
    """Return the distance between where a target vanishes and where it comes out [m]."""
    first, last = round(loss.start / PERIOD) - 1, round(loss.end / PERIOD) - 1
    return float(exact.hypot(*(places[last] - places[max(first - 1, 0)])))


def covered_losses(episodes: Sequence[EpisodeSpec], protocol: Protocol) -> list[list[TargetLoss]]:
    """Return when the camera of each episode is covered; empty if the protocol does not choose it.

    The variants of an episode are covered at the same times, but for different lengths. The target
    is visible when the cover comes and for a second after it goes, whichever length it has.
    """
    plain = [episode._replace(variant="") for episode in episodes]
    alike = list(dict.fromkeys(plain))
    visible = seen_from_above(alike, protocol, PERIOD).shares >= LEAST_VISIBLE
    onsets = {one: _onsets(own, one.seed) for one, own in zip(alike, visible, strict=True)}
    return [
        [TargetLoss(start, start + COVERED.get(episode.variant, 0.0)) for start in onsets[same]]
        for episode, same in zip(episodes, plain, strict=True)
    ]


def _onsets(visible: NDArray[np.bool_], seed: int) -> list[float]:
    """Return two times at which covers of all lengths may come; none if there are not two."""
    random, second = stream(seed, "cover"), round(1.0 / PERIOD)
    chosen = []
    for low, high in _ONSETS:
        looks = [
            look
            for look in range(round(low / PERIOD), round(high / PERIOD))
            if visible[look - second : look].all()
            and all(
                visible[look + round(length / PERIOD) :][:second].all()
                for length in COVERED.values()
            )
        ]
        if not looks:
            return []
        chosen.append(looks[int(random.integers(len(looks)))] * PERIOD)
    return chosen


def with_losses(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first episodes of each place and direction that have losses, in all variants.

    Raises:
        SpawnError: There are too few.
    """
    fits, wanted = losses_by_things, "losses by what stands there ('recover-camera' is for any map)"
    if protocol.variants:
        fits, wanted = covered_losses, "a target that is visible before and after covers"
    else:
        for place in places:
            if not cover_of(place.map, 0):
                raise SpawnError(
                    f"protocol '{protocol.name}': nothing in '{place.map}' hides a car from above; "
                    "use 'recover-camera'"
                )
    return first_fitting(places, protocol, count, first_seed, fits=fits, wanted=wanted)
