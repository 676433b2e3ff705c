"""Put a trained policy into the package, with its curve and what it reaches.

    python tools/ship_policy.py runs/fast fast "citystreet by day"

Protocols and weathers of the card: `paper` in the weathers that it has learned, and `long` by day.
"""

import argparse
import csv
import json
import shutil
from pathlib import Path

import numpy as np

from eyas import __version__
from eyas.envs.choice import settings_of_kinds
from eyas.evaluation.plan import Plan, batches, fly_batch
from eyas.evaluation.policies.shipped import TRAINED, Card, Score
from eyas.settings.file import load_settings

WEATHERS = ("day", "night", "foggy", "snow")


def main() -> None:
    """Copy the network and the curve, fly, and write the card."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path, help="folder of `eyas train`")
    parser.add_argument("name", help="name of the policy and of the preset it was trained with")
    parser.add_argument("title", help="what it has learned, in a few words")
    asked = parser.parse_args()
    TRAINED.mkdir(exist_ok=True)
    config = load_settings(asked.run / "config.json")
    policy = shutil.copy(asked.run / "policy.onnx", TRAINED / f"{asked.name}.onnx")
    curve = shutil.copy(asked.run / "curve.csv", TRAINED / f"{asked.name}.csv")
    learned = {kind.world.weather for kind in settings_of_kinds(config)}
    flown = [("paper", weather) for weather in WEATHERS if weather in learned] + [("long", "day")]
    with curve.open() as file:
        decisions = int(list(csv.DictReader(file))[-1]["decisions"])
    card = Card(
        title=asked.title,
        command=f"eyas train --preset {asked.name} --seed {config.seed} --out {asked.run}",
        decisions=decisions,
        version=__version__,
        scores=tuple(score(policy, *each) for each in flown),
    )
    text = json.dumps(card.model_dump(mode="json"), indent=1) + "\n"
    (TRAINED / f"{asked.name}.json").write_text(text)
    print(text)


def score(policy: Path, protocol: str, weather: str) -> Score:
    """Fly the protocol's episodes in one weather."""
    plan = Plan(policy=str(policy), protocol=protocol, weathers=(weather,))
    records = [
        record for batch in batches(plan) for ended in fly_batch(plan, batch) for record in ended
    ]
    cr, tsr = (float(np.mean([getattr(each, name) for each in records])) for name in ("cr", "tsr"))
    return Score(
        protocol=protocol, weather=weather, n=len(records), cr=round(cr, 1), tsr=round(tsr, 4)
    )


if __name__ == "__main__":
    main()
