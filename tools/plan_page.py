"""The page and the JSON schema of the plans of maps, made from the fields of their records."""

import ast
import inspect
import json
import textwrap
import types
from collections.abc import Iterator
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import Enum
from itertools import pairwise
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import annotated_types

from eyas.engine.state.mesh import Material
from eyas.engine.world.build.materials import FACADES, TEXTURES
from eyas.maps.build.values import MaterialRecord, Named, NumberRows, Shape
from eyas.maps.plan.file import TAGS, plain, schema
from eyas.maps.plan.plan import MapPlan
from eyas.maps.things.kinds import SOLIDS, THINGS

__all__ = ["page_of_records", "schema_text"]

_MANY = 12
"""Names of longer tables are not listed."""


def page_of_records() -> str:
    """Return a section with a table for each record, the whole plan first."""
    sections = [*map(_section, _records()), "## Names"]
    tables = {
        "Things": THINGS, "What of them is solid": SOLIDS, "Facades": FACADES, "Textures": TEXTURES,
    }  # fmt: skip
    for title, names in tables.items():
        sections.append(f"{title}: {', '.join(f'`{name}`' for name in names)}.")
    return "\n\n".join(sections)


def schema_text() -> str:
    """Return the JSON schema, with what the fields mean."""
    made = schema()
    _describe(made, MapPlan)
    for record in _records():
        if record.__name__ in made["$defs"]:
            _describe(made["$defs"][record.__name__], record)
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"


def _describe(made: dict[str, Any], record: type) -> None:
    made["description"] = _meaning(record)
    for name, meaning in _meanings(record).items():
        if meaning:
            made["properties"][name]["description"] = meaning


def _records() -> list[type]:
    """Return all records that a plan is made of, each after the first that holds it."""
    made: list[type] = []
    _collect(MapPlan, made)
    return made


def _collect(record: type, made: list[type]) -> None:
    if record in made:
        return
    made.append(record)
    for hint in get_type_hints(record, include_extras=True).values():
        for one in _inside(hint):
            _collect(one, made)


def _inside(kind: object) -> Iterator[type]:
    if _is_material(kind):
        yield MaterialRecord
    elif isinstance(kind, type) and is_dataclass(kind):
        yield kind
    else:
        for part in get_args(kind):
            yield from _inside(part)


def _is_material(kind: object) -> bool:
    return get_args(kind)[:1] == (Material,)


def _section(record: type) -> str:
    name = "material" if record is MaterialRecord else record.__name__
    hints, meanings = get_type_hints(record, include_extras=True), _meanings(record)
    rows = [
        f"| `{one.name}` | {_words(hints[one.name])} | {_usual(one)} | {meanings[one.name]} |"
        for one in fields(record)
    ]
    head = ["| field | value | if left out | |", "|---|---|---|---|"]
    return "\n".join([f"### {name}", "", _meaning(record), "", *head, *rows])


def _usual(one: "Field[Any]") -> str:
    if one.name in TAGS or (one.default is MISSING and one.default_factory is MISSING):
        return "*must be there*"
    value = one.default if one.default_factory is MISSING else one.default_factory()
    return f"`{json.dumps(plain(value))}`"


def _words(kind: object) -> str:
    """Return in words what values a field takes."""
    origin, parts = get_origin(kind), get_args(kind)
    if _is_material(kind):
        return "[material](#material)"
    if origin is Literal:
        return ", ".join(f"`{value}`" for value in parts)
    if origin in (Union, types.UnionType):
        return " or ".join(_words(part) for part in parts)
    if origin is tuple and parts[-1] is ...:
        return f"list of {_words(parts[0])}"
    if origin is tuple:
        return f"[{', '.join(_words(part) for part in parts)}]"
    if origin is list:
        return f"list of {_words(parts[0])}"
    if origin is dict:
        return f"object of {_words(parts[1])}"
    if hasattr(kind, "__metadata__"):
        return _annotated(parts[0], kind.__metadata__)
    if isinstance(kind, type) and is_dataclass(kind):
        return f"[{kind.__name__}](#{kind.__name__.lower()})"
    named: dict[object, str] = {
        float: "number",
        int: "whole number",
        str: "text",
        bool: "true or false",
    }
    return "null" if kind is type(None) else named[kind]


def _annotated(kind: object, metadata: tuple[Any, ...]) -> str:
    for one in metadata:
        if isinstance(one, NumberRows):
            number = "whole numbers" if one.whole else "numbers"
            count = f"{one.count} " if one.count else ""
            return f"{count}rows of {one.columns} {number}" if one.columns else f"{count}{number}"
        if isinstance(one, Shape):
            return "polygons" if one.several else "polygon"
        if isinstance(one, Named):
            names = list(one.names())
            return ", ".join(f"`{n}`" for n in names) if len(names) <= _MANY else "name"
    if getattr(kind, "__name__", "") == "LineString":
        return "rows of 2 numbers"
    if isinstance(kind, type) and issubclass(kind, Enum):
        return ", ".join(f"`{one.name.lower()}`" for one in kind)
    limits = [
        f"{sign} {getattr(one, name):g}"
        for one in metadata
        for kind_, name, sign in (
            (annotated_types.Ge, "ge", "from"), (annotated_types.Gt, "gt", "above"),
            (annotated_types.Le, "le", "to"),
        )
        if isinstance(one, kind_)
    ]  # fmt: skip
    return " ".join([_words(kind), *limits])


def _meaning(record: type) -> str:
    return " ".join((inspect.getdoc(record) or "").split("\n\n")[0].split())


def _meanings(record: type) -> dict[str, str]:
    """Return the text below each field of a record."""
    (tree,) = ast.parse(textwrap.dedent(inspect.getsource(record))).body
    assert isinstance(tree, ast.ClassDef)
    body = tree.body
    made = {one.name: "" for one in fields(record)}
    for field, text in pairwise(body):
        is_field = isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
        if is_field and isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant):
            meaning = " ".join(str(text.value.value).split())
            made[field.target.id] = meaning.replace("None:", "null:")
    return made
