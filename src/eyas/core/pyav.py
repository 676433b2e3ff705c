"""PyAV, which encodes films; whoever may not install it leaves it out, and films with it.

Its wheels contain x264 and x265, which are under the GPL; see docs/licences.md.
"""

from types import ModuleType

from eyas.core.errors import ConfigError

__all__ = ["pyav"]


def pyav(purpose: str) -> ModuleType:
    """Return the module `av`.

    Args:
        purpose: What needs it, for example `video.writers: 'mp4'`.

    Raises:
        ConfigError: It is not installed.
    """
    try:
        import av
    except ImportError as error:
        raise ConfigError(
            f"{purpose} needs PyAV, which is not installed; pip install av, or do without"
        ) from error
    return av
