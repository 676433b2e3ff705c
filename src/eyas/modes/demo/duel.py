"""You against a policy: both fly the same minute, one after the other."""

from typing import Any

from eyas.core.clock import PHYSICS_RATE

__all__ = ["SEED", "Duel"]

SEED = 7
"""Of the episode that is flown, so that results of different days can be compared."""
SECONDS = 60
READY = 3.0
"""Seconds before each flight in which everything stands still."""


class Duel:
    """The two flights. A score is the mean reward, 0 to 100.

    Attributes:
        policy: Name of the policy.
        stage: `you`, `policy` or `over`.
    """

    def __init__(self, policy: str, now: float) -> None:
        self.policy, self.stage = policy, "you"
        self._sums = {"you": 0.0, "policy": 0.0}
        self._steps = {"you": 0, "policy": 0}
        self._from = now + READY

    def waits(self, now: float) -> bool:
        """Return whether the next flight has not begun."""
        return now < self._from

    def count(self, reward: float, steps: int, now: float) -> bool:
        """Count steps with a reward; return whether a flight has ended with them."""
        if self.stage == "over":
            return False
        self._sums[self.stage] += reward * steps
        self._steps[self.stage] += steps
        if self._steps[self.stage] < SECONDS * PHYSICS_RATE:
            return False
        self.stage = "policy" if self.stage == "you" else "over"
        self._from = now + READY
        return True

    def told(self, now: float) -> dict[str, Any]:
        """Return stage, scores and seconds left."""
        steps = self._steps.get(self.stage, 0)
        return {
            "policy": self.policy,
            "stage": self.stage,
            "ready": round(max(self._from - now, 0.0), 1) if self.stage != "over" else 0.0,
            "left": round(SECONDS - steps / PHYSICS_RATE, 1),
            "scores": {
                who: round(100.0 * total / max(self._steps[who], 1), 1)
                for who, total in self._sums.items()
            },
        }
