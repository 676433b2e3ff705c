"""The relations between keys of the original's `env_config.json` and our settings."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum

from typing_extensions import override

from eyas.engine.core.config import Config, Problem, shown
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.variation import Mirrored, Uniform
from eyas.engine.world.config import world_of

Values = Mapping[str, object]  # Values by dotted path: by the original's keys, or by ours


@dataclass(frozen=True, slots=True)
class Guess:
    """A key that may have caused the refusal of a field of ours."""

    key: str
    trial: object = None
    """A value of our field that is refused if this key is the cause; None: the key is the cause."""
    allowed: str | None = None  # Allowed values of the key; None: those of our field


class OriginalEntry(ABC):
    """Keys of the original, and our fields with the same meaning."""

    __slots__ = ()

    @property
    @abstractmethod
    def keys(self) -> tuple[str, ...]:
        """The original's keys."""

    @property
    @abstractmethod
    def paths(self) -> tuple[str, ...]:
        """Our fields."""

    @abstractmethod
    def read(self, values: Values) -> Values:
        """Return our fields from the original's keys, as JSON values."""

    @abstractmethod
    def write(self, fields: Values) -> Values:
        """Return the original's keys from our fields, without keys that then have no effect.

        Raises:
            ConfigError: The original's keys cannot express a value.
        """

    @abstractmethod
    def blame(self, values: Values) -> Iterator[Guess]:
        """Yield the keys that may have caused the refusal of a field; if no other did, the last."""

    def remarks(self, values: Values) -> Iterator[str]:
        """Yield a line for each value that is not used as it stands."""
        yield from ()


class _OneField(OriginalEntry):
    """Keys that mean one field."""

    __slots__ = ()
    path: str

    @property
    @override
    def paths(self) -> tuple[str, ...]:
        return (self.path,)


class _OneKey(_OneField):
    """A key that means one field."""

    __slots__ = ()
    key: str

    @property
    @override
    def keys(self) -> tuple[str, ...]:
        return (self.key,)

    @override
    def blame(self, values: Values) -> Iterator[Guess]:
        yield Guess(self.key)


@dataclass(frozen=True, slots=True)
class Same(_OneKey):
    """A key that means what a field means."""

    key: str
    path: str
    upper_case: bool = False  # Whether the original has our names in upper case

    @override
    def read(self, values: Values) -> Values:
        value = values[self.key]
        # `swapcase`, so that a name in lower case is refused, as by the original.
        swapped = self.upper_case and isinstance(value, str)
        return {self.path: str(value).swapcase() if swapped else value}

    @override
    def write(self, fields: Values) -> Values:
        value = fields[self.path]
        if self.upper_case and ":" in str(value):  # a class of the user's
            raise ConfigError(f"{self.path}: {shown(value)} cannot be expressed in env_config.json")
        value = value.value if isinstance(value, Enum) else value
        if isinstance(value, Config):
            raise ConfigError(f"{self.path}: {shown(value)} cannot be expressed in env_config.json")
        return {self.key: str(value).upper() if self.upper_case else value}


@dataclass(frozen=True, slots=True)
class Optional(_OneKey):
    """A key that applies if a switch is true; otherwise our field is None."""

    switch: str
    key: str
    path: str

    @property
    @override
    def keys(self) -> tuple[str, ...]:
        return self.switch, self.key

    @override
    def read(self, values: Values) -> Values:
        return {self.path: values[self.key] if values[self.switch] else None}

    @override
    def write(self, fields: Values) -> Values:
        value = fields[self.path]
        if value is None:
            return {self.switch: False}
        return {self.switch: True, self.key: list(value) if isinstance(value, tuple) else value}


@dataclass(frozen=True, slots=True)
class Span(_OneField):
    """Two keys that are the limits of one field."""

    least: str
    most: str
    path: str

    @property
    @override
    def keys(self) -> tuple[str, ...]:
        return self.least, self.most

    @override
    def read(self, values: Values) -> Values:
        return {self.path: [values[self.least], values[self.most]]}

    @override
    def write(self, fields: Values) -> Values:
        ends = fields[self.path]
        assert isinstance(ends, tuple)
        return {self.least: ends[0], self.most: ends[1]}

    @override
    def blame(self, values: Values) -> Iterator[Guess]:
        most = values[self.most]
        yield Guess(self.most, [0.0, most], "a number above 0 and up to 1e9")
        yield Guess(
            self.least, None, f"a number from 0 to below {self.most}, which is {shown(most)}"
        )


