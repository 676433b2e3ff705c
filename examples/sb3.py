"""Learn to track with stable-baselines3: `python examples/sb3.py` (extra `train`).

Ten minutes on two cores suffice for a tracker that holds its target. What matters: small pictures,
an action held for 32 ms, a short horizon, and many environments.
"""

from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy

from eyas import EyasVecEnv

SETTINGS = {
    "start": {"pitch": 1.37, "height": 22.0},
    "reward": {"view_range": 1.0},
    "env": {"action_repeat": 4, "observation": {"width": 48, "height": 48, "layout": "chw"}},
}


def main(decisions: int = 400_000) -> None:
    """Train, evaluate, save."""
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
        verbose=1,
    )
    model.learn(decisions)
    test = EyasVecEnv(32, {**SETTINGS, "seed": 1_000_000})
    mean, spread = evaluate_policy(model, test, n_eval_episodes=64)
    print(f"reward of an episode: {mean:.0f} ± {spread:.0f} of 375")
    model.save("eyas-ppo")


if __name__ == "__main__":
    main()
