"""Plans as files: JSON whose keys are the fields of the records, read with their types."""

import gzip
import json
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence, Sized
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import Any, cast, get_args, get_type_hints

import numpy as np
import shapely
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails, SchemaValidator

from eyas.engine.core.config import shown
from eyas.engine.core.decoding import decoded_json, gunzipped
from eyas.engine.core.errors import DataFileError, nearest
from eyas.engine.core.files import read_limited, write_atomic
from eyas.maps.build.values import LARGEST_NUMBER
from eyas.maps.plan.plan import Backdrop, Far, GroundCover, Hills, MapPlan, Things
from eyas.maps.things.kinds import THINGS

FORMAT = "eyas-plan-1"  # Value of `format` in the files of this version

_LARGEST = 256 << 20  # Largest file that is read, unpacked [bytes]
TAGS = ("layer", "form")  # Fields that tell which record it is
_MOST = 20  # Number of errors that are told of a file


def text_of(plan: MapPlan) -> str:
    """Return a plan as JSON; what is as usual is left out, and equal plans give equal texts."""
    return json.dumps({"format": FORMAT, **plain(plan)}, separators=(",", ":"), ensure_ascii=False)


def plan_of(text: bytes) -> MapPlan:
    """Return the plan that `text_of` has told."""
    content = json.loads(text)
    del content["format"]
    return cast("MapPlan", _validator().validate_python(content))


def write_plan(path: Path, plan: MapPlan) -> None:
    """Write a plan to a file, compressed if its name ends in `.gz`.

    Raises:
        OutputError: The file cannot be written.
    """
    data = (text_of(plan) + "\n").encode()
    write_atomic(path, gzip.compress(data, mtime=0) if path.name.endswith(".gz") else data)


def read_plan(path: Path) -> MapPlan:
    """Return the plan in a file.

    Raises:
        DataFileError: It does not hold a plan: one line with the place of the first error, its
            value, and what is allowed.
    """
    plan = _read(path)
    if isinstance(plan, MapPlan):
        return plan
    raise DataFileError(plan[0])


def problems(
    path: Path, opened: Callable[[MapPlan, Path], Iterable[str]] = lambda plan, folder: ()
) -> list[str]:
    """Return what is wrong with a plan in a file, a line each; none if it is a plan.

    Args:
        opened: Yields what is wrong with the files that a plan names, which lie in a folder.

    Raises:
        DataFileError: It cannot be read.
    """
    plan = _read(path)
    if isinstance(plan, MapPlan):
        wrong = list(road_faults(plan, path.parent)) or opened(plan, path.parent)
        return [f"{path}: {line}" for line in wrong]
    return plan


def content_of(path: Path) -> dict[str, Any]:
    """Return the JSON of a file, not checked yet.

    Raises:
        DataFileError: It cannot be read, is no JSON, or none of a plan of this version.
    """
    data = read_limited(path, _LARGEST)
    try:
        if data[:2] == b"\x1f\x8b":
            data = gunzipped(data, _LARGEST)
        content = decoded_json(data)
    except ValueError as error:
        raise DataFileError(f"{path}: cannot read: {error}") from error
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        found = content.get("format") if isinstance(content, dict) else None
        raise DataFileError(f"{path}: format: {shown(found)} is not allowed: a plan has {FORMAT!r}")
    del content["format"]
    return content


def _read(path: Path) -> MapPlan | list[str]:
    """Return the plan in a file, or what is wrong with it."""
    content = content_of(path)
    try:
        plan = cast("MapPlan", _validator().validate_python(content))
        return [f"{path}: {line}" for line in _faults(plan)] or plan
    except ValidationError as error:
        found = error.errors(include_url=False)
        # A field of several types has an error for each; the first says what is allowed.
        entries = list({_place_of(entry["loc"])[0]: entry for entry in reversed(found)}.values())
        entries.reverse()
        told = [f"{path}: {_told(entry)}" for entry in entries[:_MOST]]
        more = len(entries) - _MOST
        return told + [f"{path}: and {more} more"] * (more > 0)


def _faults(plan: MapPlan) -> Iterator[str]:
    """Yield what in a plan does not fit together, a line each."""
    for index, kind in enumerate(plan.library):
        if not kind.make:
            yield from _one_of(f"library[{index}].name", kind.name, THINGS)
        if kind.chance:
            yield from _one_of(f"library[{index}].chance", kind.chance, plan.chances)
    for index, layer in enumerate(plan.layers):
        if type(layer) in _CHECKS:
            yield from _CHECKS[type(layer)](f"layers[{index}]", layer, plan)
    if plan.walkways is not None and plan.walkways.lights:
        lights, lines = plan.walkways.lights, plan.walkways.lines
        yield from _as_many("walkways.lights", lights, len(lines), "lines")


