"""Configuration: frozen pydantic models whose errors are one line with the path of the setting."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import NoneType, UnionType
from typing import Any, ClassVar, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, ErrorDetails, PydanticUndefined

from eyas.engine.core.allowed import describe, names_of
from eyas.engine.core.errors import ConfigError, UnknownNameError, nearest

Path = tuple[str, ...]


def _make_strict(schema: object) -> None:
    """Accept only numbers as numbers and only truth values as truth values, at any depth."""
    if isinstance(schema, dict):
        if schema.get("type") in ("int", "float", "bool"):
            schema["strict"] = True
        for part in schema.values():
            _make_strict(part)
    elif isinstance(schema, list | tuple):
        for part in schema:
            _make_strict(part)


class Config(BaseModel):
    """Base of all settings: frozen, unknown keys refused, no silent conversion of types.

    A whole number is accepted as a number, a list as a tuple, a name as an enum; `"1.5"`, `true`
    and `1.0` are not accepted as 1.5, 1 and 1. A check between fields raises
    `ValueError("<wrong field> <what it must be>")`.

    Raises:
        ConfigError: One line: key, value, allowed values.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
    named_by: ClassVar[str | None] = None
    """Field that a name in the place of the whole group stands for; None: no name may."""

    def __init__(self, **values: Any) -> None:  # noqa: ANN401  # as in pydantic
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise _problem(error, type(self), values).error() from None

    # Makes pydantic bypass this `__init__` for nested groups, so that the outermost settings raise
    # the error and can give the whole path.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    def kept(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values of fields that stay when some are changed; others get defaults.

        A value that no one has set is left out, so that `model_fields_set` stays right.
        """
        set_ = self.model_fields_set
        return {name: value for name, value in self if name in set_ or isinstance(value, Config)}

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type[BaseModel], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        schema = handler(source)
        _make_strict(schema)
        return schema


@dataclass(frozen=True, slots=True)
class Problem:
    """An error in a setting."""

    path: Path  # Keys that lead to the setting; empty if the settings as a whole are wrong
    value: object  # Value of the setting
    allowed: str  # Allowed values, in words
    names: tuple[str, ...] = ()
    """Allowed values of a choice of names; for an unknown key, the known keys."""
    unknown_key: bool = False  # Whether the key is wrong, not its value
    instead: str = ""  # Other allowed kinds of values, in words
    others: tuple["Problem", ...] = ()  # Further unknown keys

    def error(self) -> ConfigError:
        """Return the error to raise, one line."""
        path = ".".join(self.path) or "settings"
        if self.unknown_key:
            hint = nearest(self.path[-1], self.names)
            known = ", ".join(self.names)
            return ConfigError(f"{path}: unknown key{hint}; known: {known}{self._further()}")
        if self.value is PydanticUndefined:
            return ConfigError(f"{path}: missing, allowed: {self.allowed}")
        if self.names and isinstance(self.value, str):
            return UnknownNameError(path, self.value, self.names, others=self.instead)
        return ConfigError(f"{path}: {shown(self.value)} is not allowed: {self.allowed}")

    def below(self, root: str) -> "Problem":
        """Return the problem with a key before its path; an empty one changes nothing."""
        if not root:
            return self
        others = tuple(other.below(root) for other in self.others)
        return replace(self, path=(root, *self.path), others=others)

    def _further(self) -> str:
        """Return the words for further unknown keys."""
        keys = []
        for other in self.others[:_MOST_NAMED]:
            hint = nearest(other.path[-1], other.names).removeprefix("; ")
            keys.append(".".join(other.path) + (f" ({hint})" if hint else ""))
        if (left := len(self.others) - len(keys)) > 0:
            keys.append(f"{left} more")
        return f"; also unknown: {', '.join(keys)}" if keys else ""


_MOST_NAMED = 50
"""Number of further unknown keys in one message: as many as a file of an older version may have."""


def unknown_keys(problems: Sequence[Problem]) -> Problem | None:
    """Return one problem that names all unknown keys among some problems; None: there is none."""
    unknown = [problem for problem in problems if problem.unknown_key]
    return replace(unknown[0], others=tuple(unknown[1:])) if unknown else None


Model = TypeVar("Model", bound=Config)


def validated(
    model: type[Model],  # Class of the settings
    values: Mapping[str, Any],  # Nested dictionaries, as read from JSON
    root: str = "",  # Path to put before each key in messages
) -> Model:
    """Return the settings with the given values.

    Raises:
        ConfigError: One line: path, value, allowed values, the nearest known key.
    """
    values = {key: _spelt_out(model, key, value) for key, value in values.items()}
    try:
        return model.model_validate(values)
    except ValidationError as error:
        raise _problem(error, model, values).below(root).error() from None


def updated(
    config: Model, changes: Mapping[str, Any], retell: Callable[[Problem], Problem] | None = None
) -> Model:
    """Return the settings with some values changed.

    Args:
        config: The settings.
        changes: Nested dictionaries that hold only the changes.
        retell: Rewrites a problem in the names of another notation, for the user to read.

    Raises:
        ConfigError: One line, as from `validated`.
    """
    values = _merged(config, changes)
    try:
        return type(config).model_validate(values)
    except ValidationError as error:
        problem = _problem(error, type(config), values)
        raise (retell(problem) if retell else problem).error() from None


def shown(value: object) -> str:
    """Return a value as error messages show it: on one line, shortened to 80 characters."""
    text = repr(str(value)) if isinstance(value, str) else json.dumps(value, default=_plain)
    return text if len(text) <= 80 else f"{text[:76]} ..."


def _plain(value: object) -> object:
    return value.model_dump(mode="json") if isinstance(value, BaseModel) else str(value)


def group_of(field: FieldInfo | None) -> type[Config] | None:
    """Return the class of a field that holds a group of settings, or null; None for others."""
    kind = _besides_null(field)
    return kind if isinstance(kind, type) and issubclass(kind, Config) else None


def entries_of(field: FieldInfo | None) -> type[Config] | None:
    """Return the class of a field that holds a list of groups of settings, or null; None for
    others.
    """
    parts = get_args(_besides_null(field))
    kind = parts[0] if len(parts) == 2 and parts[1] is ... else None
    return kind if isinstance(kind, type) and issubclass(kind, Config) else None


def _besides_null(field: FieldInfo | None) -> object:
    """Return the type of a field's values other than null; None if there are several."""
    kind = field.annotation if field else None
    if not isinstance(kind, UnionType):
        return kind
    kinds = [part for part in get_args(kind) if part is not NoneType]
    return kinds[0] if len(kinds) == 1 else None


