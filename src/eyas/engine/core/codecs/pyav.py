"""PyAV, which encodes MP4 and H.264: an extra, as it is large and not everyone may install it.

Its wheels contain x264 and x265, which are under the GPL; see docs/licences.md.
"""

from types import ModuleType

from eyas.engine.core.errors import MissingExtraError


def pyav(
    purpose: str,  # What needs it, for example `video.writers: 'mp4'`
) -> ModuleType:
    """Return the module `av`.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import av
    except ImportError as error:
        raise MissingExtraError(purpose, "video") from error
    return av


def has_pyav() -> bool:
    """Return whether `av` is installed and can be imported."""
    try:
        pyav("a film")
    except MissingExtraError:
        return False
    return True
