"""The writers by name, and the selection of those of a recording."""

from collections.abc import Sequence
from typing import Any, cast

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.own_code import left_out
from eyas.engine.core.registry import Registry
from eyas.engine.exports.frame import OUTPUTS
from eyas.engine.exports.writer import Files, Writer

SETTING = "video.writers"

WRITERS: Registry[type[Any]] = Registry(
    SETTING,
    type,
    {
        "jpeg": "eyas.engine.exports.images:JpegWriter",
        "png": "eyas.engine.exports.images:PngWriter",
        "mp4": "eyas.engine.exports.mp4:Mp4Writer",
        "webp": "eyas.engine.exports.webp:WebpWriter",
        "labels": "eyas.engine.exports.label:LabelWriter",
        "mark": "eyas.engine.exports.episode_files:MarkWriter",
        "clean": "eyas.engine.exports.images:CleanWriter",
        "cameras": "eyas.engine.exports.images:CameraWriter",
        "masks": "eyas.engine.exports.images:MaskWriter",
        "classes": "eyas.engine.exports.images:ClassWriter",
        "depth": "eyas.engine.exports.images:DepthWriter",
        "flow": "eyas.engine.exports.flow:FlowWriter",
        "normals": "eyas.engine.exports.images:NormalWriter",
        "arrays": "eyas.engine.exports.images:ArrayWriter",
        "sensors": "eyas.engine.exports.episode_files:SensorWriter",
        "lidar": "eyas.engine.exports.episode_files:LidarWriter",
        "events": "eyas.engine.exports.episode_files:EventWriter",
    },
    group="eyas.writers",
)
"""All writers; a user's own is selected by its path, `my_package.module:Class`."""


def chosen_writers(names: Sequence[str]) -> tuple[type[Writer], ...]:
    """Return the classes of writers by their names or paths.

    Raises:
        ConfigError: A writer does not exist, is not a writer, or two write the same file.
    """
    writers = tuple(_checked(name, WRITERS.get(name)) for name in names)
    taken: dict[tuple[str, str], str] = {}
    for name, writer in zip(names, writers, strict=True):
        files = writer.files
        of_episodes = [("episode", file) for file in (*files.frame, *files.episode)]
        for place in [*of_episodes, *(("run", file) for file in files.run)]:
            if place in taken:
                raise ConfigError(
                    f"{SETTING}: {taken[place]!r} and {name!r} both write '{place[1]}'"
                )
            taken[place] = name
    return writers


def _checked(name: str, found: type[Any]) -> type[Writer]:
    """Return a class after checking that it has everything that a writer needs."""
    needed = ("wants", "files", "begin", "read", "finish")
    if missing := left_out(found, needed):
        raise ConfigError(f"{SETTING}: {name!r} is not a writer: it has no '{missing[0]}'")
    writer = cast("type[Writer]", found)
    unknown = [repr(output) for output in writer.wants if output not in OUTPUTS]
    if unknown:
        known = ", ".join(OUTPUTS)
        raise ConfigError(f"{SETTING}: {name!r} wants {unknown[0]}; there is only: {known}")
    if not isinstance(writer.files, Files):
        kind = type(writer.files).__name__
        raise ConfigError(f"{SETTING}: the files of {name!r} are a {kind}, not a Files")
    return writer
