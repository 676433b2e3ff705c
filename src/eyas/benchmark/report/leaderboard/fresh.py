"""Flies an entry's policy in episodes of secret seeds, where what was learned by heart is no use.

Seeds of episodes and, where SUMO is installed, those of traffic and of towns are drawn when they
are asked for, so none can have been trained on.
"""

import importlib.util
import math
import secrets
from collections.abc import Iterator, Sequence
from dataclasses import replace

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.plan.plan import EvaluationPlan, opened
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.statistics.table_rows import rows_of
from eyas.engine.core.config import Config
from eyas.engine.core.rng import TEST_SEEDS
from eyas.engine.world.maps import MAPS

_SEEDS = 1 << 33, 1 << 39
"""First and last seed of fresh episodes: beyond those of sets, and below those of training."""

_TOWNS = 1_000, 90_000_000
"""First and last seed of fresh traffic and towns, counted from `TEST_SEEDS`: beyond those that
ship."""


LEAST, MOST = 40, 100_000
"""Fewest and most fresh episodes: of fewer, intervals are rough; so many may a plan have."""


class FreshFigure(Config):
    """What a policy reaches in fresh episodes, in the figure by which its protocol ranks."""

    figure: str
    """Name of the figure."""
    claimed: float
    """Its mean in the entry's records."""
    mean: float
    low: float
    high: float
    """Its mean in the fresh episodes, with the 95 % interval."""
    episodes: int
    """Number of fresh episodes."""
    seed: int
    """Seed of the first one."""
    traffic: int | None = None
    """Seed of their recorded traffic; None: the protocol's own, as SUMO is not installed."""

    @property
    def confirmed(self) -> bool:
        """Whether the claim lies in the interval."""
        return self.low <= self.claimed <= self.high

    @property
    def line(self) -> str:
        """The figure in words."""
        where = "in" if self.confirmed else "outside"
        own = "" if self.traffic is None else " and traffic"
        return (
            f"{self.figure} {self.mean:.3f} [{self.low:.3f}, {self.high:.3f}] in {self.episodes} "
            f"episodes of secret seeds{own}; the claim {self.claimed:.3f} lies {where} the interval"
        )


def fresh_figure(
    plan: EvaluationPlan,
    records: Sequence[EpisodeRecord],  # Those of the entry
    count: int,  # Least number of episodes
) -> FreshFigure | None:
    """Fly the policy of a plan in fresh episodes; None: they are too few for an interval.

    Raises:
        EyasError: The policy cannot be opened, or no such episodes can be had.
    """
    traffic = None if importlib.util.find_spec("libsumo") is None else _test_seed()
    rules = plan.rules if traffic is None else replace(plan.rules, recordings=(traffic,))
    seed = _SEEDS[0] + secrets.randbelow(_SEEDS[1] - _SEEDS[0])
    episodes = _episodes(plan, rules, seed, count)
    flown = [record for part in plan.parts_of(episodes) for record in _flown(plan, rules, part)]
    claimed, found = (rows_of(each, rules)[0].figures.get(rules.rank) for each in (records, flown))
    if claimed is None or found is None or found.interval is None:
        return None
    return FreshFigure(
        figure=rules.rank,
        claimed=claimed.mean,
        mean=found.mean,
        low=found.interval.low,
        high=found.interval.high,
        episodes=len(flown),
        seed=seed,
        traffic=traffic,
    )


def _test_seed() -> int:
    """Return a seed that is kept for tests and does not ship."""
    return TEST_SEEDS + _TOWNS[0] + secrets.randbelow(_TOWNS[1] - _TOWNS[0])


def _episodes(plan: EvaluationPlan, rules: Protocol, seed: int, count: int) -> list[EpisodeSpec]:
    """Return fresh episodes in the plan's places; towns of tests are others of the same map."""
    names = plan.maps
    if rules.elsewhere and rules.recordings != plan.rules.recordings:
        towns = [Place(name, "", "").town for name in plan.maps]
        names = tuple(
            f"{town}:{_test_seed()}" if town in MAPS.built_in or seed >= TEST_SEEDS else name
            for (town, seed), name in zip(towns, plan.maps, strict=True)
        )
    places = [
        Place(name, weather, target)
        for name in names
        for weather in plan.weathers
        for target in plan.followed
    ]
    together = len(places) * len(rules.directions) * max(len(rules.variants), 1)
    return rules.choose(places, rules, math.ceil(count / together), seed)


def _flown(
    plan: EvaluationPlan, rules: Protocol, episodes: list[EpisodeSpec]
) -> Iterator[EpisodeRecord]:
    policy, _ = opened(plan)
    for ended in BatchFlight(episodes, rules, policy, delay_from(plan.latency)).fly():
        yield from ended
