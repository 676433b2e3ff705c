"""A target of your own that is a class: a sprinkler on wheels, with a motion of its own.

    PYTHONPATH=examples python examples/own_target.py
    PYTHONPATH=examples eyas video --set custom.path=own_target:Sprinkler

Leave `tracks` out, and it moves by `custom.behaviour` and `custom.speed`.
"""

import math
from collections.abc import Sequence

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas import Material, Mesh, Ride, Scene, Shell

BODY, ARM = Material(tint=(0.15, 0.45, 0.20)), Material(tint=(0.95, 0.75, 0.10))
TURN = 0.8
"""Angle by which the arm turns for each metre [rad]."""


class Sprinkler:
    """A box with an arm that turns above it as it drives round and round."""

    size = (3.2, 3.2, 1.1)  # its arm sweeps a circle

    def parts(self) -> Sequence[Mesh]:
        """Return the box and the arm, each about its own origin."""
        body, arm = Shell(), Shell()
        body.box((-1.0, -0.6, 0.1), (1.0, 0.6, 0.8), BODY)
        arm.box((-1.6, -0.08, 0.0), (1.6, 0.08, 0.1), ARM)
        return body.mesh(), arm.mesh()

    def pose(self, ride: Ride) -> NDArray[np.float64]:
        """Return the poses of the box and the arm, shape (K, 2, 3, 4)."""
        poses = np.tile(np.eye(3, 4), (len(ride.travelled), 2, 1, 1))
        angle = TURN * ride.travelled
        poses[:, 1, 0, 0] = poses[:, 1, 1, 1] = np.cos(angle)
        poses[:, 1, 1, 0], poses[:, 1, 0, 1] = np.sin(angle), -np.sin(angle)
        poses[:, 1, 2, 3] = 1.0
        return poses

    def tracks(
        self, scene: Scene, time: NDArray[np.float64], count: int, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Return circles of 8 m at 2 m/s about random places, shape (S, count, 3)."""
        middle = rng.uniform(-0.25, 0.25, (count, 2)) * scene.size
        angle = time[:, None] * 2.0 / 8.0 + rng.uniform(0.0, 2.0 * math.pi, count)
        east, north = middle[:, 0] + 8.0 * np.cos(angle), middle[:, 1] + 8.0 * np.sin(angle)
        return np.stack([east, north, angle + math.pi / 2], axis=-1)


def main() -> None:
    """Fly over a sprinkler for a second."""
    config = {"custom": {"path": "own_target:Sprinkler"}, "objects": {"max_count": 3}}
    env = gymnasium.make("eyas/farmland-day-v0", config=config)
    observation, _ = env.reset(seed=1)
    for _ in range(125):
        observation, reward, ended, cut, _ = env.step(env.action_space.sample())
        if ended or cut:
            break
    print(f"{observation.shape} pixels, reward {reward:.2f}")


if __name__ == "__main__":
    main()
