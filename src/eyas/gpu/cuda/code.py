"""PTX of kernels: as it is kept in the folder of kernels, as it ships, or made.

The driver makes machine code of it for the card that there is, and keeps that in a cache of its
own.
"""

import lzma
import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from eyas.lanes.calls import CompiledCall
from eyas.lanes.container import packed, unpacked
from eyas.lanes.entry import LOCK, require_compiler
from eyas.lanes.folder import kernel_folder, refusal
from eyas.lanes.identity import code_name, digest, entry_of, language_hash
from eyas.lanes.interrupts import shielded
from eyas.lanes.shipped import wanted
from eyas.lanes.syntax import syntax_of
from eyas.lanes.trusted import read_trusted, touch, write_trusted

OLDEST = (8, 0)  # The least compute capability of cards that are served: that of the A100, of 2020

SUFFIX = ".eyp"  # End of the names of files of PTX

_MAKER = Path(__file__).parents[1] / "ptx.py"
"""The file that decides what kernels become, beside the language of kernels."""

ARCHIVE = _MAKER.parent / "shipped" / f"sm_{OLDEST[0]}{OLDEST[1]}{SUFFIX}"
"""PTX that comes with the package: one file serves all cards from the oldest on."""


class Ptx(NamedTuple):
    """PTX of a kernel."""

    entry: str  # Name of its entry
    text: bytes


def ptx_code(
    call: CompiledCall,  # The kernel
    types: tuple[Any, ...],  # Bundles of these kinds
    kinds: tuple[str, ...],  # The kinds, see `eyas.lanes.bundles.PackedBundle`
    threads: int,  # See `eyas.lanes.device.Device.launch`
) -> Ptx:
    """Return the PTX of a kernel for bundles of some kinds."""
    function = call.function
    name = code_name(function, (*kinds, str(threads)))
    keeps = function.__closure__ is None  # or what it depends on is not all in the name
    if keeps and name in _shipped():
        return _shipped()[name]
    require_compiler(name.partition("-")[0])
    path = kernel_folder() / f"{name}-{digest(_made_by())}{SUFFIX}"
    with LOCK, shielded():
        found = read_trusted(path) if keeps else None
        if found is not None:
            touch(path)
            return Ptx(found.header, bytes(found.pieces[0]))
        from eyas.gpu.ptx import ptx_of  # numba, half a second

        made = Ptx(entry_of(name), ptx_of(call, types, entry_of(name), threads=threads).encode())
        if keeps and not refusal():
            write_trusted(path, made.entry, [made.text])
    return made


@cache
def _made_of() -> str:
    """Return a digest of what turns kernels into PTX."""
    return digest((language_hash(), syntax_of(_MAKER)[""].digest))


def _made_by() -> tuple[str, ...]:
    versions = version("llvmlite"), version("numba"), platform.python_version()
    return (_made_of(), *versions)


def archive_of(
    # PTX by the names of the files in which it is kept, without the last part
    codes: Mapping[str, Ptx],
) -> bytes:
    """Return the content of an archive."""
    names = sorted(codes)
    header = [_made_of(), [(name, codes[name].entry) for name in names]]
    return lzma.compress(b"".join(packed(header, [codes[name].text for name in names])))


@cache
def _shipped() -> dict[str, Ptx]:
    """Return what ships; nothing if that was made by another version of the language."""
    if not wanted() or not ARCHIVE.exists():
        return {}
    (made_of, table), pieces = unpacked(lzma.decompress(ARCHIVE.read_bytes()))
    if made_of != _made_of():
        return {}
    return {
        name: Ptx(entry, bytes(piece)) for (name, entry), piece in zip(table, pieces, strict=True)
    }
