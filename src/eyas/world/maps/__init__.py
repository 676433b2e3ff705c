"""The maps: one folder each, and one line in this table.

A user's own map is a `MapRecipe` in a package of its own. It is found by its path
(`my_package.field:FIELD`), by the name it is given with `MAPS.register`, or by that of an entry
point in the group `eyas.maps`.
"""

from eyas.core.registry import Registry
from eyas.world.maps.recipe import MapRecipe

__all__ = ["MAPS", "MapRecipe"]

MAPS: Registry[MapRecipe] = Registry(
    "world.map",
    MapRecipe,
    {
        "citystreet": "eyas.world.maps.citystreet:CITYSTREET",
    },
    group="eyas.maps",
    later=("desert", "downtown", "farmland", "lake", "simpleway", "village"),
)
