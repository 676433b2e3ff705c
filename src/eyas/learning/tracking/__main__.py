"""The command `python -m eyas.learning.tracking --out FOLDER`: trains the tracker."""

import argparse
from pathlib import Path

from eyas.core.errors import EyasError, MissingExtraError
from eyas.core.rng import checked_seed


def main() -> None:
    """Train, and print how it goes."""
    parser = argparse.ArgumentParser(prog="python -m eyas.learning.tracking", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("runs/eyas"), help="folder of the run")
    parser.add_argument("--seed", type=int, default=0, help="of all random numbers")
    asked = parser.parse_args()
    try:
        _train(checked_seed(asked.seed), asked.out)
    except EyasError as error:
        parser.exit(1, f"error: {error}\n")


def _train(seed: int, folder: Path) -> None:
    try:
        from eyas.learning.tracking.training import TrackingConfig, train
    except ImportError as error:
        raise MissingExtraError("the training of a tracker", "train") from error
    for line in train(TrackingConfig(seed=seed), folder):
        print(line, flush=True)


if __name__ == "__main__":
    main()
