"""Proximal policy optimisation in one file: `python examples/ppo.py` (needs PyTorch).

To be read from top to bottom and changed. Nothing is hidden: the network, the rollout, the
advantages and the update stand here; only the environments come from Eyas. `eyas train` is the same
method with checkpoints and curricula. `eyas evaluate --policy eyas-ppo.pt2` flies what it saves.
"""

import json
import time
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn
from torch.distributions import Categorical

from eyas import EyasVectorEnv

SETTINGS = {
    "start": {"pitch": 1.37, "height": 22.0},
    "reward": {"view_range": 1.0},
    "env": {
        "action_repeat": 4,  # an action lasts 32 ms
        "observation": {"width": 48, "height": 48, "layout": "chw"},
    },
}


@dataclass
class Options:
    """What to try other values of."""

    decisions: int = 400_000
    """Decisions of all drones together."""
    num_envs: int = 32
    num_steps: int = 64
    """Decisions of each drone between two updates."""
    minibatches: int = 4
    epochs: int = 3
    """How often each decision is learnt from."""
    learning_rate: float = 5e-4
    """At the start; it falls to 0."""
    discount: float = 0.95
    trace: float = 0.9
    """Lambda of the advantages: 0 trusts the critic, 1 the returns."""
    clip: float = 0.2
    """Largest change of an action's probability that is rewarded."""
    entropy: float = 0.01
    value: float = 0.5
    """Weight of the critic's loss."""
    max_gradient: float = 0.5
    seed: int = 0
    save: str = "eyas-ppo.pt2"


class Scaled(nn.Module):
    """Pictures as numbers of about -2 to 2."""

    def forward(self, pictures: Tensor) -> Tensor:
        """Return the numbers of pictures, uint8, any shape."""
        return (pictures.float() - 110.0) / 60.0


class Agent(nn.Module):
    """Two convolutions, then the policy and the critic."""

    def __init__(self, actions: int = 7) -> None:
        super().__init__()
        self.body = nn.Sequential(
            Scaled(),
            layer(nn.Conv2d(3, 16, 6, stride=3)),
            nn.ReLU(),
            layer(nn.Conv2d(16, 32, 4, stride=2)),
            nn.ReLU(),
            nn.Flatten(),
            layer(nn.Linear(32 * 6 * 6, 256)),
            nn.ReLU(),
        )
        self.policy = layer(nn.Linear(256, actions), gain=0.01)
        self.critic = layer(nn.Linear(256, 1), gain=1.0)

    def forward(self, pictures: Tensor) -> tuple[Categorical, Tensor]:
        """Return the policy and the value of each picture, uint8, shape (N, 3, 48, 48)."""
        features = self.body(pictures)
        return Categorical(logits=self.policy(features)), self.critic(features).squeeze(1)


def layer(module: nn.Linear | nn.Conv2d, gain: float = 2**0.5) -> nn.Linear | nn.Conv2d:
    """Return a layer with orthogonal weights and no bias at first."""
    nn.init.orthogonal_(module.weight, gain)
    nn.init.zeros_(module.bias)
    return module


class Rollout:
    """What N drones have seen and done in T decisions, arrays of shape (T, N, ...)."""

    def __init__(self, steps: int, count: int) -> None:
        self.pictures = torch.zeros((steps, count, 3, 48, 48), dtype=torch.uint8)
        self.actions = torch.zeros((steps, count), dtype=torch.int64)
        self.chances, self.values, self.rewards, self.ended = torch.zeros((4, steps, count))
        """Logarithm of the action's probability, the critic's value, the reward, and 1 where an
        episode ended."""

    def advantages(self, following: Tensor, options: Options) -> Tensor:
        """Return how much better than the critic thought each decision was, shape (T, N).

        Args:
            following: The critic's value of the pictures after the last decision, shape (N,).
            options: Discount and trace.
        """
        found, later = torch.zeros_like(self.rewards), torch.zeros_like(following)
        for step in reversed(range(len(found))):
            goes_on = 1.0 - self.ended[step]
            error = self.rewards[step] + options.discount * goes_on * following - self.values[step]
            found[step] = later = error + options.discount * options.trace * goes_on * later
            following = self.values[step]
        return found


