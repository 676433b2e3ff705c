"""The command `python -m eyas.learning.tracking --out FOLDER`: trains the tracker."""

import argparse
from pathlib import Path

from eyas.core.errors import EyasError
from eyas.learning.tracking.training import TrackingConfig, train


def main() -> None:
    """Train, and print how it goes."""
    parser = argparse.ArgumentParser(prog="python -m eyas.learning.tracking", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("runs/eyas"), help="folder of the run")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    try:
        for line in train(TrackingConfig(seed=asked.seed), asked.out):
            print(line, flush=True)
    except EyasError as error:
        parser.exit(1, f"error: {error}\n")


if __name__ == "__main__":
    main()
