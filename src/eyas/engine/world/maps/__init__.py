"""The maps: one folder and one line in this table each.

A user's own map is a `MapRecipe` in another package. It is found by its path
(`my_package.field:FIELD`), by the name given to `MAPS.register`, or by the name of an entry point
in the group `eyas.maps`. An imported map is found by its name, or by the path of its folder; a plan
by the path of its file.
"""

from eyas.engine.core.registry import Registry
from eyas.engine.world.maps.files import MAP_FILES
from eyas.engine.world.maps.recipe import MapRecipe

__all__ = ["MAPS", "MapRecipe"]

MAPS: Registry[MapRecipe] = Registry(
    "world.map",
    MapRecipe,
    {
        "citystreet": "eyas.maps.citystreet:CITYSTREET",
        "downtown": "eyas.maps.downtown:DOWNTOWN",
        "lake": "eyas.maps.lake:LAKE",
        "village": "eyas.maps.village:VILLAGE",
        "village-bare": "eyas.maps.village:VILLAGE_BARE",
        "desert": "eyas.maps.desert:DESERT",
        "desert-bare": "eyas.maps.desert:DESERT_BARE",
        "farmland": "eyas.maps.farmland:FARMLAND",
        "farmland-bare": "eyas.maps.farmland:FARMLAND_BARE",
        "simpleway-grass": "eyas.maps.simpleway:GRASS",
        "simpleway-clinker": "eyas.maps.simpleway:CLINKER",
        "simpleway-desert": "eyas.maps.simpleway:DESERT",
        "simpleway-farm": "eyas.maps.simpleway:FARM",
        "simpleway-lake": "eyas.maps.simpleway:LAKE",
        "simpleway-village": "eyas.maps.simpleway:VILLAGE",
        "simpleway-city": "eyas.maps.simpleway:CITY",
    },
    group="eyas.maps",
    files=MAP_FILES,
)
