"""Machine code that comes with Eyas, so that the first start need not compile.

It is made for levels of x86-64 by `tools/ship_kernels.py`, and each kernel is found by what it
computes (`eyas.lanes.identity`): one that was changed is compiled, as all are on other processors.
Kernels call nothing of Python or numba, and no operation is fused or reordered, so the code serves
all versions of these, and computes the same bytes as code compiled for the very machine.
"""

import os
import platform
import sys
from functools import cache
from pathlib import Path

import llvmlite.binding as llvm

from eyas.lanes.identity import language_hash
from eyas.lanes.machine_code import SUFFIX, MachineCode, read_code

__all__ = ["LEVELS", "SHIPPED", "features", "is_shipped", "shipped_code"]

SHIPPED = Path(__file__).parent / "shipped"
"""Folder of shipped code: `<hash of the language of kernels>/<level>/<file>`."""

_V3 = frozenset(
    "cx16 sahf popcnt sse3 ssse3 sse4.1 sse4.2 avx avx2 bmi bmi2 f16c fma lzcnt movbe xsave".split()
)

LEVELS = {
    "x86-64-v4": _V3 | {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    "x86-64-v3": _V3,
}
"""Levels of the x86-64 ABI for which code may be shipped, the best first, with what each needs."""


@cache
def _folder() -> Path | None:
    """Return the folder of code for this machine and this language; None if there is none."""
    named = {"NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"} & os.environ.keys()
    if named or sys.platform != "linux" or platform.machine() != "x86_64":
        return None
    has = features()
    folders = (SHIPPED / language_hash() / name for name, needed in LEVELS.items() if needed <= has)
    return next((folder for folder in folders if folder.is_dir()), None)


def features() -> set[str]:
    """Return what this processor has, as LLVM names it."""
    return {name for name, present in llvm.get_host_cpu_features().items() if present}


def shipped_code(name: str) -> MachineCode | None:
    """Return the code of a kernel; None if none is shipped that computes this, for this machine.

    Args:
        name: Name of its file without the last part, see `code_file`.
    """
    folder = _folder()
    return None if folder is None else read_code(folder / f"{name}{SUFFIX}", shipped=True)


def is_shipped(name: str) -> bool:
    """Return whether a kernel, by its `code_name`, is shipped for this machine."""
    folder = _folder()
    return folder is not None and any(folder.glob(f"{name}-*{SUFFIX}"))