def _merged(config: Config, changes: Mapping[str, Any]) -> dict[str, Any]:
    fields = type(config).model_fields
    values = config.kept(changes)
    for name, change in changes.items():
        old, group = values.get(name), group_of(fields.get(name))
        change = _spelt_out(type(config), name, change)
        if group and isinstance(old, Config) and isinstance(change, Mapping):
            change = _merged(old, change)
        values[name] = change
    return values


def _spelt_out(model: type[Config], key: str, value: object) -> object:
    """Return the group that a name in its place stands for; other values as they are."""
    group = group_of(model.model_fields.get(key))
    named = group is not None and group.named_by is not None and isinstance(value, str)
    return {group.named_by: value} if group and named else value


def _problem(error: ValidationError, model: type[Config], values: Mapping[str, Any]) -> Problem:
    """Return the unknown keys, for they may cause the other problems, or else the first problem."""
    problems = [_one_problem(entry, model, values) for entry in error.errors(include_url=False)]
    return unknown_keys(problems) or problems[0]


def _one_problem(entry: ErrorDetails, model: type[Config], values: object) -> Problem:
    """Return one of pydantic's errors as a problem of the field or group that it concerns."""
    path: Path = ()
    field: FieldInfo | None = None
    group: type[Config] | None = model
    for part in entry["loc"]:
        if group is None and isinstance(part, int) and (group := entries_of(field)):
            path += (str(part),)
            values = values[part] if isinstance(values, list | tuple) else None
            continue
        if group is None:
            break  # inside one field: pydantic appends the variant of a union
        field = group.model_fields.get(str(part))
        path += (str(part),)
        if field is None:
            return Problem(path, entry["input"], "", tuple(group.model_fields), unknown_key=True)
        group, values = group_of(field), _value(values, str(part), field)
    message = entry["msg"].removeprefix("Value error, ") if entry["type"] == "value_error" else ""
    if group is not None:
        return _group_problem(path, group, values, message)
    assert field is not None
    allowed = message or describe(field.annotation, field.metadata)
    elsewhere = getattr(field.annotation, "elsewhere", None)  # of an enumeration, see `TargetName`
    instead = elsewhere(values) if elsewhere and isinstance(values, str) else ""
    return Problem(path, values, allowed, names_of(field.annotation), instead=instead)


def _group_problem(path: Path, group: type[Config], values: object, message: str) -> Problem:
    """Return the problem of a whole group: it is not a group, or its fields contradict."""
    name, _, must = message.partition(" ")
    there, value = path, values
    inner: type[Config] | None = group
    for part in name.split("."):
        field = None if inner is None else inner.model_fields.get(part)
        if field is None:
            break
        there, value, inner = (*there, part), _value(value, part, field), group_of(field)
    else:
        return Problem(there, value, must)
    return Problem(path, values, message or f"an object with {', '.join(group.model_fields)}")


def _value(values: object, key: str, field: FieldInfo) -> object:
    if isinstance(values, Mapping):
        return values.get(key, field.get_default())
    return getattr(values, key, None)
