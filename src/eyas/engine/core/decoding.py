"""Content that may come from anyone, decoded: within a budget of bytes, or refused in one line.

What a file says of its own size is checked before anything of that size is made, and what unpacks
stops at its budget, whatever the file says.
"""

import io
import json
import math
import re
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from gzip import GzipFile
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited

if TYPE_CHECKING:
    from PIL.Image import Image

_MOST_ARRAYS = 64  # Largest number of arrays in a `.npz`.
_LARGEST_NUMBER = 2.0**64
"""Largest size of a number in JSON: nothing that Eyas reads has a larger one."""

_LONG = re.compile(rb"\d{19}|[eE]\+?0*(?:1[89]|[2-9]\d|[1-9]\d\d)")  # A number that may be larger
_INVALID = re.compile(rb"NaN|Infinity|\\u[dD][89a-fA-F]")
"""Numbers that JSON does not have, and escapes of surrogates: a text with half of a pair cannot be
written in UTF-8."""

Pairs = Callable[[list[tuple[str, Any]]], dict[str, Any]]


def read_json(path: Path, largest: int, kind: str = "valid JSON") -> Any:  # noqa: ANN401  # JSON
    """Return what a file of JSON holds, see `decoded_json`.

    Args:
        path: The file.
        largest: Largest allowed size [bytes].
        kind: What it should be, for messages: `path: not <kind>: ...`.

    Raises:
        DataFileError: It cannot be read, is too large, or is no JSON.
    """
    try:
        return decoded_json(read_limited(path, largest))
    except ValueError as error:
        raise DataFileError(f"{path}: not {kind}: {error}") from None


def decoded_json(content: bytes, pairs: Pairs | None = None) -> Any:  # noqa: ANN401  # JSON
    """Return what a text of JSON holds: numbers are below 2^64, texts can be written as UTF-8.

    Args:
        content: UTF-8, perhaps with a byte order mark.
        pairs: Makes a dictionary of keys and values.

    Raises:
        ValueError: It is something else; `json.JSONDecodeError` with line and column where its
            syntax is wrong.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError("not a text in UTF-8") from None
    hooks: dict[str, Any] = {}
    if _LONG.search(content):
        hooks = {"parse_int": _whole, "parse_float": _number}
    try:
        value = json.loads(text, object_pairs_hook=pairs, parse_constant=_refused, **hooks)
        if _INVALID.search(content):
            json.dumps(value, ensure_ascii=False).encode()
    except RecursionError:
        raise ValueError("nested too deep") from None
    except UnicodeEncodeError as error:
        half = ascii(error.object[error.start])
        raise ValueError(f"{half} is half a character, which no text may hold") from None
    return value


def decoded_xml(content: bytes) -> ElementTree.Element:
    """Return the root of a text of XML that declares nothing of its own.

    Raises:
        ValueError: It is something else, or has a DOCTYPE or an ENTITY.
    """
    if re.search(rb"<!\s*(DOCTYPE|ENTITY)", content) or b"\0" in content:
        raise ValueError("it has a DOCTYPE, an ENTITY or a zero byte, which is not read")
    try:
        return ElementTree.fromstring(content.lstrip())  # the declaration is often below a line
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise ValueError(f"not XML: {error}") from None


def _whole(text: str) -> int:
    _number(text)
    return int(text)


def _number(text: str) -> float:
    number = float(text)
    if not abs(number) < _LARGEST_NUMBER:
        raise ValueError(f"the number {text[:30]} is not allowed: less than 2^64")
    return number


def _refused(text: str) -> float:
    raise ValueError(f"{text} is not allowed: finite numbers")


def gunzipped(content: bytes, largest: int) -> bytes:
    """Return the content of a gzip file.

    Raises:
        ValueError: It is damaged or cut off, or has more than `largest` bytes.
    """
    try:
        with GzipFile(fileobj=io.BytesIO(content)) as file:
            unpacked = file.read(largest + 1)
    except (OSError, EOFError, zlib.error, struct.error) as error:
        raise ValueError(str(error)) from None
    if len(unpacked) > largest:
        raise ValueError(f"larger than {largest >> 20} MiB when unpacked")
    return unpacked


def decoded_arrays(
    path: Path, largest: int, kind: str, expected: Mapping[str, tuple[str, int]]
) -> dict[str, NDArray[Any]]:
    """Return the arrays of a `.npz` file, of which kind and number of axes are known.

    Args:
        path: The file.
        largest: Largest size of the file, and of all its arrays [bytes].
        kind: What it should be, for messages.
        expected: By name the allowed kinds of elements, as in `numpy.dtype.kind`, and the number of
            axes.

    Raises:
        DataFileError: It cannot be read, is damaged or too large, lacks an array, or has one of
            another kind.
    """
    content = read_limited(path, largest)
    try:
        arrays = npz_arrays(content, largest)
    except Exception as error:  # damaged bytes raise many kinds in zipfile, zlib, numpy
        raise DataFileError(f"{path}: not {kind}: {error}") from None
    for name, (kinds, axes) in expected.items():
        if name not in arrays:
            raise DataFileError(f"{path}: not {kind}: it has no '{name}'")
        array = arrays[name]
        if array.dtype.kind not in kinds or array.ndim != axes:
            raise DataFileError(
                f"{path}: not {kind}: '{name}' is {array.dtype} with shape {array.shape}"
            )
    return {name: arrays[name] for name in expected}


def npz_arrays(
    data: bytes,  # Content of the file
    largest: int,  # Largest number of bytes of all arrays together
    names: Collection[str] | None = None,  # The arrays that are wanted; None: all
) -> dict[str, NDArray[Any]]:
    """Return the arrays of a `.npz` file, read-only.

    `numpy.load` makes arrays of the size that their headers claim before it reads them, and
    decompresses whatever there is. Here every size is known and checked first.

    Raises:
        ValueError: The file is damaged or too large, or has other content than arrays of numbers or
            text.
        Exception: Other kinds, which `zipfile` and `zlib` raise for damaged bytes.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
        size = sum(member.file_size for member in members)
        if len(members) > _MOST_ARRAYS or size > largest:
            raise ValueError(f"{len(members)} arrays of {size} bytes; allowed: {largest} bytes")
        return {
            member.filename.removesuffix(".npy"): _array_of(_content(archive, member))
            for member in members
            if names is None or member.filename.removesuffix(".npy") in names
        }


