"""Tell which roads and recordings in the package other code has made than that of today.

    python tools/shipped_data.py            # names what is stale; nothing is made
    python tools/shipped_data.py --confirm  # makes what is stale again (SUMO, a minute each),
                                            # compares, and notes that today's code gives the same
    python tools/shipped_data.py --note     # notes it for what has just been made anew

The notes, `shipped_data.json` beside this file, hold the code that made each file
(`eyas.engine.core.identity.program`): all that it refers to, but for `core` and `lanes`, whose own
tests hold what they compute to the bit. What comes out otherwise is made anew with `eyas traffic
record --map NAME --canonical`. `tests/maps/test_shipped_data.py` fails where something is stale.
"""

import argparse
import json
from collections.abc import Callable, Iterator
from functools import partial
from hashlib import sha256
from pathlib import Path

import numpy as np

from eyas.engine.core.identity.program import closure_of, definitions_of
from eyas.engine.sim.cover import cover_of
from eyas.engine.traffic.library import _recorded
from eyas.engine.traffic.network import build_network
from eyas.engine.traffic.record import record
from eyas.engine.traffic.recording_file import RecordingFile
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import TEST_TOWNS, MapRecipe, network_file
from eyas.engine.world.roads.network_file import load_network

NOTES = Path(__file__).with_suffix(".json")

ELSEWHERE = ("eyas.engine.core.", "eyas.lanes.")


def main() -> None:
    """Print what is stale, or make it again."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--confirm", action="store_true", help="make again what is stale")
    parser.add_argument("--note", action="store_true", help="note that today's code made all")
    options = parser.parse_args()
    notes = read_notes()
    stale = []
    for recipe, path in files():
        name = name_of(path)
        known, now = notes.get(name), noted(recipe, path)
        if known != now and not options.note:
            same = options.confirm and is_the_same(recipe, path)
            print(f"{name}: {'comes out the same' if same else 'made by other code'}", flush=True)
            if not same:
                stale.append(name)
                continue
        notes[name] = now
        NOTES.write_text(json.dumps(notes, indent=1, sort_keys=True) + "\n")
    if stale:
        raise SystemExit(f"{len(stale)} files are stale")


def read_notes() -> dict[str, list[str]]:
    """Return what made each file when it was last compared."""
    notes: dict[str, list[str]] = json.loads(NOTES.read_text()) if NOTES.exists() else {}
    return notes


def name_of(path: Path) -> str:
    """Return the name of a file in the notes."""
    return f"{path.parent.name}/{path.name}"


def files() -> Iterator[tuple[MapRecipe, Path]]:
    """Yield the roads and recordings in the package, each with a map that uses it."""
    seen = set()
    for name in MAPS.built_in:
        recipe = MAPS.get(name)
        networks = (recipe.shipped(network_file(seed)) for seed in (0, *TEST_TOWNS))
        for file in (*networks, *recipe.shipped_traffic()):
            if file is not None and str(file) not in seen:
                seen.add(str(file))
                yield recipe, Path(str(file))


def noted(recipe: MapRecipe, path: Path) -> list[str]:
    """Return what identifies the code that makes a file, and its content."""
    maker = build_network if path.name.startswith("network") else _recorded
    return [code_of(maker), code_of(recipe.roads), sha256(path.read_bytes()).hexdigest()[:32]]


def code_of(what: Callable[..., object]) -> str:
    """Return what identifies the code of a function, whatever the versions of libraries."""
    while isinstance(what, partial) or hasattr(what, "__wrapped__"):
        what = what.func if isinstance(what, partial) else what.__wrapped__
    code = sorted(
        f"{module}:{name} {definitions_of(module)[name].digest}"
        for module, name in closure_of(what.__module__, what.__qualname__)
        if module.startswith("eyas.") and not module.startswith(ELSEWHERE) and name
    )
    return sha256("\n".join(code).encode()).hexdigest()[:32]


def is_the_same(recipe: MapRecipe, path: Path) -> bool:
    """Make a file again and compare what is in it."""
    if path.name.startswith("network"):
        town = int(path.stem.partition("-")[2] or 0)
        old, new = load_network(path), build_network(recipe.roads(town))
        names = (name for name in old.__slots__ if name != "builder")
        return all(np.array_equal(getattr(old, name), getattr(new, name)) for name in names)
    old = RecordingFile.read(path).load()
    origin = old.provenance  # which tells SUMO's version, too
    town, config = origin.map_seed, origin.config
    cover = cover_of(origin.map_name, town) if origin.cover else ()
    roads, span = recipe.roads(town), origin.duration
    new = record(origin.map_name, town, roads, config, span, config.seed or 0, cover=cover)
    return all(np.array_equal(getattr(old, name), getattr(new, name)) for name in MOVES)


MOVES = ("position", "yaw", "present", "vehicle_types", "vehicle_length")
"""What a recording says of its vehicles."""


if __name__ == "__main__":
    main()
