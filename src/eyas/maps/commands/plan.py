"""A map as a plan in a file: written by `eyas maps plan`, checked by `eyas maps check`."""

import gzip
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.core.files import write_atomic
from eyas.engine.sim.scenes import load_network
from eyas.engine.traffic.net_file import SumoNet, road_network
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import PLAN_SUFFIXES
from eyas.maps.files import roads_in
from eyas.maps.plan.file import write_plan
from eyas.maps.plan.plan import MapPlan, Roads


def write_plan_of(name: str, seed: int, path: Path) -> list[Path]:
    """Write the complete plan of a map, and its streets where they are of no graph.

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
    graph, plan = recipe.roads(seed), recipe.complete_plan(load_network(name, seed), seed)
    roads = Roads(nodes=graph.nodes, edges=graph.edges, left_hand=graph.left_hand)
    if graph.finished:
        streets = path.with_name(f"{path.name.removesuffix(suffix)}.net.xml.gz")
        write_atomic(streets, gzip.compress(graph.finished, mtime=0))
        roads, made = Roads(file=streets.name), [path, streets]
    title = plan.title or recipe.title
    write_plan(path, replace(plan, title=title, attribution=recipe.attribution(), roads=roads))
    return made


def named_file_problems(plan: MapPlan, folder: Path) -> Iterator[str]:
    """Yield what is wrong with the file that a plan names, its roads, a line each."""
    if not plan.roads.file:
        return
    path = folder / plan.roads.file
    try:
        network = road_network(SumoNet(roads_in(path), str(path)), "")
    except EyasError as error:
        yield f"roads.file: {error}"
        return
    lanes = np.abs(network.lane_points)
    outside = int((lanes > 0.5 * np.array(plan.size)).any(axis=1).sum())
    if outside:
        width, height = plan.size
        low, high = network.lane_points.min(axis=0), network.lane_points.max(axis=0)
        yield (
            f"roads.file: {plan.roads.file!r} is not allowed: {outside} of {len(lanes)} points of "
            f"its lanes are outside of size, {width:g} x {height:g} m about the origin; they reach "
            f"from ({low[0]:.0f}, {low[1]:.0f}) to ({high[0]:.0f}, {high[1]:.0f})"
        )