def _things(where: str, layer: Things, plan: MapPlan) -> Iterator[str]:
    names = [kind.name for kind in plan.library]
    for number, name in enumerate(layer.kinds):
        yield from _one_of(f"{where}.kinds[{number}]", name, names)
    yield from _as_many(f"{where}.kind", layer.kind, len(layer.pose), "poses")
    yield from _below(f"{where}.kind", layer.kind, len(layer.kinds), "kinds")


def _relief(where: str, layer: Hills, plan: MapPlan) -> Iterator[str]:
    yield from _below(f"{where}.white", layer.white, len(layer.mounds), "mounds")


def _backdrop(where: str, layer: Backdrop, plan: MapPlan) -> Iterator[str]:
    for part in ("tops", "walls", "roofs", "bays"):
        yield from _as_many(
            f"{where}.{part}", getattr(layer, part), len(layer.outlines), "outlines"
        )


def _ground(where: str, layer: GroundCover, plan: MapPlan) -> Iterator[str]:
    for number, piece in enumerate(layer.pieces):
        if isinstance(piece, Far):
            yield from _far(f"{where}.pieces[{number}]", piece)


_CHECKS: dict[type, Callable[[str, Any, MapPlan], Iterator[str]]] = {
    Things: _things, Hills: _relief, Backdrop: _backdrop, GroundCover: _ground,
}  # fmt: skip


def _far(where: str, piece: Far) -> Iterator[str]:
    count = len(piece.covers)
    if piece.winter:
        yield from _as_many(f"{where}.winter", piece.winter, count, "covers")
    if piece.chance is not None:
        yield from _as_many(f"{where}.shares", piece.shares, count, "covers")
        if abs(sum(piece.shares) - 1.0) > 1e-6:
            yield f"{where}.shares: {sum(piece.shares):g} together is not allowed: 1 together"


def road_faults(plan: MapPlan, folder: Path) -> Iterator[str]:
    """Yield what is wrong with the roads of a plan whose file is in a folder, a line each."""
    roads = plan.roads
    if roads.file:
        if not (folder / roads.file).is_file():
            yield f"roads.file: {roads.file!r} is not allowed: a file in {folder}"
        return
    if not roads.edges:
        yield "roads.edges: [] is not allowed: at least one edge, or a file"
    nodes = [node.name for node in roads.nodes]
    yield from _each_once("roads.nodes", nodes)
    yield from _each_once("roads.edges", [edge.name for edge in roads.edges])
    for index, edge in enumerate(roads.edges):
        where = f"roads.edges[{index}]"
        for end in ("start", "end"):
            yield from _one_of(f"{where}.{end}", getattr(edge, end), nodes)
        if edge.start == edge.end:
            yield f"{where}.end: {edge.end!r} is not allowed: another node than its start"
        for key in ("lanes", "lane_width", "speed"):
            if getattr(edge, key) <= 0:
                yield f"{where}.{key}: {getattr(edge, key)} is not allowed: above 0"


def _each_once(where: str, names: Sequence[str]) -> Iterator[str]:
    known: dict[str, int] = {}
    for index, name in enumerate(names):
        first = known.setdefault(name, index)
        if first != index:
            yield f"{where}[{index}].name: {name!r} is not allowed: {where}[{first}] has that name"


def _one_of(where: str, name: str, names: Collection[str]) -> Iterator[str]:
    if name not in names:
        known = f"{', '.join(names):.1000}"
        yield f"{where}: {shown(name)} is not allowed: one of {known}{nearest(name, names)}"


def _as_many(where: str, rows: Sized, count: int, what: str) -> Iterator[str]:
    if len(rows) != count:
        yield f"{where}: {len(rows)} rows are not allowed: as many as {what}, {count}"


def _below(
    where: str, values: Sequence[int] | NDArray[np.int64], count: int, what: str
) -> Iterator[str]:
    wrong = [value for value in values if not 0 <= value < count]
    if wrong:
        yield f"{where}: {wrong[0]} is not allowed: an index of {what}, 0 to {count - 1}"


@cache
def schema() -> dict[str, Any]:
    """Return the JSON schema of the files."""
    made = _adapter().json_schema()
    kept = {"format": {"const": FORMAT}, **made.pop("properties")}
    required = ["format", *made.pop("required")]
    named = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": named, **made, "properties": kept, "required": required}


@cache
def _adapter() -> TypeAdapter[MapPlan]:
    return TypeAdapter(MapPlan)


