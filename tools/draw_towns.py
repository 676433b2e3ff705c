"""Draws the towns of `recover-wide`: prints them as `eyas.benchmark.protocols.recover` lists them.

python tools/draw_towns.py          # some 15 minutes of processor time; needs the extra sumo

Kinds take turns, and each town tries the next seed from 900,000,101 on. A seed is left out where
too few starts lose their target below a roof, or where `follow`, which knows the place at all
times, does not see the target again after each loss.
"""

import argparse
from dataclasses import replace

from eyas.benchmark.episodes.episode import FIRST_SEED, Place
from eyas.benchmark.flight.batch_flight import BatchFlight
from eyas.benchmark.plan.latency import delay_from
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.protocols.recover import RECOVER_WIDE
from eyas.engine.core.errors import SpawnError
from eyas.engine.core.rng import TEST_SEEDS

KINDS = ("DOWNTOWN", "VILLAGE", "FARMLAND", "CITYSTREET", "LAKE")
FIRST = 101  # Counted from `TEST_SEEDS`
RULES = replace(RECOVER_WIDE, drawn=())  # A hash of its own, so that the list can be drawn again


def flyable(rules: Protocol, name: str) -> str:
    """Return why a town is left out; nothing where it is not."""
    place = Place(name, "day", "SUMO_VEHICLE")
    try:
        episodes = rules.choose([place], rules, rules.episodes, FIRST_SEED)
    except SpawnError:
        return "too few losses below roofs"
    policy = open_policy("follow", rules.oracles)
    flown = BatchFlight(episodes, rules, policy, delay_from("0")).fly()
    lost = [one.name for ended in flown for one in ended if one.figures["recovered"] != 1.0]
    return f"'follow' loses in {', '.join(lost)}" if lost else ""


def main() -> None:
    """Draw them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=50)
    asked = parser.parse_args()
    seed, drawn = FIRST, dict[str, list[int]]()
    for number in range(asked.count):
        kind = KINDS[number % len(KINDS)]
        while why := flyable(RULES, f"eyas.maps.covered:{kind}:{TEST_SEEDS + seed}"):
            print(f"{kind} {seed}: left out: {why}", flush=True)
            seed += 1
        drawn.setdefault(kind, []).append(seed)
        print(f"{kind} {seed}", flush=True)
        seed += 1
    for kind, seeds in drawn.items():
        print(f'    "{kind}": ({", ".join(map(str, seeds))}),')


if __name__ == "__main__":
    main()
