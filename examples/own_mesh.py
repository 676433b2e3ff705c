"""A target of your own from a mesh file: a delivery robot that wanders about.

    python examples/own_mesh.py

Settings alone do it, so every command takes it:

    eyas video --set custom='{"mesh": "examples/own_mesh.obj", "scale": 0.01}'

`eyas targets check examples/own_mesh.obj --scale 0.01` tells whether a file can be used. Reading
meshes needs the extra `mesh`.
"""

from pathlib import Path

import gymnasium

import eyas  # noqa: F401  # registers the environments

ROBOT = {
    "mesh": str(Path(__file__).with_suffix(".obj")),
    "scale": 0.01,  # from centimetres
    "behaviour": "weave",
    "speed": 1.5,
}


def main() -> None:
    """Fly over the robot for a second."""
    env = gymnasium.make("eyas/citystreet-day-v0", config={"custom": ROBOT})
    observation, _ = env.reset(seed=1)
    for _ in range(125):
        observation, reward, ended, cut, _ = env.step(env.action_space.sample())
        if ended or cut:
            break
    print(f"{observation.shape} pixels, reward {reward:.2f}")


if __name__ == "__main__":
    main()
