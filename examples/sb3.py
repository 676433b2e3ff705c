"""Learn to track with stable-baselines3: `python examples/sb3.py` (extra `train`).

Ten minutes on two cores suffice for a tracker that holds its target. What matters: small pictures,
an action held for 32 ms, a short horizon, and many environments.
"""

import argparse
from pathlib import Path

from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.logger import configure

from eyas import EyasVecEnv

SETTINGS = {
    "start": {"pitch": 1.37, "height": 22.0},
    "reward": {"view_range": 1.0},
    "env": {"action_repeat": 4, "observation": {"width": 48, "height": 48, "layout": "chw"}},
}


def main() -> None:
    """Train, evaluate, save."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=400_000, help="decisions, of all drones")
    parser.add_argument("--out", type=Path, default=Path("runs/sb3"), help="folder to write to")
    said = parser.parse_args()
    model = PPO(
        "CnnPolicy",
        EyasVecEnv(32, SETTINGS),
        n_steps=64,
        batch_size=512,
        n_epochs=3,
        gamma=0.95,
        gae_lambda=0.9,
        learning_rate=5e-4,
        ent_coef=0.01,
        seed=0,
        device="cpu",
    )
    model.set_logger(configure(str(said.out), ["stdout", "csv"]))
    model.learn(said.steps)
    test = EyasVecEnv(32, {**SETTINGS, "seed": 1_000_000})
    mean, spread = evaluate_policy(model, test, n_eval_episodes=64)
    model.save(said.out / "eyas-ppo")
    print(f"reward of an episode: {mean:.0f} ± {spread:.0f} of 375; {said.out / 'eyas-ppo.zip'}")
    print(f"its curve: ep_rew_mean by total_timesteps in {said.out / 'progress.csv'}")
    print(f"to measure it: eyas evaluate --policy {said.out / 'eyas-ppo.zip'} --protocol standard")


if __name__ == "__main__":
    main()
