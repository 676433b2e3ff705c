"""A key of an `env_config.json` that chooses between two values of a setting."""

from collections.abc import Iterator
from dataclasses import dataclass

from typing_extensions import override

from eyas.core.config import Problem
from eyas.settings.legacy.entries import Entry, Guess, Values

__all__ = ["Switch"]


@dataclass(frozen=True, slots=True)
class Switch(Entry):
    """A key that is true for one value of a field and false for the other."""

    key: str
    path: str
    on: str
    """Value of the field if the key is true."""
    off: str
    """Value of the field if the key is false."""

    @property
    @override
    def keys(self) -> tuple[str, ...]:
        return (self.key,)

    @property
    @override
    def paths(self) -> tuple[str, ...]:
        return (self.path,)

    @override
    def read(self, values: Values) -> Values:
        value = values[self.key]
        if not isinstance(value, bool):
            raise Problem((self.key,), value, "true or false").error()
        return {self.path: self.on if value else self.off}

    @override
    def write(self, fields: Values) -> Values:
        return {self.key: fields[self.path] == self.on}

    @override
    def blame(self, values: Values) -> Iterator[Guess]:
        yield Guess(self.key)
