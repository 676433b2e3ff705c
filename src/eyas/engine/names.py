"""The names that settings and options take, as functions of Python; `eyas` offers them.

Light, as shells ask for them whenever one is opened: nothing of a simulation is imported.
"""


def list_formats() -> tuple[str, ...]:
    """Return the names of the formats of `export`."""
    from eyas.engine.recordings.format import FORMATS

    return FORMATS.names()


def list_maps() -> tuple[str, ...]:
    """Return the names of all maps, imported ones included."""
    from eyas.engine.world.maps import MAPS

    return tuple(sorted(MAPS.names()))


def list_weathers(map: str = "citystreet") -> tuple[str, ...]:  # as the setting
    """Return the names of the weathers of a map.

    Raises:
        ConfigError: There is no such map.
    """
    from eyas.engine.world.maps import MAPS

    return tuple(MAPS.get(map).weathers)


def list_targets() -> tuple[str, ...]:
    """Return the names of what can be followed, as the setting `target` takes them."""
    from eyas.engine.targets.config import TargetName

    return tuple(str(name) for name in TargetName)


def list_presets() -> tuple[str, ...]:
    """Return the names of the settings that Eyas brings along."""
    from eyas.engine.settings.preset import PRESETS

    return tuple(PRESETS)
