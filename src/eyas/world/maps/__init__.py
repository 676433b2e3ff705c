"""The maps: one folder and one line in this table each.

A user's own map is a `MapRecipe` in another package. It is found by its path
(`my_package.field:FIELD`), by the name given to `MAPS.register`, or by the name of an entry point
in the group `eyas.maps`. An imported map is found by its name, or by the path of its folder; a plan
by the path of its file.
"""

from eyas.core.registry import Registry
from eyas.world.maps.files import MAP_FILES
from eyas.world.maps.recipe import MapRecipe

__all__ = ["MAPS", "MapRecipe"]

MAPS: Registry[MapRecipe] = Registry(
    "world.map",
    MapRecipe,
    {
        "citystreet": "eyas.world.maps.citystreet:CITYSTREET",
        "downtown": "eyas.world.maps.downtown:DOWNTOWN",
        "lake": "eyas.world.maps.lake:LAKE",
        "village": "eyas.world.maps.village:VILLAGE",
        "village-bare": "eyas.world.maps.village:VILLAGE_BARE",
        "desert": "eyas.world.maps.desert:DESERT",
        "desert-bare": "eyas.world.maps.desert:DESERT_BARE",
        "farmland": "eyas.world.maps.farmland:FARMLAND",
        "farmland-bare": "eyas.world.maps.farmland:FARMLAND_BARE",
        "simpleway-grass": "eyas.world.maps.simpleway:GRASS",
        "simpleway-clinker": "eyas.world.maps.simpleway:CLINKER",
        "simpleway-desert": "eyas.world.maps.simpleway:DESERT",
        "simpleway-farm": "eyas.world.maps.simpleway:FARM",
        "simpleway-lake": "eyas.world.maps.simpleway:LAKE",
        "simpleway-village": "eyas.world.maps.simpleway:VILLAGE",
        "simpleway-city": "eyas.world.maps.simpleway:CITY",
    },
    group="eyas.maps",
    files=MAP_FILES,
)