def _content(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    with archive.open(member) as file:
        content = file.read(member.file_size + 1)  # never more, whatever there is
    if len(content) != member.file_size:
        raise ValueError(f"{member.filename}: cut off")
    return content


def _array_of(content: bytes) -> NDArray[Any]:
    stream = io.BytesIO(content)
    version = np.lib.format.read_magic(stream)
    if version != (1, 0):
        raise ValueError(f"npy version {version}; allowed: 1.0")
    shape, by_columns, dtype = np.lib.format.read_array_header_1_0(stream)
    rest = memoryview(content)[stream.tell() :]
    if dtype.kind not in "biufU" or math.prod(shape) * dtype.itemsize != len(rest):
        raise ValueError(f"an array of {dtype}, shape {shape}, in {len(rest)} bytes")
    flat = np.frombuffer(rest, dtype)
    return flat.reshape(shape, order="F" if by_columns else "C")


def decoded_picture(path: Path, largest: int, size: tuple[int, int], bands: int) -> NDArray[Any]:
    """Return the pixels of a picture, shape (H, W), or (H, W, bands) if there are several.

    Args:
        path: A file of any format that Pillow reads.
        largest: Largest size of the file [bytes].
        size: Width and height that it must have, looked at before it is decoded [pixels].
        bands: Number of colours that it must have.

    Raises:
        DataFileError: It cannot be read or decoded, or has another size or number of colours.
    """
    with _opened(path, largest) as image:
        if image.size != size:
            sizes = ("x".join(map(str, each)) for each in (image.size, size))
            raise DataFileError(f"{path}: has {' pixels, not '.join(sizes)}")
        if len(image.getbands()) != bands:
            raise DataFileError(f"{path}: has {len(image.getbands())} colours, not {bands}")
        return np.asarray(image)


@contextmanager
def _opened(path: Path, largest: int) -> Iterator["Image"]:
    """Open a picture whose size is to be looked at before it is decoded."""
    import PIL.Image  # slow, and a start decodes none

    content = io.BytesIO(read_limited(path, largest))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow's of large pictures: sizes are checked
            image = PIL.Image.open(content)
        with image:
            yield image
    except PIL.UnidentifiedImageError:  # its own words tell an address in memory
        raise DataFileError(f"{path}: cannot read: not a picture") from None
    except DataFileError:
        raise
    except Exception as error:  # Pillow's readers raise whatever they stumble on
        raise DataFileError(f"{path}: cannot read: {error}") from error


def any_picture(path: Path, largest: int) -> NDArray[np.uint8]:
    """Return the pixels of a picture of any size to 100 megapixels, sRGB, shape (H, W, 3).

    Args:
        path: A file of any format that Pillow reads; what it says of turning is left aside.
        largest: Largest size of the file [bytes].

    Raises:
        DataFileError: It cannot be read or decoded, or is too large.
    """
    with _opened(path, largest) as image:
        if image.size[0] * image.size[1] > 100_000_000:
            raise DataFileError(f"{path}: has more than 100 million pixels")
        return np.array(image.convert("RGB"))
