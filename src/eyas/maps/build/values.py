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

from eyas.engine.core.errors import nearest
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import FACADES, TEXTURES

LARGEST_NUMBER = 1e6  # Largest number of a plan: lengths are metres, and no map has 100 km

Positive = Annotated[float, Gt(0.0)]  # A number above 0
Natural = Annotated[int, Ge(0)]  # A whole number from 0
Share = Annotated[float, Ge(0.0), Le(1.0)]  # A number from 0 to 1
Colour = tuple[Share, Share, Share]  # sRGB, or a factor on such a colour

_NUMBER = {"type": "number"}


class _Read:
    """How values of a type are read from JSON."""

    def _read(self, value: object) -> object:
        """Return the value that JSON stands for; a `ValueError` says what is allowed."""
        raise NotImplementedError

    def _schema(self) -> dict[str, Any]:
        """Return the JSON schema."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(
        self, source: type, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return self._schema()


@dataclass(frozen=True)
class Named(_Read):
    """A text that must be one of some names."""

    names: Callable[[], Collection[str]]

    def _read(self, value: object) -> str:
        names = self.names()
        if not isinstance(value, str) or value not in names:
            hint = nearest(value, names) if isinstance(value, str) else ""
            raise ValueError(f"one of {', '.join(names)}{hint}")
        return value

    def _schema(self) -> dict[str, Any]:
        return {"type": "string", "enum": list(self.names())}


@dataclass(frozen=True)
class _Member(_Read):
    """A member of an enum, by its name in small letters."""

    kind: type[IntEnum]

    def _read(self, value: object) -> IntEnum:
        names = {one.name.lower(): one for one in self.kind}
        return self.kind[Named(lambda: names)._read(value).upper()]

    def _schema(self) -> dict[str, Any]:
        return {"type": "string", "enum": [one.name.lower() for one in self.kind]}


@dataclass(frozen=True)
class NumberRows(_Read):
    """An array of numbers that a file holds as a list, or a list of lists."""

    columns: int | None  # Numbers in each row; None: one number a row
    count: int | None = None  # Number of rows; None: any
    whole: bool = False

    def _read(self, value: object) -> NDArray[Any]:
        told = f"{self.count or 'any number of'} {'whole ' * self.whole}numbers"
        if self.columns is not None:
            told = told.replace("numbers", f"rows of {self.columns} numbers")
        array = _numbers(value, told)
        if not array.size and self.columns is not None:
            array = array.reshape(-1, self.columns)
        fits = array.shape[1:] == (() if self.columns is None else (self.columns,))
        if not fits or self.count not in (None, len(array)):
            raise ValueError(told)
        if not self.whole:
            return array
        if (array != np.rint(array)).any():
            raise ValueError(told)
        return array.astype(np.int64)

    def _schema(self) -> dict[str, Any]:
        number = {"type": "integer"} if self.whole else _NUMBER
        row = number if self.columns is None else _list_of(number, self.columns)
        return _list_of(row, self.count)


@dataclass(frozen=True)
class Shape(_Read):
    """A polygon: its outline, or a list of its outline and its holes; or a list of polygons."""

    several: bool

    def _read(self, value: object) -> shapely.Geometry:
        depth, first = 0, value
        while isinstance(first, list | tuple):
            depth, first = depth + 1, first[0] if first else None
        if depth == 2:
            return _polygon([value])
        if depth == 3 or (depth == 1 and not self.several):
            return _polygon(value)
        if self.several and isinstance(value, list | tuple):
            return shapely.MultiPolygon([_polygon(one) for one in value])
        raise ValueError(_RINGS)

    def _schema(self) -> dict[str, Any]:
        ring = {**_list_of(_list_of(_NUMBER, 2)), "minItems": 3}
        forms = [ring, _list_of(ring)]
        return {"anyOf": [*forms, _list_of(_list_of(ring))] if self.several else forms}


_RINGS = "a ring of at least 3 points [x, y], or a list of rings: an outline and its holes"


@dataclass(frozen=True)
class _Line(_Read):
    """A line of at least two points."""

    def _read(self, value: object) -> shapely.LineString:
        points = _numbers(value, "at least 2 points [x, y]")
        if points.shape[1:] != (2,) or len(points) < 2:
            raise ValueError("at least 2 points [x, y]")
        return shapely.LineString(points)

    def _schema(self) -> dict[str, Any]:
        return {**_list_of(_list_of(_NUMBER, 2)), "minItems": 2}


def _list_of(schema: dict[str, Any], count: int | None = None) -> dict[str, Any]:
    made = {"type": "array", "items": schema}
    return made if count is None else {**made, "minItems": count, "maxItems": count}


def _numbers(value: object, told: str) -> NDArray[np.float64]:
    try:
        array = np.asarray(value)
        plain = array.ndim > 0 and (array.dtype.kind in "iuf" or not array.size)
        array = array.astype(np.float64)
    except (ValueError, TypeError, OverflowError):
        plain, array = False, np.zeros(0)
    if not plain or not np.isfinite(array).all():
        raise ValueError(told)
    if array.size and np.abs(array).max() > LARGEST_NUMBER:
        raise ValueError(f"{told}, none of them beyond {LARGEST_NUMBER:g}")
    return array


def _polygon(value: object) -> shapely.Polygon:
    if not isinstance(value, list | tuple):
        raise ValueError(_RINGS)
    rings = [_numbers(ring, _RINGS) for ring in value]
    if any(ring.shape[1:] != (2,) or len(ring) < 3 for ring in rings):
        raise ValueError(_RINGS)
    made = shapely.Polygon(rings[0] if rings else None, rings[1:])
    if not made.is_valid:
        raise ValueError(f"{_RINGS}, none of which cross ({shapely.is_valid_reason(made)})")
    return made


@dataclass(frozen=True, slots=True)
class MaterialRecord:
    """A material: what a surface looks like."""

    texture: Annotated[str, Named(lambda: TEXTURES)] = "plain"
    """Name of its texture; `plain` is white."""
    tint: Colour = (1.0, 1.0, 1.0)  # Factor on the texture, sRGB
    surface: Annotated[Surface, _Member(Surface)] = Surface.MATT  # How it reflects or emits light
    emission: Annotated[float, Ge(0.0)] = 0.0  # Emitted light, as a factor on the colour


class _MaterialType:
    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        def made(told: MaterialRecord) -> Material:
            return Material(told.texture, told.tint, told.surface, told.emission)

        return core_schema.no_info_after_validator_function(made, handler(MaterialRecord))


Cover = Annotated[Material, _MaterialType]  # A material, whose texture must exist
Facade = Annotated[str, Named(lambda: FACADES)]
"""Walls with windows: one of `eyas.engine.world.build.materials.FACADES`."""
ClassName = Annotated[ObjectClass, _Member(ObjectClass)]  # Class of objects
Area = Annotated[shapely.Geometry, Shape(several=True)]  # Any number of polygons, with holes [m]
Outline = Annotated[shapely.Polygon, Shape(several=False)]  # One polygon, with holes [m]
Curve = Annotated[shapely.LineString, _Line()]  # A line [m]
Place = Annotated[NDArray[np.float64], NumberRows(None, 2)]  # East and north [m], shape (2,)
Unit = Annotated[NDArray[np.float64], NumberRows(None, 2)]  # A unit vector, shape (2,)
Line = Annotated[
    NDArray[np.float64], NumberRows(2)
]  # Points of a line, east and north [m], shape (K, 2)
Path = Annotated[NDArray[np.float64], NumberRows(3)]  # Points of a line in space [m], shape (K, 3)
Heights = Annotated[NDArray[np.float64], NumberRows(None)]  # Numbers, shape (K,)
Numbers = Annotated[NDArray[np.int64], NumberRows(None, whole=True)]  # Whole numbers, shape (K,)
