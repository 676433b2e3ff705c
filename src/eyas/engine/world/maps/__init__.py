"""The table of maps, which houses and packages fill, and the recipe of one.

A user's own map is a `MapRecipe` in another package. It is found by its path
(`my_package.field:FIELD`), by the name given to `MAPS.register`, or by the name of an entry point
in the group `eyas.maps`. An imported map is found by its name, or by the path of its folder; a plan
by the path of its file.
"""

from eyas.engine.core.registry import Registry
from eyas.engine.world.maps.recipe import MapRecipe

__all__ = ["MAPS", "MapRecipe"]

MAPS: Registry[MapRecipe] = Registry(
    "world.map", MapRecipe, group="eyas.maps", files="eyas.map_files"
)
