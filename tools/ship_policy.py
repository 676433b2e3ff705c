"""Put a trained policy into the package, with its curve and what it reaches.

    python tools/ship_policy.py runs/fast fast "citystreet by day" --trained-on "..." --limit "..."
    python tools/ship_policy.py --measure fast robust    # flies them again, for new scores

The card's rows: `paper` on each map and in each weather that it has learned, and `long` on
citystreet by day. If the run teaches another run's network further, the card has both commands.
"""

import argparse
import csv
import json
import shutil
from pathlib import Path

import numpy as np

from eyas import __version__
from eyas.envs.choice import settings_of_kinds
from eyas.evaluation.plan import EvaluationPlan, batches, fly_batch
from eyas.evaluation.policies.shipped import TRAINED, Card, Score, card_of, file_of
from eyas.settings.config import EyasConfig
from eyas.settings.file import load_settings


def main() -> None:
    """Copy the network and the curve, fly, and write the card."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", nargs="?", type=Path, help="folder of `eyas train`")
    parser.add_argument("name", nargs="?", help="name of the policy")
    parser.add_argument("title", nargs="?", help="what it has learned, in a few words")
    parser.add_argument("--trained-on", help="see `Card`")
    parser.add_argument("--limit", action="append", default=[], help="see `Card`")
    parser.add_argument("--measure", nargs="+", metavar="NAME", help="only measure these again")
    asked = parser.parse_args()
    if asked.measure:
        for name in asked.measure:
            measure(name)
        return
    if None in (asked.run, asked.name, asked.title, asked.trained_on) or not asked.limit:
        parser.error("RUN, NAME, TITLE, --trained-on and --limit, or --measure, must be given")
    TRAINED.mkdir(exist_ok=True)
    config = load_settings(asked.run / "config.json")
    policy = shutil.copy(asked.run / "policy.onnx", TRAINED / f"{asked.name}.onnx")
    curve = shutil.copy(asked.run / "curve.csv", TRAINED / f"{asked.name}.csv")
    learned = [(kind.world.map, kind.world.weather) for kind in settings_of_kinds(config)]
    flown = [("paper", *place) for place in learned] + [("long", "citystreet", "day")]
    with curve.open() as file:
        decisions = int(list(csv.DictReader(file))[-1]["decisions"])
    card = Card(
        title=asked.title,
        command=command(asked.run, config),
        decisions=decisions,
        version=__version__,
        trained_on=asked.trained_on,
        limits=tuple(asked.limit),
        scores=tuple(score(policy, *each) for each in flown),
    )
    write(asked.name, card)


def write(name: str, card: Card) -> None:
    """Write a card."""
    text = json.dumps(card.model_dump(mode="json"), indent=1) + "\n"
    (TRAINED / f"{name}.json").write_text(text)
    print(text)


def measure(name: str) -> None:
    """Fly what a card tells of again."""
    card = card_of(name)
    flown = [score(file_of(name), row.protocol, row.map, row.weather) for row in card.scores]
    write(name, card.model_copy(update={"scores": tuple(flown)}))


def command(run: Path, config: EyasConfig) -> str:
    """Return what trains the network of a run; its folder has the preset's name."""
    before = config.train.begin_from
    own = f"eyas train --preset {run.name} --seed {config.seed} --out {run}"
    if before is None:
        return own
    first = command(Path(before), load_settings(Path(before) / "config.json"))
    return f"{first} && {own} --set train.begin_from={before}"


def score(policy: Path, protocol: str, map_name: str, weather: str) -> Score:
    """Fly the protocol's episodes at one place."""
    plan = EvaluationPlan(
        policy=str(policy), protocol=protocol, maps=(map_name,), weathers=(weather,)
    )
    records = [
        record for batch in batches(plan) for ended in fly_batch(plan, batch) for record in ended
    ]
    cr, tsr = (float(np.mean([getattr(each, name) for each in records])) for name in ("cr", "tsr"))
    return Score(
        protocol=protocol,
        map=map_name,
        weather=weather,
        n=len(records),
        cr=round(cr, 1),
        tsr=round(tsr, 4),
    )


if __name__ == "__main__":
    main()
