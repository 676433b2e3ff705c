"""Somebody among many who look the same: does the policy keep the right one?"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.episodes.neighbours import in_company
from eyas.benchmark.flight.meter import LOOK
from eyas.benchmark.flight.scenario import Scenario
from eyas.benchmark.protocols.envelope import Envelope
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.policies.sight import nearest_to_middle
from eyas.engine.sim.simulation import Simulation
from eyas.engine.traffic.library import TEST_TRAFFIC

_HEIGHT: Final = 12.0
"""Height of the drone above the ground [m]: people are then 5 of 84 pixels wide, and 2 from 22
m."""

_SWITCHED: Final = 0.5  # Time for which another must be followed to count as a switch [s]


class CrowdScenario(Scenario):
    """Finds out whom each drone follows: the one in the picture that is nearest to its middle."""

    def __init__(
        self, batch: EpisodeBatch, protocol: Protocol, episodes: Sequence[EpisodeSpec]
    ) -> None:
        super().__init__(batch.count)
        self._batch = batch
        self._targets = batch.snapshot().targets.actor.copy()
        self._nearest = np.full((batch.count, protocol.steps // LOOK), -1, np.int64)
        self._least = round(_SWITCHED / (LOOK * protocol.period))

    def measure(self, step: int, active: NDArray[np.bool_]) -> None:
        """Find out whom the active flights follow, at every look."""
        if (step + 1) % LOOK == 0:
            nearest = self._batch.gathered(lambda group: nearest_to_middle(group.simulation))
            self._nearest[active, step // LOOK] = nearest[active]

    def figures(self, row: int) -> dict[str, float | None]:
        """Return how often another was followed instead, and the share of looks at the target."""
        nearest, target = self._nearest[row], int(self._targets[row])
        return {
            "identity_switches": float(switches(nearest, target, self._least)),
            "kept_share": float((nearest == target).mean()),
        }


class CoatScenario(CrowdScenario):
    """Lets the target look like the nearest other from the middle of the flight on."""

    def measure(self, step: int, active: NDArray[np.bool_]) -> None:
        """Find out whom the active flights follow, and change the target's looks once."""
        super().measure(step, active)
        if step + 1 == self._nearest.shape[1] * LOOK // 2:
            for group in self._batch.groups:
                for own, row in enumerate(group.rows.tolist()):
                    _change(group.simulation, own, int(self._targets[row]))

    def figures(self, row: int) -> dict[str, float | None]:
        """Return the shares of looks at the target before and after, beside those of a crowd."""
        before, after = np.array_split(self._nearest[row] == self._targets[row], 2)
        own = {"kept_before": float(before.mean()), "kept_after": float(after.mean())}
        return {**super().figures(row), **own}


def _change(simulation: Simulation, tracker: int, target: int) -> None:
    actors, _ = simulation.actors_around(tracker)
    away = np.square(actors.position[0] - actors.position[0, target]).sum(axis=1)
    away[~actors.present[0]] = away[target] = np.inf
    looks, other = simulation.looks_around(tracker), int(away.argmin())
    red, green, blue = looks.colour[0, other].tolist()
    simulation.dress(tracker, target, int(looks.model[0, other]), (red, green, blue))


def switches(nearest: NDArray[np.int64], target: int, least: int) -> int:
    """Return how often a flight has gone over from its target to another.

    Args:
        nearest: Whom it follows at each look, -1: nobody, shape (M,).
    """
    starts = np.flatnonzero(np.diff(nearest, prepend=nearest[0] - 1))
    lengths = np.diff(starts, append=len(nearest))
    count, on_target = 0, False
    for who, length in zip(nearest[starts].tolist(), lengths.tolist(), strict=True):
        if who == target:
            on_target = True
        elif who >= 0 and length >= least and on_target:
            count, on_target = count + 1, False
    return count


CROWD = Protocol(
    "crowd",
    "60 s: somebody among many who look the same, who meet and cross each other's ways",
    {
        "objects": {"max_count": 200, "group_size": 200, "interval": 0.1},
        "extras": [],
        "start": {"height": _HEIGHT},
        "done": {"total_steps": 30_000, "no_reward_steps": NEVER},
    },
    targets=("Pedestrian",),
    columns=("kept", "kept_share", "identity_switches", "tsr", "flawless", "losses"),
    rank="kept_share",
    alike=True,
    choose=in_company,
    recordings=TEST_TRAFFIC,
    scenario=CrowdScenario,
    envelope=Envelope(lowest=8.0, highest=15.0),
)

COAT = CROWD.like(
    "coat",
    "60 s: somebody in a crowd, who after half of it looks like the one next to him",
    alike=False,
    columns=("kept_share", "kept_before", "kept_after", "identity_switches", "tsr", "losses"),
    scenario=CoatScenario,
)
