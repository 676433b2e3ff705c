"""A reward and an observation of your own: `python examples/own_reward.py`.

The reward is a function of the state of all trackers at once, named in the settings by its path; it
also works from the command line and in recordings: `--set 'reward.terms={"own_reward:calm": 0.1}'`.
"""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

import eyas  # noqa: F401  # registers the environments
from eyas import Snapshot


def calm(snapshot: Snapshot) -> NDArray[np.float64]:
    """Reward a drone that turns slowly: 1 at rest, 0 from 2 rad/s; shape (N,)."""
    turning = np.abs(snapshot.trackers.angular_velocity[:, 2])
    return np.maximum(1.0 - turning / 2.0, 0.0)


class EdgesOnly(gymnasium.ObservationWrapper[Any, Any, Any]):
    """Shows where the picture changes from left to right, and nothing else."""

    def __init__(self, env: gymnasium.Env[Any, Any]) -> None:
        super().__init__(env)
        height, width, _ = env.observation_space.shape
        self.observation_space = gymnasium.spaces.Box(0, 255, (height, width - 1), np.uint8)

    def observation(self, observation: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return the differences of neighbouring pixels."""
        grey = observation[..., 0].astype(np.int16)
        return np.abs(np.diff(grey, axis=1)).astype(np.uint8)


def main() -> None:
    """Take a few steps and print each term of the reward."""
    env = EdgesOnly(
        gymnasium.make(
            "eyas/citystreet-day-v0",
            config={"reward": {"terms": {f"{__name__}:calm": 0.1}}},
            observation={"colours": "grey"},
        )
    )
    env.reset(seed=0)
    for action in (0, 4, 6):
        seen, reward, *_, info = env.step(action)
        terms = {name: float(value) for name, value in info.items() if name.startswith("reward/")}
        print(seen.shape, round(float(reward), 3), terms)


if __name__ == "__main__":
    main()
