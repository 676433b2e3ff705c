"""An observation of your own for a batch of drones: `python examples/own_observation.py`.

The policy gets edges instead of a picture, and its own height and speed; the critic, which only
training needs, also gets the true motion of the target. `info` and `env.observation.parts` hold
what else an observation can be made of.
"""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from eyas import EyasVectorEnv

SIZE = 48
HEIGHT, VELOCITY = 2, slice(3, 6)
"""Columns of `sensors`: position, velocity, ... as in `info`."""


class EdgesAndMotion(gymnasium.vector.VectorObservationWrapper):
    """Observations with the parts `edges`, `motion` and `privileged`."""

    def __init__(self, env: EyasVectorEnv) -> None:
        super().__init__(env)
        self.single_observation_space = Dict(
            {
                "edges": Box(0, 255, (1, SIZE, SIZE - 1), np.uint8),
                "motion": Box(-np.inf, np.inf, (2,), np.float32),
                "privileged": env.single_observation_space["privileged"],
            }
        )
        self.observation_space = batch_space(self.single_observation_space, env.num_envs)

    def observations(self, observations: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
        """Return the observations of N drones, each array with a leading axis of N."""
        grey, sensors = observations["image"].astype(np.int16), observations["sensors"]
        speed = np.linalg.norm(sensors[:, VELOCITY], axis=1)
        return {
            "edges": np.abs(np.diff(grey, axis=3)).astype(np.uint8),
            "motion": np.stack([sensors[:, HEIGHT] / 25.0, speed / 40.0], axis=1),
            "privileged": observations["privileged"],
        }


def main() -> None:
    """Take a few steps and print what is observed."""
    parts = ["image", "sensors", "privileged"]
    observation = {
        "parts": parts,
        "width": SIZE,
        "height": SIZE,
        "colours": "grey",
        "layout": "chw",
    }
    envs = EdgesAndMotion(EyasVectorEnv(8, observation=observation, action_repeat=4))
    envs.reset(seed=0)
    for _ in range(5):
        seen, rewards, *_ = envs.step(envs.action_space.sample())
    assert envs.observation_space.contains(seen)
    print({name: array.shape for name, array in seen.items()}, rewards.round(2))


if __name__ == "__main__":
    main()
