"""Names for `gymnasium.make` and `gymnasium.make_vec`: one for each map and weather."""

import gymnasium

from eyas.world.maps import MAPS
from eyas.world.maps.imported import IMPORTED

__all__ = ["register", "register_map"]


def register() -> None:
    """Register the maps that come with Eyas and imported ones; importing `eyas` does it."""
    for name in (*MAPS.built_in, *IMPORTED.names()):
        register_map(name)


def register_map(name: str) -> None:
    """Register `eyas/<map>-<weather>-v0` for each weather of a map, unless it is registered.

    Args:
        name: Name of the map, or the path of a user's own map, as in `world.map`.

    Raises:
        ConfigError: The map does not exist.
    """
    recipe = MAPS.get(name)
    for weather in recipe.weathers:
        identifier = f"eyas/{recipe.name}-{weather}-v0"
        if identifier in gymnasium.registry:
            continue
        gymnasium.register(
            id=identifier,
            entry_point="eyas.envs.tracking_env:TrackingEnv",
            vector_entry_point="eyas.envs.vector_env:EyasVectorEnv",
            kwargs={"map": name, "weather": weather},
        )
