"""JSON Schema of the settings, for editors: names, types, ranges, defaults and what each is for."""

import ast
import inspect
import textwrap
from collections.abc import Iterator
from typing import Any, get_args

from eyas.engine.core.config import Config
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import SCHEMA_KEY

Schema = dict[str, Any]


def config_schema() -> Schema:
    """Return the JSON Schema (draft 2020-12) of native settings.

    It accepts what `eyas.engine.settings.file.load_settings` accepts, and more: checks between
    settings, and of names of maps, weathers and code, are made by Eyas alone.
    """
    schema = EyasConfig.model_json_schema()
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    schema["title"] = "Settings of Eyas"
    schema["properties"][SCHEMA_KEY] = {"type": "string"}
    definitions = schema["$defs"]
    for group in _groups(EyasConfig, set()):
        there = schema if group is EyasConfig else definitions[group.__name__]
        for name, text in field_texts(group).items():
            if name in there["properties"]:
                there["properties"][name]["description"] = text
        if group.named_by is not None:
            definitions[group.__name__] = {"anyOf": [{"type": "string"}, there]}
    return schema


def _groups(group: type[Config], known: set[type[Config]]) -> Iterator[type[Config]]:
    """Yield a group of settings, and those in it."""
    if group in known:
        return
    known.add(group)
    yield group
    for field in group.model_fields.values():
        for part in _parts(field.annotation):
            if isinstance(part, type) and issubclass(part, Config):
                yield from _groups(part, known)


def _parts(annotation: Any) -> Iterator[Any]:  # noqa: ANN401  # a type
    """Yield a type, and those of which it is made."""
    yield annotation
    for part in get_args(annotation):
        yield from _parts(part)


def field_texts(group: type[Config]) -> dict[str, str]:
    """Return the docstring of each field, on one line."""
    described = {
        name: field.description for name, field in group.model_fields.items() if field.description
    }
    for base in reversed(group.__mro__):
        if issubclass(base, Config) and base not in (Config, EyasConfig):
            described |= _own(base)
    return described


def _own(group: type[Config]) -> dict[str, str]:
    """Return the docstrings of the fields that a class adds: Python itself keeps none."""
    (body,) = ast.parse(textwrap.dedent(inspect.getsource(group))).body
    assert isinstance(body, ast.ClassDef)
    described = {}
    for field, text in zip(body.body, body.body[1:], strict=False):
        if (
            isinstance(field, ast.AnnAssign)
            and isinstance(field.target, ast.Name)
            and isinstance(text, ast.Expr)
            and isinstance(text.value, ast.Constant)
        ):
            described[field.target.id] = " ".join(str(text.value.value).split())
    return described
