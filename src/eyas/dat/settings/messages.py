"""Messages about settings that come from the original's file: they name its keys too."""

from collections.abc import Iterator
from contextlib import contextmanager

from eyas.dat.settings.adapter import legacy_key_of
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.config import EyasConfig

__all__ = ["named_path", "originals_named"]


def named_path(config: EyasConfig, path: str) -> str:
    """Return the path of a setting, with the original's key if the settings come from its file."""
    key = "" if config.original is None else legacy_key_of(path)
    return f"{path} ({key})" if key else path


@contextmanager
def originals_named(config: EyasConfig) -> Iterator[None]:
    """Name the original's key in errors about a setting, if the settings come from its file.

    Simulations know our settings only, so this belongs around their use.
    """
    try:
        yield
    except EyasError as error:
        path, colon, rest = str(error).partition(":")
        error.args = (f"{named_path(config, path)}{colon}{rest}",)
        raise
