"""The original's path of a world file, which contains map and weather."""

from collections.abc import Iterator
from dataclasses import dataclass

from typing_extensions import override

from eyas.dat.settings.entries import Guess, LegacyEntry, Values
from eyas.engine.core.config import shown
from eyas.engine.core.errors import ConfigError
from eyas.engine.world.config import world_of

__all__ = ["WorldPath"]

_SIMPLE = "simpleway"  # First part of the names of the simple maps


@dataclass(frozen=True, slots=True)
class WorldPath(LegacyEntry):
    """The path of a world file, see `world_of`."""

    key: str
    map: str
    weather: str

    @property
    @override
    def keys(self) -> tuple[str, ...]:
        return (self.key,)

    @property
    @override
    def paths(self) -> tuple[str, ...]:
        return self.map, self.weather

    @override
    def read(self, values: Values) -> Values:
        path = values[self.key]
        if path is None:
            return {}
        if not isinstance(path, str):
            raise ConfigError(f"{self.key}: {shown(path)} is not allowed: text")
        found = world_of(path)
        return {} if found is None else dict(zip((self.map, self.weather), found, strict=True))

    @override
    def remarks(self, values: Values) -> Iterator[str]:
        path = values[self.key]
        if path is not None and not self.read(values):
            yield f"{self.key}: {shown(path)} contains no map and weather, so it is ignored"

    @override
    def write(self, fields: Values) -> Values:
        name, weather = fields[self.map], fields[self.weather]
        joint = "_" if str(name).startswith(f"{_SIMPLE}-") else "-"
        said = {self.key: f"worlds/{name}{joint}{weather}.wbt"}
        if self.read(said) != {self.map: name, self.weather: weather}:
            raise ConfigError(f"{self.map}: {shown(name)} cannot be expressed in env_config.json")
        return said

    @override
    def blame(self, values: Values) -> Iterator[Guess]:
        yield Guess(self.key)
