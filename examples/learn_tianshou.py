"""Learn to track with Tianshou: `python examples/learn_tianshou.py` (`pip install tianshou`:
2.0.1, which wants Gymnasium 1.2).
"""

import gymnasium
import torch
from tianshou.algorithm import PPO
from tianshou.algorithm.modelfree.reinforce import DiscreteActorPolicy
from tianshou.algorithm.optim import AdamOptimizerFactory
from tianshou.data import Collector, VectorReplayBuffer
from tianshou.env import DummyVectorEnv
from tianshou.trainer import OnPolicyTrainerParams
from tianshou.utils.net.common import ModuleWithVectorOutput
from tianshou.utils.net.discrete import DiscreteActor, DiscreteCritic

import eyas  # noqa: F401  # registers the environments


class Pictures(ModuleWithVectorOutput):
    """A network for pictures (N, C, H, W)."""

    def __init__(self):
        super().__init__(32 * 6 * 6)
        self.network = torch.nn.Sequential(
            *(torch.nn.Conv2d(3, 16, 6, 3), torch.nn.ReLU(), torch.nn.Conv2d(16, 32, 4, 2)),
            *(torch.nn.ReLU(), torch.nn.Flatten()),
        )

    def forward(self, obs, state=None, info=None):
        return self.network(torch.as_tensor(obs, dtype=torch.float32) / 255.0), state


def env() -> gymnasium.Env:
    """Return an environment."""
    look = {"width": 48, "height": 48, "layout": "chw"}
    return gymnasium.make("eyas/citystreet-day-v0", observation=look, action_repeat=4)


def main(epochs: int = 5, steps: int = 8192, num_envs: int = 8, rollout: int = 1024) -> PPO:
    """Train; return the algorithm."""
    envs, one = DummyVectorEnv([env] * num_envs), env()
    actor = DiscreteActor(
        preprocess_net=Pictures(), action_shape=one.action_space.n, softmax_output=False
    )
    algorithm = PPO(
        policy=DiscreteActorPolicy(actor=actor, action_space=one.action_space),
        critic=DiscreteCritic(preprocess_net=Pictures()),
        optim=AdamOptimizerFactory(lr=5e-4),
        gamma=0.95,
    )
    collector = Collector(algorithm, envs, VectorReplayBuffer(rollout, num_envs))
    run = {"max_epochs": epochs, "epoch_num_steps": steps, "batch_size": 256}
    own = {"collection_step_num_env_steps": rollout, "update_step_num_repetitions": 3}
    algorithm.run_training(OnPolicyTrainerParams(training_collector=collector, **run, **own))
    return algorithm


if __name__ == "__main__":
    main()