@dataclass(frozen=True, slots=True)
class Varied(OriginalEntry):
    """The four to six keys that define whether and how one value is sampled."""

    random: str  # Switch: sampled between `least` and `most`; else it is `fixed`
    fixed: str
    least: str
    most: str
    path: str
    sides: str | None = None  # Switch: a magnitude is sampled, with a random sign
    default: str | None = None  # Switch: the other keys have no effect, and our field is None
    replaces: str | None = None
    """A second field of ours: true if sampled: sampled values replace, fixed ones are added."""

    @property
    @override
    def keys(self) -> tuple[str, ...]:
        every = (self.default, self.random, self.sides, self.fixed, self.most, self.least)
        return tuple(key for key in every if key)

    @property
    @override
    def paths(self) -> tuple[str, ...]:
        return tuple(path for path in (self.path, self.replaces) if path)

    @override
    def read(self, values: Values) -> Values:
        random = values[self.random]
        also = {self.replaces: random} if self.replaces else {}
        if self.default and values[self.default]:
            return {self.path: None, **also}
        if not random:
            return {self.path: values[self.fixed], **also}
        kind = "mirrored" if self.sides and values[self.sides] else "uniform"
        return {self.path: {kind: [values[self.least], values[self.most]]}, **also}

    @override
    def remarks(self, values: Values) -> Iterator[str]:
        if not values[self.random] or (self.default and values[self.default]):
            return
        least, most = values[self.least], values[self.most]
        assert isinstance(least, int | float), "the adapter has checked the types"
        assert isinstance(most, int | float)
        if least > most:
            yield (
                f"{self.least}: {shown(least)} is above {self.most}, which is {shown(most)}; "
                "values between the two are drawn"
            )

    @override
    def write(self, fields: Values) -> Values:
        value = fields[self.path]
        if self.default and value is None:
            return {self.default: True}
        said: dict[str, object] = {self.default: False} if self.default else {}
        match value:
            case int() | float():
                said |= {self.random: False, self.fixed: value}
            case Uniform(uniform=(least, most)):
                said |= {self.random: True, self.least: least, self.most: most}
                said |= {self.sides: False} if self.sides else {}
            case Mirrored(mirrored=(least, most)) if self.sides:
                said |= {self.random: True, self.least: least, self.most: most, self.sides: True}
            case _:
                raise ConfigError(
                    f"{self.path}: {shown(value)} cannot be expressed in env_config.json"
                )
        if self.replaces and said[self.random] != fields[self.replaces]:
            raise ConfigError(
                f"{self.replaces}: {shown(fields[self.replaces])} with {self.path} "
                f"{shown(value)} cannot be expressed in env_config.json"
            )
        return said

    @override
    def blame(self, values: Values) -> Iterator[Guess]:
        active = (self.most, self.least) if values[self.random] else (self.fixed,)
        for key in active:
            yield Guess(key, values[key])


_LEAST, _MOST = 0.5, 1.5  # The pitches that the gimbal reaches [rad]

_FLATTEST, _STEEPEST = 0.1, 3.0
"""The pitches for which there is a start position [rad]; see `StartConfig.pitch`."""


@dataclass(frozen=True, slots=True)
class Pitch(Varied):
    """A pitch; one that looks at or above the horizon, or far behind, is limited.

    Others keep their value, because the start position is computed from it.
    """

    @override
    def read(self, values: Values) -> Values:
        # Not `super()`, which a dataclass with slots breaks.
        return Varied.read(self, {**values, **self._limited(values)})

    @override
    def remarks(self, values: Values) -> Iterator[str]:
        yield from Varied.remarks(self, values)
        for key, used in self._limited(values).items():
            yield (
                f"{key}: {shown(values[key])} is out of the gimbal's range of {_LEAST} to {_MOST};"
                f" {used} is used"
            )

    def _limited(self, values: Values) -> dict[str, float]:
        """Return the keys in use whose values are limited."""
        keys = (self.least, self.most) if values[self.random] else (self.fixed,)
        limited = {}
        for key in keys:
            value = values[key]
            assert isinstance(value, int | float), "the adapter has checked the types"
            if not _FLATTEST <= value <= _STEEPEST:
                limited[key] = _LEAST if value < _FLATTEST else _MOST
        return limited


@dataclass(frozen=True, slots=True)
class Switch(_OneKey):
    """A key that is true for one value of a field and false for the other."""

    key: str
    path: str
    on: str  # Value of the field if the key is true
    off: str  # Value of the field if the key is false

    @override
    def read(self, values: Values) -> Values:
        value = values[self.key]
        if not isinstance(value, bool):
            raise Problem((self.key,), value, "true or false").error()
        return {self.path: self.on if value else self.off}

    @override
    def write(self, fields: Values) -> Values:
        return {self.key: fields[self.path] == self.on}


_SIMPLE = "simpleway"  # First part of the names of the simple maps


@dataclass(frozen=True, slots=True)
class WorldPath(OriginalEntry):
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
