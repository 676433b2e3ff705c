"""Write the plans of maps that the package brings, so that a first start need not make them.

    python tools/ship_plans.py          # of what has changed
    python tools/ship_plans.py --check  # names what is stale

One that other code than today's has made is not used, only slower: no edit of a map needs this,
only a release (`MapRecipe.shipped_plan`).
"""

import argparse
import lzma
from collections.abc import Iterator
from pathlib import Path

from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.planner import planner
from eyas.engine.world.maps.recipe import MADE_PLAN_SUFFIX, NETWORK_FILE, MapRecipe
from eyas.lanes.container import packed


def main() -> None:
    """Write what is stale, or name it."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail if it is stale")
    check = parser.parse_args().check
    stale = [recipe for recipe in shipped() if recipe.shipped_plan(0) is None]
    for recipe in stale:
        print(f"{recipe.name}: {'stale' if check else write(recipe)}", flush=True)
    if stale and check:
        raise SystemExit(1)


def shipped() -> Iterator[MapRecipe]:
    """Yield the maps whose plans ship: those with a package of their own."""
    for name in MAPS.built_in:
        recipe = MAPS.get(name)
        if (recipe.package or "").endswith(f".{name}") and recipe.shipped(NETWORK_FILE):
            yield recipe


def write(recipe: MapRecipe) -> str:
    """Write the plan of a map; return its size."""
    network = recipe.shipped_network()
    assert network is not None
    text = planner().text_of(recipe.complete_plan(network, 0)).encode()
    content = lzma.compress(b"".join(packed(recipe.plan_code(), [text])), preset=9)
    Path(str(recipe.folder), f"{recipe.name}{MADE_PLAN_SUFFIX}").write_bytes(content)
    return f"{len(content) / 1000:.0f} kB"


if __name__ == "__main__":
    main()
