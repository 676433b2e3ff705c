"""What may differ from machine to machine, in words for a report."""

import ctypes
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from eyas import __version__
from eyas.core.machine import describe_machine
from eyas.lanes import thread_count

__all__ = ["machine_facts"]

_PACKAGES = ("numpy", "numba", "llvmlite", "shapely", "pillow", "pydantic", "gymnasium", "av")

_CHOICES = (
    "OPENBLAS_CORETYPE",
    "NPY_DISABLE_CPU_FEATURES",
    "NUMBA_CPU_NAME",
    "GLIBC_TUNABLES",
    "NUMBA_NUM_THREADS",
)
"""Variables by which a machine can be made to look like another."""


def machine_facts() -> dict[str, str]:
    """Return what a machine computes with, by names for people."""
    packages = [f"{name} {_version(name)}" for name in _PACKAGES]
    facts = {
        "machine": describe_machine(),
        "Eyas": f"{__version__}, {thread_count()} threads",
        "packages": ", ".join(packages),
        "libraries": f"{' '.join(platform.libc_ver())}, BLAS for {_blas_kernel()}",
    }
    chosen = [f"{name}={os.environ[name]}" for name in _CHOICES if name in os.environ]
    return facts | ({"set": ", ".join(chosen)} if chosen else {})


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "(unknown)"


def _blas_kernel() -> str:
    """Return the kind of processor whose functions OpenBLAS has chosen."""
    maps = Path("/proc/self/maps")
    lines = maps.read_text().splitlines() if maps.exists() else []
    for path in sorted({line.split()[-1] for line in lines if "openblas" in line}):
        library = ctypes.CDLL(path)
        for prefix, suffix in (("scipy_", "64_"), ("", "64_"), ("scipy_", ""), ("", "")):
            tell = getattr(library, f"{prefix}openblas_get_corename{suffix}", None)
            if tell is not None:
                tell.restype = ctypes.c_char_p
                return str(tell().decode())
    return "an unknown processor"
