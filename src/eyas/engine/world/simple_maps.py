"""The simple map that stands for each map and weather, for the first lessons of a training."""

_SKINS = {
    "citystreet": "grass",
    "desert": "desert",
    "downtown": "clinker",
    "farmland": "farm",
    "lake": "lake",
    "village": "village",
}
"""The original's pairs, which keep the weather; but for two, below."""

_IN_SNOW = {"citystreet": "city", "downtown": "city"}


def simple_world(map_name: str, weather: str) -> tuple[str, str]:
    """Return map and weather of the simple map for a map in a weather; lawn for other maps."""
    skin = _SKINS.get(map_name, "grass")
    if weather == "snow":
        skin = _IN_SNOW.get(map_name, skin)
    return f"simpleway-{skin}", weather
