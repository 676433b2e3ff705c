"""Labels that may come from anyone, read: their JSON schema decides what is one."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic_core import CoreSchema, SchemaValidator, ValidationError, core_schema

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited

_LARGEST = 1 << 30
"""Largest file of labels of an episode [bytes]: a hundred thousand frames with many others."""


def labels_in(path: Path, reader: SchemaValidator) -> list[dict[str, Any]]:
    """Return the labels of an episode.

    Raises:
        DataFileError: The file is missing, cut off, or does not hold labels; the line and the
            field are told.
    """
    labels = []
    for number, line in enumerate(read_limited(path, _LARGEST).splitlines()):
        try:
            label: dict[str, Any] = reader.validate_json(line)
        except ValidationError as error:
            first = error.errors(include_url=False, include_context=False, include_input=False)[0]
            if first["type"] == "json_invalid":
                problem = "is cut off or not JSON"
            else:
                field = ".".join(map(str, first["loc"])) or "label"
                problem = f"is not the label of a frame: {field:.100}: {first['msg']}"
            raise DataFileError(f"{path}: line {number + 1} {problem}") from None
        if label["frame"] != number:
            raise DataFileError(f"{path}: line {number + 1} is of frame {label['frame']}")
        labels.append(label)
    return labels


def reader_of(schema: Mapping[str, Any]) -> SchemaValidator:
    """Return what reads JSON by a schema, of those words that the labels' schema has."""
    return SchemaValidator(_core(schema))


def _core(schema: Mapping[str, Any]) -> CoreSchema:
    kind = schema["type"]
    if isinstance(kind, list):  # or null
        (kind,) = set(kind) - {"null"}
        return core_schema.nullable_schema(_core({**schema, "type": kind}))
    low, high = schema.get("minimum"), schema.get("maximum")
    match kind:
        case "integer" if "enum" in schema:
            return core_schema.literal_schema(schema["enum"])
        case "integer":
            return core_schema.int_schema(ge=low, le=high, strict=True)
        case "number":
            return core_schema.float_schema(ge=low, le=high, allow_inf_nan=False, strict=True)
        case "boolean":
            return core_schema.bool_schema(strict=True)
        case "string":
            return core_schema.str_schema(pattern=schema["pattern"], strict=True)
        case "array":
            return core_schema.list_schema(
                _core(schema["items"]),
                min_length=schema.get("minItems"),
                max_length=schema.get("maxItems"),
            )
    if "properties" not in schema:
        return core_schema.dict_schema(
            core_schema.str_schema(strict=True), _core(schema["additionalProperties"])
        )
    fields = {
        key: core_schema.typed_dict_field(_core(of), required=key in schema["required"])
        for key, of in schema["properties"].items()
    }
    return core_schema.typed_dict_schema(fields, extra_behavior="forbid")
