"""The camera paths by name, and a user's own by path."""

from typing import Any

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.own_code import left_out, running, takes
from eyas.engine.core.registry import Registry
from eyas.engine.sim.flights.path import CameraPath

SETTING = "video.flight"

_HERE = "eyas.engine.sim.flights.paths"

PATHS: Registry[type[Any]] = Registry(
    SETTING,
    type,
    {
        "follow": f"{_HERE}:FollowPath",
        "orbit": f"{_HERE}:Orbit",
        "fly-by": f"{_HERE}:FlyBy",
        "rise": f"{_HERE}:Rise",
        "zoom": f"{_HERE}:Zoom",
        "hover-and-pan": f"{_HERE}:HoverAndPan",
        "search": f"{_HERE}:Search",
    },
)
"""Classes of camera paths, made without arguments; `exact` and `random` are no paths."""


def path_named(name: str) -> CameraPath:
    """Return a camera path by its name, or by `package.module:Class`.

    Raises:
        ConfigError: There is no such class, or it is not a camera path.
    """
    found = PATHS.get(name)
    if left_out(found, ["sketch"]):
        raise _refused(name, "it has no 'sketch'")
    if why := takes(found):
        raise _refused(name, why)
    with running(SETTING, name):
        path = found()
    if not isinstance(path, CameraPath):
        missing = [need for need in ("in_view", "searches", "sketch") if not hasattr(path, need)]
        raise _refused(name, f"it has no '{missing[0]}'")
    return path


def _refused(name: str, why: str) -> ConfigError:
    return ConfigError(
        f"{SETTING}: {name!r} is not a camera path: {why}; allowed: a class without arguments that "
        "has in_view, searches and sketch(scene, rng)"
    )
