"""Figures of losses: is the target seen again, how soon, and is another one followed instead?"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.episodes.loss_sites import losses_at_sites
from eyas.benchmark.episodes.target_losses import (
    COVERED,
    LEAST_VISIBLE,
    SEARCH_LIMIT,
    TargetLoss,
    covered_losses,
    losses_by_things,
)
from eyas.benchmark.flight.meter import LOOK
from eyas.benchmark.flight.scenario import Scenario
from eyas.benchmark.protocols.protocol import Protocol

_STEADY = 0.5  # How long the target must be seen without a gap to count as seen again [s]
_CENTRED = 3.0  # Distance from the middle of the picture within which a vehicle is followed [m]
_WRONG = 2.0  # How long another vehicle must be in the middle to count as followed [s]
_LOOKS = 8  # Looks between two at who is in the middle: as in 0.256 s, a car drives 3 m.

Mask = NDArray[np.bool_]


class RecoveryScenario(Scenario):
    """Covers cameras where the protocol does so, and measures what happens after losses."""

    by_things = staticmethod(losses_by_things)  # Returns the losses where no camera is covered

    def __init__(
        self,
        batch: EpisodeBatch,
        protocol: Protocol,  # Their protocol; its variants, if it has some, are lengths of covers
        episodes: Sequence[EpisodeSpec],
    ) -> None:
        super().__init__(batch.count)
        self._batch, self._period = batch, protocol.period
        self._variants = [episode.variant for episode in episodes]
        losses = covered_losses if protocol.variants else self.by_things
        self._losses = losses(episodes, protocol)
        self._covers = np.zeros((protocol.steps, batch.count), np.bool_)
        if protocol.variants:
            for row, own in enumerate(self._losses):
                for start, end in own:
                    self._covers[round(start / self._period) : round(end / self._period), row] = (
                        True
                    )
        looks = protocol.steps // LOOK
        self._sees = np.zeros((batch.count, looks), np.bool_)
        self._middle = np.full((batch.count, looks // _LOOKS + 1), -1)
        """Vehicle in the middle of each picture, the target included; -1: none."""
        self._actor = batch.gathered(lambda group: group.simulation.snapshot.targets.actor).copy()

    def covered(self, step: int) -> Mask:
        """Return whose camera is covered."""
        covers: Mask = self._covers[step]
        return covers

    def measure(self, step: int, active: Mask) -> None:
        """Remember at every look who sees the target, and what those follow who have lost it."""
        if (step + 1) % LOOK:
            return
        look = step // LOOK
        self._sees[:, look] = active & (self._batch.visible() >= LEAST_VISIBLE)
        if look % _LOOKS == 0:
            lost = active & ~self._sees[:, look] & self._searching((step + 1) * self._period)
            for group in self._batch.groups:
                middles = group.simulation.snapshot.episodes.view_centre
                for own in np.flatnonzero(lost[group.rows]).tolist():
                    actors, _ = group.simulation.actors_around(own)
                    away = np.linalg.norm(actors.position[0, :, :2] - middles[own, :2], axis=1)
                    away[~actors.present[0]] = np.inf
                    nearest = int(away.argmin())
                    if away[nearest] <= _CENTRED:
                        self._middle[group.rows[own], look // _LOOKS] = nearest

    def _searching(self, time: float) -> Mask:
        """Return who has lost the target at most `SEARCH_LIMIT` ago, or just now, shape (N,)."""
        return np.array(
            [
                any(loss.start <= time <= loss.end + SEARCH_LIMIT for loss in own)
                for own in self._losses
            ]
        )

    def figures(self, row: int) -> dict[str, float | None]:
        """Return the figures of the losses of an episode."""
        period = LOOK * self._period
        figures = recovery_figures(self._losses[row], self._sees[row], period)
        other = np.where(self._middle[row] == self._actor[row], -1, self._middle[row])
        wrong = [followed(other, loss, _LOOKS * period) for loss in self._losses[row]]
        figures["followed_wrong"] = float(np.mean(wrong)) if wrong else None
        for name in COVERED:
            own = figures["recovered"] if name == self._variants[row] else None
            figures[f"recovered_{name.removeprefix('covered-')}"] = own
        return figures


class WideRecoveryScenario(RecoveryScenario):
    """The same, of losses under roofs of all lengths."""

    by_things = staticmethod(losses_at_sites)


def recovery_figures(
    losses: Sequence[TargetLoss], sees: Mask, period: float
) -> dict[str, float | None]:
    """Return how often and how soon a target is seen again.

    Every loss counts, also one that begins when the target is lost already: else, who loses it
    early would be asked less often.

    Args:
        sees: Whether the target is seen at each look, shape (K,).
        period: Time between two looks [s].
    """
    if not losses:
        return dict.fromkeys(("recovered", "recovered_of_onset", "recovery_time", "nt2f"))
    times = [time_to_see(sees, loss.end, period) for loss in losses]
    failed = [loss.start for loss, time in zip(losses, times, strict=True) if time is None]
    soon = [
        time is not None and loss.end + time <= loss.start + SEARCH_LIMIT
        for loss, time in zip(losses, times, strict=True)
    ]
    return {
        "recovered": float(np.mean([time is not None for time in times])),
        "recovered_of_onset": float(np.mean(soon)),
        "recovery_time": float(np.mean([SEARCH_LIMIT if time is None else time for time in times])),
        "nt2f": min(failed) / (len(sees) * period) if failed else 1.0,
    }


def time_to_see(
    sees: Mask,  # Whether it is seen at each look, shape (K,)
    end: float,  # The instant [s]
    period: float,  # Time between two looks [s]
    limit: float = SEARCH_LIMIT,  # Longest time [s]
) -> float | None:
    """Return the time from an instant until a target is seen steadily [s]; None: longer."""
    first, steady = round(end / period), round(_STEADY / period)
    for start in range(first, min(first + round(limit / period), len(sees) - steady) + 1):
        if sees[start : start + steady].all():
            return (start - first) * period
    return None


def followed(others: NDArray[np.int64], loss: TargetLoss, period: float) -> bool:
    """Return whether one other vehicle stays in the middle of the picture after a loss."""
    span = others[round(loss.start / period) : round((loss.end + SEARCH_LIMIT) / period)]
    least, same = round(_WRONG / period), 0
    for before, now in zip(span[:-1].tolist(), span[1:].tolist(), strict=True):
        same = same + 1 if now == before and now >= 0 else 0
        if same >= least:
            return True
    return False
