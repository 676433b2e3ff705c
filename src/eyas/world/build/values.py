"""Types of the fields of a plan, with the checks that reading a file makes."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, Any

import numpy as np
import shapely
from annotated_types import Ge, Gt, Le
from numpy.typing import NDArray
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from eyas.core.errors import nearest
from eyas.state.mesh import Material, Surface
from eyas.state.scene import ObjectClass
from eyas.world.build.materials import FACADES, TEXTURES

__all__ = [
    "Area",
    "ClassName",
    "Colour",
    "Cover",
    "Curve",
    "Facade",
    "Heights",
    "Line",
    "MaterialRecord",
    "Named",
    "Natural",
    "Numbers",
    "Outline",
    "Path",
    "Place",
    "Positive",
    "Rows",
    "Shape",
    "Share",
    "Unit",
]

Positive = Annotated[float, Gt(0.0)]
"""A number above 0."""
Natural = Annotated[int, Ge(0)]
"""A whole number from 0."""
Share = Annotated[float, Ge(0.0), Le(1.0)]
"""A number from 0 to 1."""
Colour = tuple[Share, Share, Share]
"""sRGB, or a factor on such a colour."""


@dataclass(frozen=True)
class Named:
    """A text that must be one of some names."""

    names: Callable[[], Collection[str]]

    def __get_pydantic_core_schema__(
        self, source: type, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"type": "string", "enum": list(self.names())}

    def _checked(self, name: str) -> str:
        names = self.names()
        if name not in names:
            raise ValueError(f"one of {', '.join(names)}{nearest(name, names)}")
        return name


@dataclass(frozen=True)
class Rows:
    """An array of numbers that a file holds as a list, or a list of lists."""

    columns: int | None
    """Numbers in each row; None: one number a row."""
    count: int | None = None
    """Number of rows; None: any."""
    whole: bool = False

    def __get_pydantic_core_schema__(
        self, source: type, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        number: dict[str, Any] = {"type": "integer" if self.whole else "number"}
        if self.columns is not None:
            number = _list_of(number, self.columns)
        return _list_of(number, self.count)

    def _read(self, value: object) -> NDArray[Any]:
        kind = "whole numbers" if self.whole else "numbers"
        shape = f"{self.count or 'any number of'} rows of {self.columns}"
        if self.columns is None:
            shape = f"{self.count or 'any number of'}"
        told = f"{shape} {kind}"
        array = _numbers(value, told)
        if self.whole and (array != np.rint(array)).any():
            raise ValueError(told)
        if not array.size and self.columns is not None:
            array = array.reshape(-1, self.columns)
        wanted = 1 if self.columns is None else 2
        fits = array.ndim == wanted and (self.columns is None or array.shape[1] == self.columns)
        if not fits or self.count not in (None, len(array)):
            raise ValueError(told)
        return array.astype(np.int64) if self.whole else array


def _list_of(schema: dict[str, Any], count: int | None) -> dict[str, Any]:
    made = {"type": "array", "items": schema}
    return made if count is None else {**made, "minItems": count, "maxItems": count}


def _numbers(value: object, told: str) -> NDArray[np.float64]:
    try:
        array = np.asarray(value)
        plain = array.dtype.kind in "iuf" or not array.size
        array = array.astype(np.float64)
    except (ValueError, TypeError, OverflowError):
        plain, array = False, np.zeros(0)
    if not plain or not np.isfinite(array).all():
        raise ValueError(told)
    return array


@dataclass(frozen=True)
class Shape:
    """A polygon: its outline, or a list of its outline and its holes; or a list of polygons."""

    several: bool

    def __get_pydantic_core_schema__(
        self, source: type, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        ring = {**_list_of(_list_of({"type": "number"}, 2), None), "minItems": 3}
        forms = [ring, _list_of(ring, None)]
        if self.several:
            forms.append(_list_of(_list_of(ring, None), None))
        return {"anyOf": forms}

    def _read(self, value: object) -> shapely.Geometry:
        if isinstance(value, shapely.Geometry):
            return value
        depth = _depth(value)
        if depth == 2:
            return _polygon([value])
        if depth == 3 or (depth == 1 and not self.several):
            return _polygon(value)
        if self.several and isinstance(value, list | tuple):
            return shapely.MultiPolygon([_polygon(one) for one in value])
        raise ValueError(_RINGS)


_RINGS = "a ring of at least 3 points [x, y], or a list of rings: an outline and its holes"


def _depth(value: object) -> int:
    """Return how many lists are in each other at the beginning of a value."""
    depth = 0
    while isinstance(value, list | tuple):
        depth, value = depth + 1, value[0] if value else None
    return depth


def _polygon(value: object) -> shapely.Polygon:
    if not isinstance(value, list | tuple):
        raise ValueError(_RINGS)
    rings = [_numbers(ring, _RINGS) for ring in value]
    if any(ring.ndim != 2 or ring.shape[1] != 2 or len(ring) < 3 for ring in rings):
        raise ValueError(_RINGS)
    made = shapely.Polygon(rings[0] if rings else None, rings[1:])
    if not made.is_valid:
        raise ValueError(f"{_RINGS}, none of which cross ({shapely.is_valid_reason(made)})")
    return made


class _Curve:
    """A line."""

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(cls.read)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**_list_of(_list_of({"type": "number"}, 2), None), "minItems": 2}

    @classmethod
    def read(cls, value: object) -> shapely.LineString:
        if isinstance(value, shapely.LineString):
            return value
        points = _numbers(value, "at least 2 points [x, y]")
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
            raise ValueError("at least 2 points [x, y]")
        return shapely.LineString(points)


class _EnumName:
    """A member of an enum, by its name in small letters."""

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type[IntEnum], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        def read(value: object) -> IntEnum:
            if isinstance(value, source):
                return value
            names = {one.name.lower(): one for one in source}
            if not isinstance(value, str) or value not in names:
                raise ValueError(f"one of {', '.join(names)}")
            return names[value]

        return core_schema.no_info_plain_validator_function(
            read, metadata={"names": [one.name.lower() for one in source]}
        )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"type": "string", "enum": schema.get("metadata", {})["names"]}


class _MaterialType:
    """A material, whose texture must exist."""

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_after_validator_function(_material, handler(MaterialRecord))


@dataclass(frozen=True, slots=True)
class MaterialRecord:
    """A material: what a surface looks like."""

    texture: Annotated[str, Named(lambda: TEXTURES)] = "plain"
    """Name of its texture; `plain` is white."""
    tint: Colour = (1.0, 1.0, 1.0)
    """Factor on the texture, sRGB."""
    surface: Annotated[Surface, _EnumName] = Surface.MATT
    """How it reflects or emits light."""
    emission: Annotated[float, Ge(0.0)] = 0.0
    """Emitted light, as a factor on the colour."""


def _material(look: "MaterialRecord | Material") -> Material:
    return Material(look.texture, look.tint, look.surface, look.emission)


Cover = Annotated[Material, _MaterialType]
"""A material."""
Facade = Annotated[str, Named(lambda: FACADES)]
"""Walls with windows: one of `eyas.world.build.materials.FACADES`."""
ClassName = Annotated[ObjectClass, _EnumName]
"""Class of objects."""
Area = Annotated[shapely.Geometry, Shape(several=True)]
"""Any number of polygons, with holes [m]."""
Outline = Annotated[shapely.Polygon, Shape(several=False)]
"""One polygon, with holes [m]."""
Place = Annotated[NDArray[np.float64], Rows(None, 2)]
"""East and north [m], shape (2,)."""
Unit = Annotated[NDArray[np.float64], Rows(None, 2)]
"""A unit vector, shape (2,)."""
Line = Annotated[NDArray[np.float64], Rows(2)]
"""Points of a line, east and north [m], shape (K, 2)."""
Path = Annotated[NDArray[np.float64], Rows(3)]
"""Points of a line in space [m], shape (K, 3)."""
Heights = Annotated[NDArray[np.float64], Rows(None)]
"""Numbers, shape (K,)."""
Numbers = Annotated[NDArray[np.int64], Rows(None, whole=True)]
"""Whole numbers, shape (K,)."""
Curve = Annotated[shapely.LineString, _Curve]
"""A line [m]."""
