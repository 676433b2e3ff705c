"""Plans of maps as files: written for any map, and checked."""

import gzip
from dataclasses import replace
from pathlib import Path

from eyas.core.errors import ConfigError
from eyas.core.files import write_atomic
from eyas.sim.scenes import load_network
from eyas.world.maps import MAPS
from eyas.world.maps.recipe import PLAN_SUFFIXES
from eyas.world.plan.file import problems, write_plan
from eyas.world.plan.plan import Roads

__all__ = ["check", "run"]


def run(name: str, seed: int, path: Path) -> list[Path]:
    """Write the complete plan of a map, and its streets where they are of no graph.

    Args:
        name: Name of the map.
        seed: Seed of the map.
        path: The file, whose name ends in `.plan.json` or `.plan.json.gz`.

    Returns:
        The files.

    Raises:
        EyasError: The map cannot be made, or a file not written.
    """
    suffix = next((one for one in PLAN_SUFFIXES if path.name.endswith(one)), None)
    if suffix is None:
        allowed = " or ".join(PLAN_SUFFIXES)
        raise ConfigError(f"--out: {path.name!r} is not allowed: a name that ends in {allowed}")
    recipe, made = MAPS.get(name), [path]
    graph, plan = recipe.roads(seed), recipe.plan(load_network(name, seed), seed)
    roads = Roads(nodes=graph.nodes, edges=graph.edges)
    if graph.finished:
        streets = path.with_name(f"{path.name.removesuffix(suffix)}.net.xml.gz")
        write_atomic(streets, gzip.compress(graph.finished, mtime=0))
        roads, made = Roads(file=streets.name), [path, streets]
    title = plan.title or recipe.title
    write_plan(path, replace(plan, title=title, attribution=recipe.attribution(), roads=roads))
    return made


def check(path: Path) -> list[str]:
    """Return what is wrong with a plan in a file, a line each."""
    return problems(path)
