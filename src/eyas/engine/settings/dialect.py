"""Settings in the words of another program: a house that reads them has a `Dialect` at its door."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Protocol

from eyas.engine.core.doors import first_brought
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.settings.config import EyasConfig

Nested = Mapping[str, Any]


class Dialect(Protocol):
    """The settings of another program. Its keys begin with a capital letter, ours with none."""

    file: str  # Name of its file beside a recording

    def is_spoken(self, values: Nested) -> bool:
        """Return whether the content of a file is in this dialect."""
        ...

    def read(self, values: Nested, path: Path) -> EyasConfig:
        """Return the settings of a file.

        Raises:
            EyasError: A key or a value is wrong: one line with its path.
        """
        ...

    def changed(
        self,
        config: EyasConfig,  # The settings
        changes: Nested,  # Its keys
        path: Path | None,  # The file that the settings come from; None: there is none
    ) -> EyasConfig:
        """Return settings with some of its keys changed; errors as from `read`."""
        ...

    def check(self, config: EyasConfig) -> None:
        """Refuse values in `config.original` that no file of it can hold; errors as from `read`."""
        ...

    def key_of(self, path: str) -> str:
        """Return its key for a setting of ours, for messages; empty if there is none."""
        ...

    def save(self, config: EyasConfig, path: Path) -> bool:
        """Write its file if it can express the settings; return whether it is written.

        Raises:
            OutputError: The file cannot be written.
        """
        ...

    def content_of(self, config: EyasConfig) -> dict[str, Any]:
        """Return the content of its file.

        Raises:
            ConfigError: Its keys cannot express a value.
        """
        ...

    def of_a_run(self, config: EyasConfig, seed: int | None = None) -> EyasConfig:
        """Return the settings of one run, where a file leaves its seed and traffic open.

        Args:
            config: The settings.
            seed: The seed, if the settings have none; None: it is drawn, and a line names it.
        """
        ...

    def started(self, config: EyasConfig, channels: int) -> EyasConfig:
        """Return settings by which the first episode of a recording with so many channels begins
        when it does in the other program.
        """
        ...


@cache
def dialect() -> Dialect | None:
    """Return the dialect that a house reads; None without such a house."""
    found: Dialect | None = first_brought("eyas.dialects")
    return found


def spoken(what: str) -> Dialect:
    """Return the dialect.

    Raises:
        ConfigError: No house reads it.
    """
    found = dialect()
    if found is None:
        raise ConfigError(f"{what}: the keys of another program, and no house here reads them")
    return found


def named_path(config: EyasConfig, path: str) -> str:
    """Return the path of a setting, with the dialect's key if the settings come from its file."""
    key = "" if config.original is None else spoken("original").key_of(path)
    return f"{path} ({key})" if key else path


@contextmanager
def originals_named(config: EyasConfig) -> Iterator[None]:
    """Name the dialect's key in errors about a setting, if the settings come from its file.

    Simulations know our settings only, so this belongs around their use.
    """
    try:
        yield
    except EyasError as error:
        path, colon, rest = str(error).partition(":")
        error.args = (f"{named_path(config, path)}{colon}{rest}",)
        raise


def of_a_run(
    config: EyasConfig,  # The settings
    seed: int | None = None,  # See `Dialect.of_a_run`
) -> EyasConfig:
    """Return the settings of one run, where a file of a dialect leaves its seed and traffic open.

    Others are returned as they are.
    """
    return config if config.original is None else spoken("original").of_a_run(config, seed)
