"""Train on a map of your own: `PYTHONPATH=examples python examples/custom_map.py`.

The map is that of `own_map.py`: any module or package that Python can import will do, and nothing
in Eyas is edited. Its roads and its traffic are made by SUMO on first use (extra `sumo`), the
network by PyTorch (extra `train`). From the command line, the same map is `--map own_map:FIELD`.
"""

import sys
from pathlib import Path

from eyas import EyasConfig, make_config, train


def settings(decisions: int) -> EyasConfig:
    """Return settings for a short training: small pictures, each action held for 32 ms."""
    return make_config(
        {
            "world": {"map": "own_map:FIELD"},
            "traffic": {"max_vehicles": 4},
            "start": {"pitch": 1.37, "height": 22.0},
            "env": {
                "action_repeat": 4,
                "observation": {"width": 48, "height": 48, "layout": "chw"},
            },
            "train": {
                "environments": 16,
                "updates_per_block": 4,
                "stages": [{"total_timesteps": decisions}],
                "evaluation": {"every": 0},
            },
        }
    )


def main(decisions: int = 50_000, folder: Path = Path("runs/field")) -> Path:
    """Train for a minute; return the path of the network."""
    policy = train(settings(decisions), folder, quiet=False)
    print(f"eyas evaluate --policy {policy} --map own_map:FIELD --videos")
    return policy


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
