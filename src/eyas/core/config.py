"""Configuration: frozen pydantic models whose errors are one line with the path."""

from collections.abc import Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from eyas.core.errors import ConfigError, nearest

__all__ = ["Config", "validated"]

Model = TypeVar("Model", bound="Config")


class Config(BaseModel):
    """Base of all settings: frozen, unknown keys refused, no silent conversion of types."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True
    )


def validated(model: type[Model], values: dict[str, Any], root: str = "") -> Model:
    """Return the settings that `values` give.

    Args:
        model: The settings' class.
        values: Nested dictionaries, as read from JSON.
        root: Path to put before each key in messages.

    Raises:
        ConfigError: One line: path, value, what is allowed, the nearest known key.
    """
    try:
        return model.model_validate(values)
    except ValidationError as error:
        raise ConfigError(_one_line(error, model, root)) from None


def _one_line(error: ValidationError, model: type[BaseModel], root: str) -> str:
    first = max(error.errors(), key=lambda entry: len(entry["loc"]) if entry["type"] != "missing" else 0)
    if first["type"] != "extra_forbidden" and (extra := _first_of(error, "extra_forbidden")):
        first = extra
    path = ".".join([root] * bool(root) + [str(part) for part in first["loc"]])
    if first["type"] == "extra_forbidden":
        key = str(first["loc"][-1])
        known = _keys_at(model, first["loc"][:-1])
        return f"{path}: unknown key{nearest(key, known)}; known: {', '.join(known)}"
    if first["type"] == "missing":
        return f"{path}: missing"
    message = first["msg"].removeprefix("Value error, ")
    return f"{path}: {first['input']!r} is not allowed: {message[0].lower()}{message[1:]}"


def _first_of(error: ValidationError, kind: str) -> Any:  # noqa: ANN401  # pydantic's own record
    return next((entry for entry in error.errors() if entry["type"] == kind), None)


def _keys_at(model: type[BaseModel], loc: Sequence[int | str]) -> list[str]:
    """Return the known keys of the model that `loc` leads to."""
    for part in loc:
        field = model.model_fields.get(str(part))
        inner = field.annotation if field else None
        if isinstance(inner, type) and issubclass(inner, BaseModel):
            model = inner
    return sorted(model.model_fields)
