"""The maps: one folder and one line in this table each.

A user's own map is a `MapRecipe` in another package. It is found by its path
(`my_package.field:FIELD`), by the name given to `MAPS.register`, or by the name of an entry point
in the group `eyas.maps`.
"""

from eyas.core.registry import Registry
from eyas.world.maps.recipe import MapRecipe

__all__ = ["MAPS", "MapRecipe"]

MAPS: Registry[MapRecipe] = Registry(
    "world.map",
    MapRecipe,
    {
        "citystreet": "eyas.world.maps.citystreet:CITYSTREET",
        "desert": "eyas.world.maps.desert:DESERT",
        "village": "eyas.world.maps.village:VILLAGE",
    },
    group="eyas.maps",
    later=("downtown", "farmland", "lake", "simpleway"),
)
