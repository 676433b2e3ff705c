"""The writers of a recording for which none are chosen."""

import logging

from eyas.engine.core.installed import install_command
from eyas.engine.core.pyav import has_pyav
from eyas.engine.settings.config import EyasConfig

__all__ = ["with_writers"]

_LOG = logging.getLogger("eyas")


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