@torch.no_grad()
def collect(
    envs: EyasVectorEnv, agent: Agent, seen: Tensor, data: Rollout, options: Options
) -> tuple[Tensor, float]:
    """Fill the rollout; return the pictures after the last decision, and the mean reward."""
    total = 0.0
    for step in range(options.num_steps):
        policy, data.values[step] = agent(seen)
        action = policy.sample()
        data.pictures[step], data.actions[step] = seen, action
        data.chances[step] = policy.log_prob(action)
        pictures, reward, terminated, truncated, info = envs.step(action.numpy())
        total += reward.mean()
        data.rewards[step] = torch.as_tensor(reward)
        data.ended[step] = torch.as_tensor(terminated | truncated)
        # An episode that is cut off would have gone on: the critic says what was still to come.
        for index in np.flatnonzero(truncated):
            last = torch.as_tensor(info["final_obs"][index])[None]
            data.rewards[step, index] += options.discount * agent(last)[1][0]
        seen = torch.as_tensor(pictures)
    return seen, total / options.num_steps


def update(
    agent: Agent, optimiser: torch.optim.Adam, data: Rollout, gains: Tensor, options: Options
) -> float:
    """Learn from a rollout; return the entropy of the policy."""
    pictures, actions = data.pictures.flatten(0, 1), data.actions.flatten()
    chances, returns = data.chances.flatten(), (gains + data.values).flatten()
    for _ in range(options.epochs):
        for part in torch.randperm(len(actions)).chunk(options.minibatches):
            policy, value = agent(pictures[part])
            gain = gains.flatten()[part]
            gain = (gain - gain.mean()) / (gain.std() + 1e-8)
            ratio = (policy.log_prob(actions[part]) - chances[part]).exp()
            clipped = ratio.clamp(1.0 - options.clip, 1.0 + options.clip)
            policy_loss = -torch.min(gain * ratio, gain * clipped).mean()
            value_loss = 0.5 * (value - returns[part]).square().mean()
            entropy = policy.entropy().mean()
            loss = policy_loss + options.value * value_loss - options.entropy * entropy
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), options.max_gradient)
            optimiser.step()
    return entropy.item()


def main(options: Options | None = None) -> list[float]:
    """Train and save; return the mean reward of a decision in each update, at most 4."""
    options = options or Options()
    torch.manual_seed(options.seed)
    envs = EyasVectorEnv(options.num_envs, SETTINGS, autoreset_mode="SameStep")
    agent = Agent()
    optimiser = torch.optim.Adam(agent.parameters(), lr=options.learning_rate, eps=1e-5)
    data = Rollout(options.num_steps, options.num_envs)
    seen = torch.as_tensor(envs.reset(seed=options.seed)[0])
    size, curve, start = options.num_steps * options.num_envs, [], time.monotonic()
    updates = max(options.decisions // size, 1)
    for number in range(updates):
        optimiser.param_groups[0]["lr"] = options.learning_rate * (1.0 - number / updates)
        seen, reward = collect(envs, agent, seen, data, options)
        curve.append(reward)
        with torch.no_grad():
            gains = data.advantages(agent(seen)[1], options)
        entropy = update(agent, optimiser, data, gains, options)
        made, rate = (number + 1) * size, (number + 1) * size / (time.monotonic() - start)
        print(f"{made:8d}  reward {reward:.3f}  entropy {entropy:.2f}  {rate:.0f}/s", flush=True)
    save(agent, options.save)
    return curve


def save(agent: Agent, path: str) -> None:
    """Write the policy without the critic: a program for any number of pictures, with what `env`
    must be for it.
    """
    network = nn.Sequential(agent.body, agent.policy).eval()
    pictures = torch.zeros((2, 3, 48, 48), dtype=torch.uint8)
    several = ({0: torch.export.Dim("count", min=1, max=4096)},)
    program = torch.export.export(network, (pictures,), dynamic_shapes=several)
    torch.export.save(program, path, extra_files={"eyas.json": json.dumps(SETTINGS["env"])})


if __name__ == "__main__":
    main()
