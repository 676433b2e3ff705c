"""What the parts of the tracker `eyas` are good for: trained and flown without each, in turn.

    python tools/ablations.py --out runs/ablations                       # all rows
    python tools/ablations.py --out runs/ablations --rows whole no-key   # some, and `whole` first

A row is trained by the shipped recipe with a third of its pictures (`--share`), or takes the
network of `whole`, and flies seeds that no card has. A row that is there already is not made again;
one that was interrupted goes on. Printed is the table of docs/following-one-target.md: TSR, and in
brackets its 95 % interval. `*`: the paired difference to `whole` has an interval without 0.
"""

import argparse
import sys
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np

import eyas
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.policies.tracker import tracker as flying
from eyas.benchmark.policies.tracker.detector import Detector, TargetDetection, TargetPrior
from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.benchmark.policies.tracker.tracker import Tracker
from eyas.benchmark.protocols.table import protocol_named
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.records.result import RESULT, cell, load_run
from eyas.benchmark.statistics.comparison import differences
from eyas.benchmark.statistics.table_rows import rows_of
from eyas.engine.core.config import updated
from eyas.engine.core.identity.build import this_build
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file
from eyas.learning.tracking import flights, lessons, training
from eyas.learning.tracking.flights import Oracle
from eyas.learning.tracking.lessons import Samples
from eyas.learning.tracking.network import DetectorNetwork

PLACES = (
    ("paper", "citystreet", "day", 24),
    ("paper", "downtown", "foggy", 24),
    ("long", "citystreet", "day", 6),
)
"""Protocol, map, weather, and number of seeds for each of the four directions at the start."""

FIRST_SEED = 60_000_000

FLAT = 300.0
"""Deviation of an expected place that says nothing in pictures of 80x60 [pixels]."""

BEGINNINGS = 0.15
"""Share of the lessons with a place, where flights have none once there is a key."""

CAR = 4.5, 1.9
"""Length and width [m]."""

Change = tuple[Any, str, Any]
"""A class or module, the name of what it has, and what stands there instead."""


class Row(NamedTuple):
    """The tracker without a part."""

    says: str
    """Its name in the table."""
    changes: tuple[Change, ...] = ()
    trained: bool = True
    """Whether it has lessons of its own; else it flies by the network of `whole`."""


def keep_no_key(
    tracker: Tracker, rows: np.ndarray, found: TargetDetection, sure: np.ndarray
) -> None:
    """Do not remember how targets look."""


tells = Tracker._clue


def tell_no_place(tracker: Tracker, rows: np.ndarray, *pose: np.ndarray) -> TargetPrior:
    """Return what the network is told, but for where a target is that it has a key of: without
    key nor place it could not know which one is meant.
    """
    clue, seen = tells(tracker, rows, *pose), tracker.env.observation
    middle = np.array((0.5 * seen.width, 0.5 * seen.height))
    return clue._replace(
        expected=np.where(clue.known[:, None], middle, clue.expected),
        spread=np.where(clue.known, FLAT, clue.spread),
    )


draws = Samples._expected


