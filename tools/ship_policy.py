"""Put a trained policy into the package, with its curve and its card.

    python tools/ship_policy.py runs/fast fast "citystreet by day" --trained-on "..." --limit "..."
    python tools/ship_policy.py runs/eyas eyas "..." ... # or eyas-flown, of the same run
    python tools/ship_policy.py runs/eyas-words eyas-words "..." ...

What it reaches is flown afterwards, by `python tools/write_tables.py`: tests fail until the tables
of this policy are those of the new network.
"""

import argparse
import csv
import json
import shutil
from pathlib import Path
from typing import Any

from eyas import __version__
from eyas.benchmark.policies.shipped import TRAINED, PolicyCard
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings

_FLOWN = "eyas-flown"
"""The tracker for flown drones, of the same run as `eyas`."""


def main() -> None:
    """Copy the network and the curve, and write the card."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path, help="folder of `eyas train`")
    parser.add_argument("name", help="name of the policy")
    parser.add_argument("title", help="what it has learned, in a few words")
    parser.add_argument("--trained-on", required=True, help="see `PolicyCard`")
    parser.add_argument("--limit", action="append", required=True, help="see `PolicyCard`")
    asked = parser.parse_args()
    TRAINED.mkdir(exist_ok=True)
    file = "policy-flown.onnx" if asked.name == _FLOWN else "policy.onnx"
    shutil.copy(asked.run / file, TRAINED / f"{asked.name}.onnx")
    curve = shutil.copy(asked.run / "curve.csv", TRAINED / f"{asked.name}.csv")
    config = load_settings(asked.run / "config.json")
    card = PolicyCard(
        title=asked.title,
        version=__version__,
        trained_on=asked.trained_on,
        limits=tuple(asked.limit),
        command=command(asked.run, config),
        **of_method(config, curve),
    )
    write(asked.name, card)


def of_method(config: EyasConfig, curve: Path) -> dict[str, Any]:
    """Return the number of decisions, and the class of entry, by the method of training."""
    match config.train.method:
        case "tracker":
            return {"decisions": config.train.tracker.pictures, "entry_class": "box"}
        case "words":
            return {"decisions": config.train.words.pictures, "entry_class": "text+pixels"}
    with curve.open() as file:
        return {"decisions": int(list(csv.DictReader(file))[-1]["decisions"])}


def write(name: str, card: PolicyCard) -> None:
    """Write a card."""
    text = json.dumps(card.model_dump(mode="json"), indent=1) + "\n"
    (TRAINED / f"{name}.json").write_text(text)
    print(text)


def command(run: Path, config: EyasConfig) -> str:
    """Return what trains the network of a run; its folder has the preset's name."""
    before = config.train.begin_from
    own = f"eyas train --preset {run.name} --seed {config.seed} --out {run}"
    if before is None:
        return own
    first = command(Path(before), load_settings(Path(before) / "config.json"))
    return f"{first} && {own} --set train.begin_from={before}"


if __name__ == "__main__":
    main()
