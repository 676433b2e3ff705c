"""CR and TSR, the two figures of published DAT results, of a policy in the published test setting.

    python examples/cr_tsr.py

What these figures mean, and what is not the same as in published ones, is told in
docs/published-results.md.
"""

import math
import statistics
from collections.abc import Callable

from eyas import Observation, TrackingEnv, make_config, updated

EPISODES = 10
"""Episodes for each start direction."""

DIRECTIONS = (0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi)
"""Headings of the drone relative to its target's at the start [rad]."""

STEPS = 375
"""Actions in an episode of 1,500 physics steps."""

Policy = Callable[[Observation], int]
"""Chooses one of the seven actions by what the camera sees."""


def hover(observation: Observation) -> int:
    """Do nothing."""
    return 6


def scores(policy: Policy, direction: float, episodes: int = EPISODES) -> list[tuple[float, float]]:
    """Return CR and TSR of some episodes that start in a direction."""
    config = updated(make_config("dat-eval"), {"start": {"direction": direction}})
    env = TrackingEnv(config)
    found = []
    for episode in range(episodes):
        observation, _ = env.reset(seed=0 if episode == 0 else None)
        rewards, ended = [], False
        while not ended:
            observation, reward, terminated, truncated, _ = env.step(policy(observation))
            rewards.append(reward)
            ended = terminated or truncated
        # The discrete reward is 1 where the continuous one is above 0.
        found.append((sum(rewards), sum(reward > 0.0 for reward in rewards) / STEPS))
    return found


def main(episodes: int = EPISODES) -> None:
    """Print the mean and standard deviation of both figures for a drone that hovers."""
    found = [pair for each in DIRECTIONS for pair in scores(hover, each, episodes)]
    for name, values in zip(("CR", "TSR"), zip(*found, strict=True), strict=True):
        mean, deviation = statistics.fmean(values), statistics.pstdev(values)
        print(f"{name} {mean:.3f} ± {deviation:.3f} ({len(values)} episodes)")


if __name__ == "__main__":
    main()