def teach_no_place(samples: Samples, *chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return expected places that say nothing in most pictures, shapes (..., 2) and (...)."""
    expected, spread = draws(samples, *chosen)
    height, width = samples._shots.picture.shape[-2:]
    middle = np.array((0.5 * width, 0.5 * height), np.float32)
    told = samples._rng.random(spread.shape) < BEGINNINGS
    return np.where(told[..., None], expected, middle), np.where(told, spread, np.float32(FLAT))


def go_straight_on(tracker: Tracker, rows: np.ndarray) -> None:
    """Leave targets that are not seen to the filter."""


def hold(tracker: Tracker, rows: np.ndarray) -> None:
    """Expect what is not seen where it was seen last."""
    unseen = rows[~tracker.sees[rows]]
    tracker.motion.place[unseen] = tracker.left[unseen]
    tracker.motion.stop(unseen, tracker.settings.speed)


def by_oracle(policy: Path, rng: np.random.Generator) -> Oracle:
    """Return who flies in later rounds instead of the tracker."""
    return Oracle(open_policy(str(policy), {}).env, rng)


places, finds = DetectorNetwork.places, Detector.find


def teach_no_deviation(network: DetectorNetwork, answers: Any) -> Any:  # noqa: ANN401  # tensors
    """Return places with a deviation of one pixel."""
    found = places(network, answers)
    found[..., 2] = 0.0  # its logarithm
    return found


def find_with_one_deviation(
    detector: Detector, pictures: np.ndarray, clue: TargetPrior
) -> TargetDetection:
    """Find targets, with a deviation of one pixel."""
    found = finds(detector, pictures, clue)
    return found._replace(spread=np.ones_like(found.spread))


begins = Tracker.begin


def begin_without_box(tracker: Tracker, start: Any) -> None:  # noqa: ANN401  # as the policy's
    """Take a car in the middle of the picture for the target."""
    begins(tracker, start)
    seen, sides = tracker.env.observation, np.array(CAR) * tracker.ground.pixels_per_metre
    middle = 0.5 * np.array((seen.width, seen.height))
    tracker.boxes[:] = np.concatenate((middle - 0.5 * sides, middle + 0.5 * sides))


ROWS = {
    "whole": Row("nothing"),
    "no-key": Row(
        "memory of which one: no key",
        ((lessons, "_UNKNOWN", 1.0), (Tracker, "_remember", keep_no_key)),
    ),
    "no-place": Row(
        "memory of where: told no place, holds the last one",
        (
            (Samples, "_expected", teach_no_place),
            (Tracker, "_clue", tell_no_place),
            (Tracker, "_go_on", go_straight_on),
            (Tracker, "_wait", hold),
            (flying, "_SURE_PIXELS", np.inf),
            (training, "TrackerSettings", partial(TrackerSettings, gate=1e3)),
        ),
    ),
    "no-course": Row(
        "where drivers go: straight on while nothing is seen",
        ((Tracker, "_go_on", go_straight_on),),
        trained=False,
    ),
    "no-own-flights": Row("own flights: all are the oracle's", ((training, "_pupil", by_oracle),)),
    "no-deviation": Row(
        "deviation of the place found: always one pixel",
        (
            (DetectorNetwork, "places", teach_no_deviation),
            (Detector, "find", find_with_one_deviation),
        ),
    ),
    "no-box": Row(
        "first box: takes what is in the middle",
        ((Tracker, "begin", begin_without_box),),
        trained=False,
    ),
    "one-map": Row("maps: only citystreet", ((flights, "_TURN", ("citystreet",)),)),
    "one-weather": Row("weathers: only day", ((flights, "WEATHERS", ("day",) * 4),)),
}


def changed(row: Row) -> ExitStack:
    """Take a part away until the stack is closed."""
    stack = ExitStack()
    for owner, name, value in row.changes:
        stack.enter_context(patch.object(owner, name, value))
    return stack


def train(folder: Path, share: float, seed: int) -> None:
    """Teach the network of a row by a share of the shipped recipe, or go on with it."""
    if (folder / "policy-flown.onnx").is_file():  # written last
        return
    config = updated(load_settings(preset_file("eyas")), {"seed": seed})
    recipe = config.train.tracker
    changes = recipe.scaled(round(share * recipe.pictures))
    config = updated(config, {"train": {"tracker": changes}})
    begun = (folder / "config.json").is_file()
    training.train(config, folder, resume=begun, say=partial(print, file=sys.stderr, flush=True))


def fly(policy: Path, folder: Path) -> list[list[EpisodeRecord]]:
    """Return the records of a row in each place; flown are those that are not there."""
    found = []
    for protocol, name, weather, count in PLACES:
        out = folder / f"{protocol}-{name}-{weather}"
        if (out / RESULT).is_file():
            found.append(load_run(out)[1])
            continue
        chosen: Any = {"map": name, "weather": weather, "episodes": count, "seeds": FIRST_SEED}
        found.append(eyas.evaluate(str(policy), protocol, out, overwrite=True, **chosen))
    return found


def told(row: Row, flown: list[list[EpisodeRecord]], whole: list[list[EpisodeRecord]]) -> str:
    """Return the line of a row in the table."""
    cells = []
    for (name, *_), records, others in zip(PLACES, flown, whole, strict=True):
        protocol = protocol_named(name)
        tsr = rows_of(records, protocol)[0].figures["tsr"]
        compared = differences(others, records, protocol)
        both = next(each for each in compared if (each.group, each.figure) == ("all", "tsr"))
        apart = both.interval is not None and not both.interval.low <= 0.0 <= both.interval.high
        cells.append(cell(tsr) + (" *" if apart else ""))
    return f"| {' | '.join([row.says, *cells])} |"


def main() -> None:
    """Make rows, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--rows", nargs="+", choices=list(ROWS), default=list(ROWS))
    parser.add_argument("--share", type=float, default=1 / 3)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    heads = [f"`{name}`, {place} {weather}" for name, place, weather, _ in PLACES]
    print(f"{asked.share:.3f} of the recipe, seed {asked.seed}, build {this_build().id}\n")
    print(f"| taken away | {' | '.join(heads)} |", "|---" * (1 + len(PLACES)) + "|", sep="\n")
    whole: list[list[EpisodeRecord]] = []
    for name in dict.fromkeys(("whole", *asked.rows)):
        row, folder = ROWS[name], asked.out / name
        with changed(row):
            if row.trained:
                train(folder, asked.share, asked.seed)
            policy = asked.out / (name if row.trained else "whole") / "policy.onnx"
            flown = fly(policy, folder)
        whole = whole or flown
        print(told(row, flown, whole), flush=True)


if __name__ == "__main__":
    main()
