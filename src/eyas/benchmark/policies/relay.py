"""An oracle for teams: what one drone sees, it tells its mates."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.flight.team_radio import MESSAGE
from eyas.benchmark.policies.road_search import RoadSearch
from eyas.benchmark.policies.sighted import Clue, SightOracle
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.policies.policy import Decision, PolicyInput

Floats = NDArray[np.float64]


_FRESH = 10.0  # Age up to which a mate's sighting is flown to; then each searches for itself [s]


class Relay(SightOracle):
    """As `sighted`; besides, it tells where and how its target moved when it saw it last, and flies
    to where a mate that has seen it later says that it is.

    A message: place east and north [m], velocity [m/s], heading [rad], time [physics steps].
    """

    def act(self, sight: PolicyInput) -> Decision:
        """Fly as one that sees with the eyes of all."""
        actions = super().act(sight).actions
        said = np.full((len(self._known), MESSAGE), np.nan)
        known, last = self._known, self._last
        said[known, :2], said[known, 2:4] = last.place[known], last.velocity[known]
        said[known, 4], said[known, 5] = last.yaw[known], self._seen_at[known]
        return Decision(actions, messages=said)

    def _places(self, clue: Clue, sight: PolicyInput) -> Floats:
        places = super()._places(clue, sight)
        if sight.heard is None or not sight.heard.shape[1]:
            return places
        tick = sight.snapshot().episodes.tick
        when = np.where(np.isnan(sight.heard[:, :, 5]), -1.0, sight.heard[:, :, 5])
        latest = when.argmax(axis=1)
        rows = np.arange(len(when))
        told, age = sight.heard[rows, latest], (tick - when[rows, latest]) * PHYSICS_STEP
        own = np.where(self._known, clue.age, np.inf)
        newer = (when[rows, latest] >= 0.0) & (age < own) & (age < _FRESH)
        places[newer] = (told[:, :2] + told[:, 2:4] * age[:, None])[newer]
        return places


def relay(changes: Mapping[str, Any]) -> Relay:
    """Return the oracle of teams."""
    return Relay(changes, RoadSearch())
