"""Scenes, their packed geometry and their solids: made once, kept on disk, shared by all weathers
of a season.
"""

from collections.abc import Callable
from enum import Enum
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.doors import first_brought
from eyas.engine.core.errors import ConfigError
from eyas.engine.mesh.assembly import mirrored
from eyas.engine.render.kernels.bundles import Geometry
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.sensors.obstacles import Solids, solids_of
from eyas.engine.state.draw import PartLibrary
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import Scene
from eyas.engine.targets.catalogue import KINDS
from eyas.engine.targets.kind import Kind as TargetKind
from eyas.engine.targets.rig import part_library
from eyas.engine.traffic.network import build_network
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.planner import planner
from eyas.engine.world.maps.recipe import MapRecipe
from eyas.engine.world.street.signals import lens_levels
from eyas.engine.world.weather import Season


class Lenses(Enum):
    """What is drawn of signals that change."""

    NONE = 0
    PLAIN = 1  # The lenses that shine
    COVERING = 2  # These, and what hides an amber that does not, see `lens_levels`


def load_network(map_name: str, seed: int) -> RoadNetwork:
    """Return a map's roads: shipped for seed 0 and few others, else built by netconvert.

    Raises:
        MissingExtraError: netconvert is needed but not installed.
    """
    recipe = MAPS.get(map_name)
    return recipe.shipped_network(seed) or build_network(recipe.roads(seed))


def load_scene(map_name: str, seed: int = 0, season: Season = Season.SUMMER) -> Scene:
    """Return everything on a map that does not move."""
    return _scene(map_name, seed, season)


@lru_cache(maxsize=4)
def _scene(map_name: str, seed: int, season: Season) -> Scene:
    # `lru_cache` would tell calls apart that leave out defaults, and build the map for each.
    network, text = load_network(map_name, seed), _text_of(map_name, seed)
    origin = _origin(map_name, seed, season)
    make = partial(_built, text, network, season)
    return make() if origin is None else cached(EntryKind.SCENE, make, origin, of=Scene)


def _built(text: NDArray[np.uint8], network: RoadNetwork, season: Season) -> Scene:
    return planner().build(text.tobytes(), network, season)


@lru_cache(maxsize=4)
def _text_of(map_name: str, seed: int) -> NDArray[np.uint8]:
    """Return the plan of a map as its file tells it, UTF-8.

    It is kept apart from what is built of it: a change of a shape places nothing anew, and a
    change of a planner builds anew only what it has placed elsewhere.
    """
    recipe, network = MAPS.get(map_name), load_network(map_name, seed)
    make, data = partial(_planned, recipe, network, seed), recipe.data_hash()
    if data is None:
        return make()
    makers = recipe.plan, planner().complete, planner().text_of  # doors hide them from `make`
    inputs = (*makers, recipe.name, data, seed, network)
    return cached(EntryKind.PLAN, make, inputs, of=NDArray[np.uint8])


def _planned(recipe: MapRecipe, network: RoadNetwork, seed: int) -> NDArray[np.uint8]:
    text = recipe.shipped_plan(seed)
    if text is None:
        text = planner().text_of(recipe.complete_plan(network, seed)).encode()
    return np.frombuffer(text, np.uint8)


@lru_cache(maxsize=4)
def _origin(map_name: str, seed: int, season: Season) -> tuple[object, ...] | None:
    """Return what a scene, and so all that is made of it, depends on.

    None for a map without a folder: nobody knows what it is made of, so nothing is kept on disk.
    """
    if MAPS.get(map_name).data_hash() is None:
        return None
    makers = _built, planner().build
    return *makers, _text_of(map_name, seed), season.value, load_network(map_name, seed)


@lru_cache(maxsize=4)
def load_solids(map_name: str, seed: int, season: Season) -> Solids:
    """Return everything on a map that rays and bodies may meet."""
    make = partial(solids_of, load_scene(map_name, seed, season))
    origin = _origin(map_name, seed, season)
    return make() if origin is None else cached(EntryKind.SOLIDS, make, origin, of=Solids)


@lru_cache(maxsize=4)
def load_geometry(
    map_name: str,
    seed: int,  # Seed of the map
    season: Season,  # Season of the weather
    kinds: tuple[int, ...],  # Kinds of the moving objects, indices into `KINDS`
    *,
    lenses: Lenses = Lenses.NONE,  # Lights of signals that are parts, the last
) -> Geometry:
    """Return the geometry of a scene and of the parts of moving objects, for the kernels."""
    scene, origin = load_scene(map_name, seed, season), _origin(map_name, seed, season)
    make = partial(_packed, scene, kinds, load_textures, lenses=lenses)
    if origin is None:
        return make()
    inputs = (*origin, part_library, _chosen(kinds), _texture_maker(), lenses.value)
    return cached(EntryKind.GEOMETRY, make, inputs, of=Geometry)


def _packed(
    scene: Scene,
    kinds: tuple[int, ...],
    textures: Callable[[], dict[str, NDArray[np.uint8]]],
    *,
    lenses: Lenses,
) -> Geometry:
    left_hand = scene.network.left_hand
    parts = part_library(_chosen(kinds), left_hand=left_hand)
    return build_geometry(scene, _with_lights(parts, lenses, left_hand=left_hand), textures())


def _chosen(kinds: tuple[int, ...]) -> tuple[TargetKind, ...]:
    return tuple(KINDS[kind] for kind in kinds)


def load_parts(kinds: tuple[int, ...]) -> PartLibrary:
    """Return the parts of kinds of moving objects, indices into `KINDS`, in their order."""
    return part_library(_chosen(kinds))


def _with_lights(parts: PartLibrary, wanted: Lenses, *, left_hand: bool) -> PartLibrary:
    """Return a library with the lights of signals after its other parts."""
    if wanted is Lenses.NONE:
        return parts
    lenses = lens_levels(covers=wanted is Lenses.COVERING)
    if left_hand:
        lenses = tuple(tuple(map(mirrored, levels)) for levels in lenses)
    lamps = parts.lamps or (False,) * len(parts.parts)
    return PartLibrary((*parts.parts, *lenses), (*lamps, *(False for _ in lenses)))


def load_textures() -> dict[str, NDArray[np.uint8]]:
    """Return all textures by name."""
    return _texture_maker()()


def _texture_maker() -> Callable[[], dict[str, NDArray[np.uint8]]]:
    """Return what makes the textures, which a house of makers brings."""
    made: Callable[[], dict[str, NDArray[np.uint8]]] | None = first_brought("eyas.textures")
    if made is None:
        raise ConfigError("world.map: no house here makes textures (eyas.maps is not there)")
    return made
