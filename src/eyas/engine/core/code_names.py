"""Which settings name code of a user's, by its path `package.module:attribute`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from eyas.engine.core.config import Config

__all__ = ["NAMES_CODE", "NamesCode", "code_named"]

PICKLED = (".zip", ".pt", ".pth", ".pt2")
"""Endings of files of networks that may run code when they are read."""


@dataclass(frozen=True, slots=True)
class NamesCode:
    """Marks a field, in `Annotated`, whose texts or keys with a colon are imported and called, and
    whose files in Python's own format run what is in them.
    """


NAMES_CODE = NamesCode()


def code_named(config: Config, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield each piece of code that settings name: path of the setting, and what it names.

    Args:
        config: The settings.
        path: Their own path, to put before each.
    """
    for name, field in type(config).model_fields.items():
        value, inner = getattr(config, name), f"{path}.{name}".lstrip(".")
        if NAMES_CODE in field.metadata:
            for text in _texts(value):
                if ":" in text or text.endswith(PICKLED):
                    yield inner, text
        elif isinstance(value, Config):
            yield from code_named(value, inner)
        elif isinstance(value, tuple):
            for number, part in enumerate(value):
                if isinstance(part, Config):
                    yield from code_named(part, f"{inner}.{number}")


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | tuple):
        yield from (part for part in value if isinstance(part, str))
