"""Learn to track with TorchRL: `python examples/learn_torchrl.py` (`pip install torchrl`:
0.14.1).
"""

import torch
from tensordict.nn import TensorDictModule
from torchrl.collectors import Collector
from torchrl.envs import GymWrapper, InitTracker, TransformedEnv
from torchrl.modules import ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

from eyas import EyasVectorEnv


class Looks(torch.nn.Module):
    """A network for pictures (..., C, H, W) of bytes."""

    def __init__(self, outputs):
        super().__init__()
        self.network = torch.nn.Sequential(
            *(torch.nn.Conv2d(3, 16, 6, 3), torch.nn.ReLU(), torch.nn.Conv2d(16, 32, 4, 2)),
            *(torch.nn.ReLU(), torch.nn.Flatten(), torch.nn.Linear(32 * 6 * 6, outputs)),
        )

    def forward(self, pictures):
        flat = pictures.reshape(-1, 3, 48, 48).float() / 255.0
        return self.network(flat).reshape(*pictures.shape[:-3], -1)


def main(decisions: int = 100_000, num_envs: int = 16, rollout: int = 1024) -> torch.nn.Module:
    """Train; return the policy."""
    torch.manual_seed(0)
    look = {"width": 48, "height": 48, "layout": "chw"}
    own = {"autoreset_mode": "SameStep", "observation": look, "action_repeat": 4}
    env = GymWrapper(EyasVectorEnv(num_envs, **own), categorical_action_encoding=True)
    env = TransformedEnv(env, InitTracker())
    logits = TensorDictModule(Looks(7), ["observation"], ["logits"])
    chooses = {"distribution_class": torch.distributions.Categorical, "return_log_prob": True}
    policy = ProbabilisticActor(logits, in_keys=["logits"], **chooses)
    value = ValueOperator(Looks(1), in_keys=["observation"])
    loss = ClipPPOLoss(policy, value, entropy_coeff=0.01)
    gains = GAE(gamma=0.95, lmbda=0.9, value_network=value)
    adam = torch.optim.Adam(loss.parameters(), lr=5e-4)
    flights = Collector(env, policy, frames_per_batch=rollout, total_frames=decisions)
    for flight in flights:
        gains(flight)
        for _ in range(3):
            for batch in flight.reshape(-1).split(256):
                sum(part for key, part in loss(batch).items() if key.startswith("loss")).backward()
                adam.step()
                adam.zero_grad()
        print(f"mean reward {flight['next', 'reward'].mean():.3f}")
    flights.shutdown()
    return policy


if __name__ == "__main__":
    main()
