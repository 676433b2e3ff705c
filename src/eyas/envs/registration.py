"""Names for `gymnasium.make`: one for each map and weather of this version."""

import gymnasium

__all__ = ["register"]

_PLACES = tuple(("citystreet", weather) for weather in ("day", "foggy", "night", "snow"))


def register() -> None:
    """Register the environments; importing `eyas` does it."""
    for map_name, weather in _PLACES:
        name = f"eyas/{map_name}-{weather}-v0"
        if name in gymnasium.registry:
            continue
        gymnasium.register(
            id=name,
            entry_point="eyas.envs.tracking_env:TrackingEnv",
            kwargs={"map": map_name, "weather": weather},
        )
