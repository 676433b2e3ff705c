"""Put a trained policy into the package, with its curve and what it reaches.

    python tools/ship_policy.py runs/fast fast "citystreet by day" --trained-on "..." --limit "..."
    python tools/ship_policy.py runs/eyas eyas "..." ... # or eyas-flown, of the same run
    python tools/ship_policy.py runs/eyas-words eyas-words "..." ...
    python tools/ship_policy.py --measure fast eyas      # flies them again, for new scores

The card's rows: `paper` on each map and in each weather that it has learned, and `long` on
citystreet by day; of a tracker also look-alikes, people, robots, and late actions; of a listener
`referring` only, on the maps and in the weathers that it has learned. If the run
teaches another run's network further, the card has both commands.
"""

import argparse
import csv
import json
import shutil
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from eyas import __version__
from eyas.envs.choice import settings_of_kinds
from eyas.evaluation.plan import EvaluationPlan, batches, fly_batch
from eyas.evaluation.policies.shipped import TRAINED, Card, Score, card_of, file_of
from eyas.evaluation.record import EpisodeRecord
from eyas.learning.config import Method
from eyas.learning.tracking.flights import MAPS, WEATHERS
from eyas.learning.words.scenes import PLACES
from eyas.settings.config import EyasConfig
from eyas.settings.file import load_settings

_FLOWN = "eyas-flown"
"""The tracker for flown drones: its drone begins as fast as its target."""

_OF_A_FLOWN_DRONE = {
    "tracker": {"supervised": False, "flight": "mended"},
    "start": {"velocity": "target"},
}


_REFERRING: dict[str, Any] = {"seeds": (11_000_000,), "episodes": 13}
"""What is flown of `referring`: begins of episodes on which no baseline was tuned, four flights
each."""


class Flown(NamedTuple):
    """A row of a card."""

    protocol: str
    map: str
    weather: str
    target: str = "SUMO_VEHICLE"
    latency: str = "0"
    flown: bool = False


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
    file = "policy-flown.onnx" if asked.name == _FLOWN else "policy.onnx"
    policy = shutil.copy(asked.run / file, TRAINED / f"{asked.name}.onnx")
    curve = shutil.copy(asked.run / "curve.csv", TRAINED / f"{asked.name}.csv")
    config = load_settings(asked.run / "config.json")
    match config.train.method:
        case Method.TRACKER:
            trained, flown = of_tracker(config)
        case Method.WORDS:
            trained, flown = of_listener(config)
        case _:
            trained, flown = of_network(config, curve)
    flown = on_flown_drones() if asked.name == _FLOWN else flown
    trained["command"] = command(asked.run, config)
    card = Card(
        title=asked.title,
        version=__version__,
        trained_on=asked.trained_on,
        limits=tuple(asked.limit),
        scores=tuple(score(policy, each) for each in flown),
        **trained,
    )
    write(asked.name, card)


def of_network(config: EyasConfig, curve: Path) -> tuple[dict[str, Any], list[Flown]]:
    """Return what a card says of a network, and what is flown."""
    learned = [(kind.world.map, kind.world.weather) for kind in settings_of_kinds(config)]
    with curve.open() as file:
        decisions = int(list(csv.DictReader(file))[-1]["decisions"])
    flown = [Flown("paper", *place) for place in learned] + [Flown("long", "citystreet", "day")]
    return {"decisions": decisions}, flown


def of_tracker(config: EyasConfig) -> tuple[dict[str, Any], list[Flown]]:
    """Return what a card says of a tracker, and what is flown."""
    flown = [Flown("paper", place, weather) for place in MAPS for weather in WEATHERS]
    flown += [Flown("long", place, "day") for place in MAPS[:2]]
    flown += [Flown("distractor", MAPS[0], "day")]
    flown += [Flown("paper", MAPS[0], "day", target=name) for name in ("Pedestrian", "GhostDog")]
    flown += [Flown("paper", MAPS[0], "day", latency="80")]
    return {"decisions": config.train.tracker.pictures, "entry_class": "box"}, flown


def of_listener(config: EyasConfig) -> tuple[dict[str, Any], list[Flown]]:
    """Return what a card says of a listener, and what is flown."""
    flown = [Flown("referring", place.map, place.weather) for place in PLACES]
    return {"decisions": config.train.words.pictures, "entry_class": "text+pixels"}, flown


def on_flown_drones() -> list[Flown]:
    """Return what is flown for the card of the tracker for flown drones."""
    flown = [Flown("paper", place, "day", flown=True) for place in MAPS[:2]]
    return [*flown, Flown("paper", MAPS[0], "day", latency="40", flown=True)]


def write(name: str, card: Card) -> None:
    """Write a card."""
    text = json.dumps(card.model_dump(mode="json"), indent=1) + "\n"
    (TRAINED / f"{name}.json").write_text(text)
    print(text)


def measure(name: str) -> None:
    """Fly what a card tells of again."""
    card = card_of(name)
    rows = [Flown(*(getattr(row, field) for field in Flown._fields)) for row in card.scores]
    flown = [score(file_of(name), row) for row in rows]
    write(name, card.model_copy(update={"scores": tuple(flown)}))


def command(run: Path, config: EyasConfig) -> str:
    """Return what trains the network of a run; its folder has the preset's name."""
    before = config.train.begin_from
    own = f"eyas train --preset {run.name} --seed {config.seed} --out {run}"
    if before is None:
        return own
    first = command(Path(before), load_settings(Path(before) / "config.json"))
    return f"{first} && {own} --set train.begin_from={before}"


def score(policy: Path, flown: Flown) -> Score:
    """Fly the protocol's episodes at one place."""
    plan = EvaluationPlan(
        policy=str(policy),
        protocol=flown.protocol,
        maps=(flown.map,),
        weathers=(flown.weather,),
        targets=(flown.target,),
        latency=flown.latency,
        **(_REFERRING if flown.protocol == "referring" else {}),
        settings=_OF_A_FLOWN_DRONE if flown.flown else {},
    )
    records = [
        record for batch in batches(plan) for ended in fly_batch(plan, batch) for record in ended
    ]
    cr, tsr = (float(np.mean([getattr(each, name) for each in records])) for name in ("cr", "tsr"))
    return Score(
        **flown._asdict(),
        **in_words(records),
        n=len(records),
        cr=round(cr, 1),
        tsr=round(tsr, 4),
    )


def in_words(records: list[EpisodeRecord]) -> dict[str, float]:
    """Return what only protocols in which targets are named tell."""
    found = {}
    for name, figure in (("success", "success_right"), ("language_gap", "language_gap")):
        told = [value for each in records if (value := each.figures.get(figure)) is not None]
        if told:
            found[name] = round(float(np.mean(told)), 4)
    return found


if __name__ == "__main__":
    main()
