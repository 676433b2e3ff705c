"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=True,
    brings={
        "eyas.maps": {
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
        "eyas.writers": {
            "scene": "eyas.maps.formats.gltf.flight:SceneWriter",
            "openscenario": "eyas.maps.formats.openscenario:ScenarioWriter",
        },
        "eyas.planner": {"plans": "eyas.maps.plan.planner:PLANNER"},
        "eyas.textures": {"painted": "eyas.maps.textures.shipped:build_textures"},
        "eyas.map_files": {"files": "eyas.maps.files:MAP_FILES"},
        "eyas.commands": {
            "maps": "eyas.maps.commands.app:app",
            "traffic": "eyas.maps.traffic.commands:app",
        },
    },
)
