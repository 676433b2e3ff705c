"""Configuration: frozen pydantic models whose errors are one line with the path."""

import json
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from eyas.core.allowed import describe
from eyas.core.errors import ConfigError, nearest

__all__ = ["Config", "validated"]

Model = TypeVar("Model", bound="Config")


class Config(BaseModel):
    """Base of all settings: frozen, unknown keys refused."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True
    )


def validated(model: type[Model], values: Mapping[str, Any]) -> Model:
    """Return the settings that `values` give; types are not converted, but for int to float.

    Args:
        model: The settings' class.
        values: Nested dictionaries, as read from JSON.

    Raises:
        ConfigError: One line: path, value, what is allowed, the nearest known key.
    """
    try:
        # JSON mode is strict about types, and still takes lists for tuples and words for enums.
        return model.model_validate_json(json.dumps(values), strict=True)
    except ValidationError as error:
        raise ConfigError(_one_line(error, model)) from None
    except TypeError as error:
        raise ConfigError(f"settings: {error}") from None


def _one_line(error: ValidationError, model: type[BaseModel]) -> str:
    """Return the message of the first error, unknown keys before all others."""
    entries = sorted(error.errors(), key=lambda entry: entry["type"] != "extra_forbidden")
    lines = [_message(entry, model) for entry in entries]
    return lines[0]


def _message(entry: ErrorDetails, model: type[BaseModel]) -> str:
    owner, field, path = _find(entry["loc"], model)
    if field is None and entry["type"] == "extra_forbidden":
        known = sorted(owner.model_fields)
        return f"{path}: unknown key{nearest(path.rpartition('.')[2], known)}; known: {', '.join(known)}"
    if entry["type"] == "missing":
        return f"{path}: missing"
    said = entry["msg"].removeprefix("Value error, ")
    if entry["type"] == "model_type":
        return f"{path}: {json.dumps(entry['input'])} is not allowed; allowed: an object in braces"
    if field is None:  # a check of a whole group; its message begins with the key
        return f"{path}.{said}" if path else said
    value = json.dumps(entry["input"], default=str)
    return f"{path}: {value} is not allowed; allowed: {_allowed(field, entry, said)}"


def _find(
    loc: tuple[int | str, ...], model: type[BaseModel]
) -> tuple[type[BaseModel], FieldInfo | None, str]:
    """Return the group, the field and the dotted path that an error's place leads to."""
    path: list[str] = []
    for part in loc:
        field = model.model_fields.get(str(part))
        path.append(str(part))
        if field is None:
            break
        inner = field.annotation
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return model, field, ".".join(path)
        model = inner
    else:
        return model, None, ".".join(path)
    return model, None, ".".join(path)


def _allowed(field: FieldInfo, entry: ErrorDetails, said: str) -> str:
    """Return what a field takes, in words, or what its own check says."""
    return said if entry["type"] == "value_error" else describe(field.annotation, field.metadata)
