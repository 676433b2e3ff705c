"""Scenes, their packed geometry and their solids: made once, kept on disk, shared by all weathers
of a season.
"""

import logging
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from importlib.metadata import version
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.core.cache.cached import cached
from eyas.core.cache.folder import Kind
from eyas.render.ahead import other_is_ready
from eyas.render.kernels.bundles import Geometry
from eyas.render.pack.geometry import build_geometry
from eyas.render.textures.library import build_textures
from eyas.sensors.obstacles import Solids, solids_of
from eyas.state.draw import PartLibrary
from eyas.state.roads import RoadNetwork
from eyas.state.scene import Scene
from eyas.targets.catalogue import KINDS
from eyas.targets.rig import part_library
from eyas.traffic.network import build_network
from eyas.world.maps import MAPS
from eyas.world.street.signals import lens_levels
from eyas.world.weather import Season

__all__ = ["load_geometry", "load_network", "load_scene", "load_solids", "paint"]

_LOG = logging.getLogger("eyas")

Thing = TypeVar("Thing")

_MAKERS = ("world", "mesh", "state", "core/rng.py")
"""Packages whose source files determine a plan."""

_BUILDERS = (
    *(f"world/{room}" for room in ("plan", "things", "build", "buildings", "land", "plants",
                                   "roads", "street")),
    "mesh", "state", "core/rng.py",
)  # fmt: skip
"""Packages whose source files determine the scene of a plan."""


_SHAPERS = ("sensors/furniture.py", "sensors/crowns.py", "sensors/grid.py", "sensors/obstacles.py")
"""Files that make solids of a scene."""


def load_network(map_name: str, seed: int) -> RoadNetwork:
    """Return a map's roads: shipped for seed 0, built by netconvert for other seeds.

    Raises:
        MissingExtraError: netconvert is needed but not installed.
    """
    recipe = MAPS.get(map_name)
    shipped = recipe.shipped_network() if seed == 0 else None
    return shipped or build_network(recipe.roads(seed))


def load_scene(map_name: str, seed: int = 0, season: Season = Season.SUMMER) -> Scene:
    """Return everything on a map that does not move."""
    return _scene(map_name, seed, season)


@lru_cache(maxsize=4)
def _scene(map_name: str, seed: int, season: Season) -> Scene:
    # `lru_cache` would tell calls apart that leave out defaults, and build the map for each.
    recipe, network = MAPS.get(map_name), load_network(map_name, seed)
    sources = recipe.source_hash()

    def told() -> NDArray[np.uint8]:
        from eyas.world.plan.file import text_of  # not needed where the plan is kept

        return np.frombuffer(text_of(recipe.plan(network, seed)).encode(), np.uint8)

    def built(text: NDArray[np.uint8]) -> Scene:
        from eyas.world.plan.build import build_scene
        from eyas.world.plan.file import plan_of

        _LOG.info("building the map '%s', once", recipe.name)
        return build_scene(plan_of(text.tobytes()), network, season)

    if sources is None:
        return built(told())
    # The plan and what is built of it are kept apart: a change of a shape places nothing anew, and
    # a change of a planner builds anew only what it has placed elsewhere.
    roads = network.graph_hash, network.builder, version("shapely")
    inputs = recipe.name, sources, seed, *roads
    text = cached(Kind.PLAN, _MAKERS, inputs, told, of=NDArray[np.uint8])
    make = partial(built, text)
    return cached(Kind.SCENE, _BUILDERS, (text, season.value, *roads), make, of=Scene)


@lru_cache(maxsize=4)
def load_solids(map_name: str, seed: int, season: Season) -> Solids:
    """Return everything on a map that rays and bodies may meet."""
    scene = load_scene(map_name, seed, season)
    origin = _origin(map_name, seed, season, scene.network)
    return _cached(Kind.SOLIDS, _SHAPERS, origin, partial(solids_of, scene), Solids)


@lru_cache(maxsize=4)
def load_geometry(
    map_name: str, seed: int, season: Season, kinds: tuple[int, ...], *, signals: bool = False
) -> Geometry:
    """Return the geometry of a scene and of the parts of moving objects, for the kernels.

    Args:
        map_name: Name of the map.
        seed: Seed of the map.
        season: Season of the weather.
        kinds: Kinds of the moving objects, indices into `KINDS`.
        signals: Whether the lights of signals are parts, too, the last ones.
    """
    scene = load_scene(map_name, seed, season)
    names = tuple(KINDS[kind].name for kind in kinds)
    origin = _origin(map_name, seed, season, scene.network)

    def make() -> Geometry:
        other_is_ready()  # which may be to `paint`
        return build_geometry(scene, _with_lights(_parts(kinds), wanted=signals), _textures())

    inputs = None if origin is None else (*origin, names, signals)
    return _cached(Kind.GEOMETRY, ("render", "targets"), inputs, make, Geometry)


def _origin(
    map_name: str, seed: int, season: Season, network: RoadNetwork
) -> tuple[object, ...] | None:
    """Return the key that identifies a scene in the cache.

    None for a map without a package: there are no source files to tell its versions apart, so
    data made from its scenes is not kept on disk.
    """
    recipe = MAPS.get(map_name)
    sources = recipe.source_hash()
    if sources is None:
        return None
    roads = network.graph_hash, network.builder, version("shapely")
    return (recipe.name, sources, seed, season.value, *roads)


def _cached(
    kind: Kind,
    makers: tuple[str, ...],
    inputs: tuple[object, ...] | None,
    make: Callable[[], Thing],
    of: type[Thing],
) -> Thing:
    return make() if inputs is None else cached(kind, (*makers, *_MAKERS), inputs, make, of=of)


def paint(kinds: Sequence[int]) -> None:
    """Put textures, and the parts of kinds of moving objects, into the cache.

    Args:
        kinds: See `load_geometry`.
    """
    _textures()
    _parts(tuple(kinds))


def _parts(kinds: tuple[int, ...]) -> PartLibrary:
    chosen = tuple(KINDS[kind] for kind in kinds)
    names = tuple(kind.name for kind in chosen)
    return cached(
        Kind.PARTS,
        ("targets", "mesh", "state"),
        names,
        lambda: part_library(chosen),
        of=PartLibrary,
    )


def _with_lights(parts: PartLibrary, *, wanted: bool) -> PartLibrary:
    """Return a library with the lights of signals after its other parts, if they are wanted."""
    if not wanted:
        return parts
    lenses = lens_levels()
    lamps = parts.lamps or (False,) * len(parts.parts)
    return PartLibrary((*parts.parts, *lenses), (*lamps, *(False for _ in lenses)))


def _textures() -> dict[str, NDArray[np.uint8]]:
    return cached(
        Kind.TEXTURES,
        ("render", "world/build/materials.py"),
        (),
        build_textures,
        of=dict[str, NDArray[np.uint8]],
    )
