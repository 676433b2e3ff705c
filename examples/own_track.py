"""A target that goes where a file says, for example along your own GPS track.

    python examples/own_track.py
    eyas video --set same_target=true \
        --set custom='{"trajectory": "examples/own_track.csv", "body": "Pedestrian"}'

The file has a line for each point: the time [s], x and y (east and north of the middle of the map
[m]), and perhaps z [m] and yaw [rad]. Any body can follow it: a kind of the catalogue, a mesh file,
or a class. At its end it begins again. One is there at a time: `same_target` lets all drones of a
recording follow it.
"""

from pathlib import Path

import gymnasium

import eyas  # noqa: F401  # registers the environments

WALK = {"trajectory": str(Path(__file__).with_suffix(".csv")), "body": "Pedestrian"}


def main() -> None:
    """Fly over the walker for a second."""
    env = gymnasium.make("eyas/citystreet-day-v0", config={"custom": WALK})
    observation, _ = env.reset(seed=1)
    for _ in range(125):
        observation, reward, ended, cut, _ = env.step(env.action_space.sample())
        if ended or cut:
            break
    print(f"{observation.shape} pixels, reward {reward:.2f}")


if __name__ == "__main__":
    main()
