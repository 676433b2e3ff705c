"""Machine code that comes with the package, so that the first start need not compile.

An archive for a level of x86-64, made by `tools/ship_kernels.py`; each kernel is found in it by
what it computes (`eyas.lanes.identity`): one that was changed is compiled, as all are on other
processors. Kernels call nothing of Python or numba, and no operation is fused or reordered, so the
code serves all versions of these, and computes the same bytes as code compiled for the very
machine. What draws ships for AVX-512, too: it is faster there; nothing else is.
"""

import logging
import os
import platform
import re
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import llvmlite.binding as llvm

from eyas.lanes.container import packed, unpacked
from eyas.lanes.identity import language_hash
from eyas.lanes.jit import VariableError
from eyas.lanes.machine_code import MachineCode
from eyas.lanes.trusted import OWNER

_LOG = logging.getLogger(OWNER)

LEVEL = "x86-64-v3"  # The level of the x86-64 ABI for which code is shipped, as LLVM names it

needed = frozenset(
    "cx16 sahf popcnt sse3 ssse3 sse4.1 sse4.2 avx avx2 bmi bmi2 f16c fma lzcnt movbe xsave".split()
)
"""What a processor needs for it."""

ARCHIVE = Path(__file__).parent / "shipped" / f"{LEVEL}.eyk"

WIDE_LEVEL = "x86-64-v4"
"""The level for which only what draws is shipped: masks and twice the registers of AVX-512."""

wide_needed = needed | {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}
"""What a processor needs for it."""

WIDE_ARCHIVE = ARCHIVE.with_name(f"{WIDE_LEVEL}.eyk")

VARIABLE = f"{OWNER.upper()}_SHIPPED_CODE"
"""Environment variable: 0 has everything compiled on this machine."""


def archive_of(
    codes: Mapping[str, MachineCode],  # Machine code by name, see `shipped_code`
) -> bytes:
    """Return the content of an archive of this version of the language of kernels."""
    names = sorted(codes)
    header = [language_hash(), [(name, codes[name].entry, codes[name].needs) for name in names]]
    return b"".join(packed(header, [codes[name].code for name in names]))


def read_archive(path: Path) -> dict[str, MachineCode]:
    """Return what is in an archive, by name; nothing if it is of another version of the language.

    Raises:
        OSError: It cannot be read.
        ValueError: It is damaged.
    """
    (language, table), pieces = unpacked(path.read_bytes())
    if language != language_hash():
        return {}
    return {
        name: MachineCode(entry, tuple(needs), piece)
        for (name, entry, needs), piece in zip(table, pieces, strict=True)
    }


def wanted() -> bool:
    """Return whether code that comes with the package may be used."""
    return os.environ.get(VARIABLE) != "0"


@cache
def _shipped() -> dict[str, MachineCode]:
    """Return the code for this machine and this language.

    Raises:
        VariableError: Features are named of which LLVM would end the process.
    """
    chosen = os.environ.get("NUMBA_CPU_FEATURES", "")
    if not re.fullmatch(r"([+-][\w.-]+(,[+-][\w.-]+)*)?", chosen):
        raise VariableError(
            f"NUMBA_CPU_FEATURES: {chosen!r} is not allowed; allowed: such as +avx2,-avx512f"
        )
    named = {"NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"} & os.environ.keys()
    other = sys.platform != "linux" or platform.machine() != "x86_64"
    if named or other or not wanted() or not needed <= features():
        return {}
    codes = _read(ARCHIVE)
    return codes | _read(WIDE_ARCHIVE) if wide_needed <= features() else codes


def _read(path: Path) -> dict[str, MachineCode]:
    """Return what is in an archive; nothing if it is not there, or damaged, which is told."""
    try:
        return read_archive(path)
    except FileNotFoundError:
        return {}
    except (OSError, TypeError, ValueError) as error:
        _LOG.warning("%s: damaged or unreadable, so kernels are compiled: %s", path, error)
        return {}


def features() -> set[str]:
    """Return what this processor has, as LLVM names it."""
    return {name for name, present in llvm.get_host_cpu_features().items() if present}


def shipped_code(
    name: str,  # Name of its file without the last part, see `code_file`
) -> MachineCode | None:
    """Return the code of a kernel; None if none is shipped that computes this, for this machine."""
    return _shipped().get(name)


def is_shipped(name: str) -> bool:
    """Return whether a kernel, by its `code_name`, is shipped for this machine."""
    return any(known.startswith(f"{name}-") for known in _shipped())
