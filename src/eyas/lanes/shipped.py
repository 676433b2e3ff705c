"""Machine code that comes with the package: neither numba nor LLVM is needed where it serves.

A shared library for each kind of machine, made by `tools/ship_kernels.py`; each kernel is found in
it by what it computes (`eyas.lanes.identity`): one that was changed is compiled, as all are on
other processors. Kernels call nothing outside, and no operation is fused or reordered, so the code
computes the same bytes as code compiled for the very machine. What draws ships for AVX-512, too: it
is faster there; nothing else is.
"""

import ctypes
import logging
import os
import platform
import re
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

from eyas.lanes.identity import entry_of, language_hash
from eyas.lanes.jit import VariableError
from eyas.lanes.trusted import OWNER

_LOG = logging.getLogger(OWNER)


class Level(NamedTuple):
    """Processors for which code ships."""

    name: str  # As LLVM names it
    needs: frozenset[str] = frozenset()  # What a processor must have, as Linux names it

    @property
    def library(self) -> Path:
        """The library of its kernels."""
        return FOLDER / f"{self.name}.so"


FOLDER = Path(__file__).parent / "shipped"

_V3 = "abm avx avx2 bmi1 bmi2 cx16 f16c fma lahf_lm movbe pni popcnt sse4_1 sse4_2 ssse3"

LEVELS = {"x86_64": Level("x86-64-v3", frozenset(_V3.split())), "aarch64": Level("armv8-a")}
"""The level of each machine."""

_V4 = "avx512f avx512bw avx512cd avx512dq avx512vl avx512_bf16"

WIDE = Level("x86-64-v4", frozenset(_V4.split()))
"""The level for which only what draws ships: masks and twice the registers of AVX-512. Where it was
measured it takes 8 to 11 % less time (Zen 4, Zen 5), but on a Cascade Lake, which bfloat16 tells
from these, no less."""

CONTENTS = f"{OWNER}_kernels"
"""Name of a text in a library that ends with a zero: in its first line the hash of the language of
kernels, in each other line the name of a kernel, by `eyas.lanes.identity.code_name`."""

VARIABLE = f"{OWNER.upper()}_SHIPPED_CODE"
"""Environment variable: 0 has everything compiled on this machine."""


class KernelLibrary(NamedTuple):
    """A shared library of kernels.

    Raises:
        OSError: It cannot be opened.
        ValueError: It is no library of kernels.
    """

    library: ctypes.CDLL
    language: str  # The hash of the language of its kernels
    names: frozenset[str]

    @staticmethod
    def opened(path: Path) -> "KernelLibrary":
        """Open a library."""
        library = ctypes.CDLL(str(path))
        text = ctypes.string_at(ctypes.addressof(ctypes.c_char.in_dll(library, CONTENTS)))
        language, *names = text.decode().splitlines()
        return KernelLibrary(library, language, frozenset(names))

    def address(self, name: str) -> int:
        """Return the address of a kernel's entry."""
        entry = ctypes.cast(self.library[entry_of(name)], ctypes.c_void_p)
        assert entry.value is not None, name
        return entry.value


def wanted() -> bool:
    """Return whether code that comes with the package may be used."""
    return os.environ.get(VARIABLE) != "0"


@cache
def _shipped() -> dict[str, KernelLibrary]:
    """Return the libraries of kernels for this machine and this language, by the kernels' names.

    Raises:
        VariableError: Features are named of which LLVM would end the process.
    """
    chosen = os.environ.get("NUMBA_CPU_FEATURES", "")
    if not re.fullmatch(r"([+-][\w.-]+(,[+-][\w.-]+)*)?", chosen):
        raise VariableError(
            f"NUMBA_CPU_FEATURES: {chosen!r} is not allowed; allowed: such as +avx2,-avx512f"
        )
    if misfit():
        return {}
    kernels = _kernels(LEVELS[platform.machine()].library)
    return kernels | _kernels(WIDE.library) if draws_wide() else kernels


def _kernels(path: Path) -> dict[str, KernelLibrary]:
    """Return the kernels of a library; none if it is missing, of another version of the language,
    or damaged, which is reported.
    """
    try:
        library = KernelLibrary.opened(path)
    except (OSError, ValueError) as error:
        if path.exists():
            _LOG.warning("%s: damaged or unreadable, so kernels are compiled: %s", path, error)
        return {}
    ours = library.language == language_hash()
    return dict.fromkeys(library.names, library) if ours else {}


def misfit() -> str:
    """Return why what ships does not serve this machine; nothing if it does."""
    named = {"NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"} & os.environ.keys()
    if named or not wanted():
        variable = min(named, default=VARIABLE)
        return f"not used, by {variable}={os.environ[variable]}"
    if sys.platform != "linux" or platform.machine() not in LEVELS:
        return f"for Linux on {' and '.join(LEVELS)} only"
    level = LEVELS[platform.machine()]
    lacking = sorted(level.needs - features())
    return f"for {level.name}; this processor lacks {', '.join(lacking)}" if lacking else ""


def draws_wide() -> bool:
    """Return whether this processor draws with code of its own, where what ships serves it."""
    return platform.machine() == "x86_64" and WIDE.needs <= features()


@cache
def features() -> frozenset[str]:
    """Return what this processor has, as Linux names it; nothing if that cannot be read."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except (OSError, ValueError):
        return frozenset()
    found = re.search(r"^flags\s*:(.*)$", text, re.MULTILINE)
    return frozenset(found[1].split()) if found else frozenset()


def shipped_address(
    name: str,  # From `eyas.lanes.identity.code_name`
) -> int | None:
    """Return the address of a kernel; None if none ships that computes this, for this machine."""
    library = _shipped().get(name)
    return None if library is None else library.address(name)


def is_shipped(name: str) -> bool:
    """Return whether a kernel, by its `code_name` without kinds, is shipped for this machine."""
    return any(known.startswith(f"{name}-") for known in _shipped())
