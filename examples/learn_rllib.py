"""Learn to track with RLlib: `python examples/learn_rllib.py` (`pip install 'ray[rllib]'`:
2.60.0, which wants Gymnasium 1.2.2).
"""

import gymnasium
import numpy as np
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.connectors.env_to_module.observation_preprocessor import (
    SingleAgentObservationPreprocessor,
)
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig

import eyas  # noqa: F401  # registers the environments


class Floats(SingleAgentObservationPreprocessor):
    """RLlib's convolutions take floats."""

    def recompute_output_observation_space(self, space, action_space):
        return gymnasium.spaces.Box(0.0, 1.0, space.shape, np.float32)

    def preprocess(self, observation, episode):
        return observation.astype(np.float32) / 255.0


def config(num_envs: int = 8, batch: int = 4000) -> PPOConfig:
    """Return the settings of a training; with runners in other processes, `import eyas` there."""
    look = {"action_repeat": 4, "observation": {"width": 48, "height": 48}}
    vector = gymnasium.VectorizeMode.VECTOR_ENTRY_POINT
    return (
        PPOConfig()
        .environment("eyas/citystreet-day-v0", env_config=look)
        .env_runners(
            num_env_runners=0,  # in this process
            num_envs_per_env_runner=num_envs,
            gym_env_vectorize_mode=vector,
            env_to_module_connector=lambda *_, **__: Floats(),
        )
        .rl_module(model_config=DefaultModelConfig(conv_filters=[[16, 6, 3], [32, 4, 2]]))
        .training(train_batch_size_per_learner=batch, minibatch_size=batch // 8, gamma=0.95)
    )


if __name__ == "__main__":
    algorithm = config().build_algo()
    for _ in range(10):
        print(algorithm.train()["env_runners"]["episode_return_mean"])