@cache
def _validator() -> SchemaValidator:
    """Return what reads a plan: it converts no types, and knows no keys but the fields."""
    strict = _made_strict(_adapter().core_schema)
    return SchemaValidator(strict)


def _made_strict(schema: Any) -> Any:  # noqa: ANN401  # a schema, or any part of one
    if isinstance(schema, list | tuple):
        return type(schema)(_made_strict(part) for part in schema)
    if not isinstance(schema, dict):
        return schema
    made = {key: part if key == "metadata" else _made_strict(part) for key, part in schema.items()}
    if made.get("type") in ("int", "float", "bool"):
        made["strict"] = True
    if made.get("type") == "float":
        made["allow_inf_nan"] = False
        made.setdefault("le", LARGEST_NUMBER)
        made.setdefault("ge", -LARGEST_NUMBER)
    if made.get("type") == "dataclass-args":
        made["extra_behavior"] = "forbid"
    return made


def _told(entry: ErrorDetails) -> str:
    """Return one of pydantic's errors in the words of other messages: place, value, allowed."""
    where, record = _place_of(entry["loc"])
    kind, value, context = entry["type"], shown(entry["input"]), entry.get("ctx", {})
    if kind == "missing":
        return f"{where}: is missing"
    if kind == "unexpected_keyword_argument":
        names = [one.name for one in fields(record)]
        key = str(entry["loc"][-1])
        return f"{where}: unknown key{nearest(key, names)}; known: {', '.join(names)}"
    if kind.startswith("union_tag"):
        where = f"{where}.{context['discriminator'].strip(chr(39))}"
        if kind == "union_tag_not_found":
            return f"{where}: is missing"
        tag, known = context["tag"], context["expected_tags"].replace("'", "")
        hint = nearest(tag, known.split(", "))
        return f"{where}: {tag!r} is not allowed: one of {known}{hint}"
    if kind == "string_pattern_mismatch" and where == "name":
        return f"{where}: {value} is not allowed: words joined by hyphens"
    allowed = entry["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    if kind == "literal_error":
        allowed += nearest(str(entry["input"]), re.findall(r"'([^']+)'", context["expected"]))
    return f"{where}: {value} is not allowed: {allowed}"


def _place_of(loc: tuple[int | str, ...]) -> tuple[str, type]:
    """Return the path of a field, and the innermost record around it."""
    path = ""
    record: type = MapPlan
    known: list[type] = [MapPlan]
    for index, part in enumerate(loc):
        if isinstance(part, int):
            path += f"[{part}]"
            continue
        if part.startswith("literal["):  # one of the types that the field may have
            continue
        tagged = [one for one in known if _tag_of(one) == part]
        if tagged and index and isinstance(loc[index - 1], int):
            known = tagged
            continue
        path += f".{part}" if path else part
        record = next((one for one in known if part in _hints(one)), known[0] if known else record)
        known = list(_records_in(_hints(record).get(part)))
    return path or "the file", record


def _tag_of(record: type) -> object:
    return next((one.default for one in fields(record) if one.name in TAGS), None)


def _hints(record: type) -> dict[str, Any]:
    return get_type_hints(record, include_extras=True)


def _records_in(kind: object) -> Iterator[type]:
    """Yield the records that a type is made of."""
    if isinstance(kind, type) and is_dataclass(kind):
        yield kind
    for part in get_args(kind):
        yield from _records_in(part)


def plain(value: Any) -> Any:  # noqa: ANN401  # any part of a plan
    """Return a part of a plan as JSON."""
    if is_dataclass(value):
        kept = ((one, getattr(value, one.name)) for one in fields(value))
        return {one.name: plain(part) for one, part in kept if not _is_usual(one, part)}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, shapely.Geometry):
        return _coordinates(value)
    if isinstance(value, IntEnum):
        return value.name.lower()
    if isinstance(value, Mapping):
        return {key: plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return value


def _is_usual(one: Field[Any], value: object) -> bool:
    """Return whether a field has its default, and so can be left out."""
    if one.name in TAGS or isinstance(value, np.ndarray):
        return False
    usual = one.default if one.default_factory is MISSING else one.default_factory()
    return bool(value == usual)


def _coordinates(shape: shapely.Geometry) -> list[Any]:
    """Return the points of a line, the rings of a polygon, or the polygons of any shape."""
    if isinstance(shape, shapely.LineString):
        return list(shapely.get_coordinates(shape).tolist())
    if isinstance(shape, shapely.Polygon):
        rings = () if shape.is_empty else (shape.exterior, *shape.interiors)
        return [shapely.get_coordinates(ring)[:-1].tolist() for ring in rings]
    parts = shapely.get_parts(shape)
    return [_coordinates(part) for part in parts if isinstance(part, shapely.Polygon)]
