"""Writers of a recording: those that are chosen, the default, and formats of `eyas export` among
`video.writers`, which are written of the recording when it is complete.
"""

import logging
from collections.abc import Sequence
from pathlib import Path

from eyas.engine.core.codecs.pyav import has_pyav
from eyas.engine.core.errors import UnknownNameError
from eyas.engine.core.installed import install_command
from eyas.engine.exports.registry import SETTING, WRITERS
from eyas.engine.recordings.export import ExportOptions, export, exports_folder, formats_needs
from eyas.engine.recordings.format import FORMATS
from eyas.engine.recordings.recording import load
from eyas.engine.settings.config import EyasConfig
from eyas.engine.terminal.progress import frames_bar

_LOG = logging.getLogger("eyas")


def formats_in(names: Sequence[str]) -> tuple[str, ...]:
    """Return those of the names in `video.writers` that are formats."""
    return tuple(name for name in names if _is_format(name))


def writers_in(names: Sequence[str]) -> tuple[str, ...]:
    """Return the writers among these names, and those of whose files the formats are made.

    Raises:
        ConfigError: A name is neither that of a writer nor that of a format.
    """
    formats = formats_in(names)
    known = (*WRITERS.names(), *FORMATS.names())
    for name in names:
        if ":" not in name and name not in known:
            raise UnknownNameError(SETTING, name, known, others="package.module:attribute")
    writers = [name for name in names if name not in formats]
    needed = formats_needs(formats)
    if "png" in writers:  # pictures of either kind will do
        needed = [name for name in needed if name != "jpeg"]
    return tuple(dict.fromkeys((*writers, *needed)))


def write_formats(names: Sequence[str], folder: Path, *, quiet: bool) -> None:
    """Write the formats among these names of a complete recording into its `exports`.

    Raises:
        OutputError: A format cannot be written; the recording itself is complete.
        DataFileError: The recording has no frames.
    """
    formats = formats_in(names)
    if not formats:
        return
    recording = load(folder)
    for name in formats:
        with frames_bar(f"writing {name}", recording.frame_count, quiet=quiet) as progress:
            target = exports_folder(folder, name, None)
            export(recording, name, target, ExportOptions(resume=True), progress)


def _is_format(name: str) -> bool:
    if ":" in name:
        return hasattr(WRITERS.get(name), "needs")
    return name in FORMATS.names()


def with_writers(config: EyasConfig, *, quiet: bool) -> EyasConfig:
    """Return settings whose writers, if none are chosen, write what there is: the lidar's file, if
    it is on, and an animated WebP, if PyAV is not installed, which a line says unless `quiet`.
    """
    video = config.video
    writers = type(video)().writers
    if video.writers != writers:
        return config
    if not has_pyav():
        writers = tuple("webp" if name == "mp4" else name for name in writers)
        if not quiet:
            _LOG.info("films are animated WebP; for MP4: %s", install_command("video"))
    writers += ("lidar",) if config.lidar.enabled else ()
    return config.model_copy(update={"video": video.model_copy(update={"writers": writers})})
