"""Learn to track with skrl: `python examples/learn_skrl.py` (`pip install skrl`: 2.1.1)."""

import torch
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.models.torch import CategoricalMixin, DeterministicMixin, Model
from skrl.trainers.torch import SequentialTrainer
from skrl.utils import set_seed

import eyas


class Looks(Model):
    """What the policy and the value have in common: skrl hands out flat pictures."""

    def __init__(self, env, outputs):
        spaces = {"observation_space": env.observation_space, "action_space": env.action_space}
        Model.__init__(self, **spaces, device="cpu")
        self.network = torch.nn.Sequential(
            *(torch.nn.Conv2d(3, 16, 6, 3), torch.nn.ReLU(), torch.nn.Conv2d(16, 32, 4, 2)),
            *(torch.nn.ReLU(), torch.nn.Flatten(), torch.nn.Linear(32 * 6 * 6, outputs)),
        )

    def compute(self, inputs, role):
        pictures = inputs["observations"].reshape(-1, 3, 48, 48).float() / 255.0
        return self.network(pictures), {}


class Policy(CategoricalMixin, Looks):
    def __init__(self, env):
        Looks.__init__(self, env, int(env.action_space.n))
        CategoricalMixin.__init__(self)


class Value(DeterministicMixin, Looks):
    def __init__(self, env):
        Looks.__init__(self, env, 1)
        DeterministicMixin.__init__(self)


def main(decisions: int = 10_000, num_envs: int = 16, rollouts: int = 64) -> PPO:
    """Train; return the agent."""
    set_seed(0)
    look = {"width": 48, "height": 48, "layout": "chw"}
    env = wrap_env(eyas.make_vec("citystreet-day", num_envs, observation=look, action_repeat=4))
    settings = {"rollouts": rollouts, "discount_factor": 0.95, "learning_rate": 5e-4}
    spaces = {"observation_space": env.observation_space, "action_space": env.action_space}
    models = {"policy": Policy(env), "value": Value(env)}
    memory = RandomMemory(memory_size=rollouts, num_envs=num_envs, device="cpu")
    agent = PPO(models=models, memory=memory, **spaces, device="cpu", cfg=PPO_CFG(**settings))
    SequentialTrainer(env=env, agents=agent, cfg={"timesteps": decisions}).train()
    return agent


if __name__ == "__main__":
    main()
