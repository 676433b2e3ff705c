"""Advantages against their definition, and whether a policy gets better at what it can learn."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from eyas.learning.algorithm import Learner
from eyas.learning.config import PpoConfig, TrainConfig
from eyas.learning.network import NetworkShape, TrackingNetwork
from eyas.learning.ppo import Ppo
from eyas.learning.rollout import Rollout
from eyas.learning.shards import TorchThreads


def rollout(steps, count, shape=None, seed=0):
    rng = np.random.default_rng(seed)
    shape = shape or NetworkShape(3, 24, 24, 8, memory=False)
    size = (steps, count)
    return Rollout(
        pictures=torch.from_numpy(rng.integers(0, 256, (*size, 3, 24, 24), np.uint8)),
        states=torch.zeros(*size, shape.state),
        actions=torch.from_numpy(rng.integers(0, 7, size)),
        log_probability=torch.full(size, -np.log(7.0)).float(),
        rewards=torch.from_numpy(rng.normal(size=size)).float(),
        values=torch.from_numpy(rng.normal(size=(steps + 1, count))).float(),
        ended=torch.from_numpy(rng.random(size) < 0.2).float(),
        labels=torch.zeros(size, dtype=torch.long),
        weights=torch.zeros(size),
    )


def test_advantages_are_the_weighted_sum_of_later_errors():
    data, gamma, gae_lambda = rollout(12, 5), 0.9, 0.7
    got = data.advantages(gamma, gae_lambda).numpy()
    r, v, e = (array.numpy() for array in (data.rewards, data.values, data.ended))
    for n in range(5):
        for t in range(12):
            total, weight = 0.0, 1.0
            for later in range(t, 12):
                following = 0.0 if e[later, n] else v[later + 1, n]
                total += weight * (r[later, n] + gamma * following - v[later, n])
                weight *= 0.0 if e[later, n] else gamma * gae_lambda
            assert got[t, n] == pytest.approx(total, abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("memory", [False, True])
def test_an_action_that_is_rewarded_becomes_likely(memory):
    """Two pictures, each with one action that is rewarded."""
    config = TrainConfig(learning_rate=8e-3, gamma=0.0, hidden=16, memory=memory)
    shape = NetworkShape(3, 24, 24, 16, memory=memory)
    network = TrackingNetwork(shape)
    generator = torch.Generator().manual_seed(0)
    network.initialise(generator)
    optimiser = torch.optim.Adam(network.parameters(), config.learning_rate)
    data = rollout(8, 8, shape)
    bright = torch.arange(8) % 2
    data.pictures[:] = (bright * 200 + 20).to(torch.uint8)[None, :, None, None, None]
    good, state = torch.tensor([2, 5])[bright], torch.zeros(8, shape.state)
    learned = Ppo(Learner(network, optimiser, config, generator, TorchThreads(2)), config.ppo)
    for _ in range(15):
        with torch.no_grad():
            logits, value, _ = network(data.pictures[0], state)
        data.actions[:] = torch.multinomial(logits.softmax(1), 8, True, generator=generator).T
        data.log_probability[:] = logits.log_softmax(1).gather(1, data.actions.T).T
        data.rewards[:] = (data.actions == good).float()
        data.values[:] = value
        data.ended[:] = 1.0  # each decision is an episode
        learned.update(data)
    chances = network(data.pictures[0], state)[0].softmax(1).gather(1, good[:, None])
    assert chances.min() > 0.9


@pytest.mark.parametrize(("change", "gain", "learns"), [
    (0.1, 1.0, True), (0.3, 1.0, False), (-0.3, 1.0, True),
    (-0.1, -1.0, True), (-0.3, -1.0, False), (0.3, -1.0, True),
])  # fmt: skip
def test_a_policy_that_has_moved_far_enough_is_pushed_no_farther(change, gain, learns):
    """The objective of Schulman et al. 2017, equation 7, by its gradient."""
    config = TrainConfig(vf_coef=0.0, hidden=16)
    shape = NetworkShape(3, 24, 24, 16, memory=False)
    network = TrackingNetwork(shape)
    network.initialise(torch.Generator().manual_seed(0))
    data = rollout(4, 4, shape)
    with torch.no_grad():
        logits, _, _ = network(data.pictures.flatten(0, 1), data.states.flatten(0, 1))
    own = logits.log_softmax(1).gather(1, data.actions.flatten()[:, None])[:, 0]
    data.log_probability[:] = (own - np.log1p(change)).view(4, 4)  # so that the ratio is 1 + change
    learner = Learner(network, None, config, torch.Generator(), TorchThreads(1))
    learned = Ppo(learner, PpoConfig(clip_range=0.2, ent_coef=0.0))
    gains = torch.full((4, 4), gain)
    loss, _ = learned.loss(data, gains, data.values[:-1], torch.arange(16), 1.0)
    gradients = torch.autograd.grad(loss, tuple(network.parameters()))
    assert any(bool(part.abs().max() > 1e-6) for part in gradients) == learns
