"""How kernels are compiled: one set of numba settings, cached on disk by a hash of the sources.

numba's own cache notices a change of the function's file, not of a function it calls in another
file. So the cache folder is named after a hash of every source file that holds kernels.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import platformdirs

__all__ = [
    "KERNEL_SETTINGS",
    "cache_folder",
    "inlined_kernel",
    "inner_kernel",
    "kernel",
    "nothing_compiled",
    "thread_count",
]

Function = TypeVar("Function", bound=Callable[..., Any])


def _source_hash() -> str:
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.parent.rglob("*.py")):
        text = path.read_bytes()
        if b"kernel" in text:
            digest.update(text)
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Return the folder where compiled kernels of exactly these sources are kept."""
    return Path(platformdirs.user_cache_dir("eyas")) / "kernels" / _source_hash()


def nothing_compiled() -> bool:
    """Return whether the next kernels will have to be compiled: this version's first start."""
    return not any(Path(os.environ["NUMBA_CACHE_DIR"]).rglob("*.nbc"))


os.environ.setdefault("NUMBA_CACHE_DIR", str(cache_folder()))

# numba reads the setting above when it is imported, and may have been before.
import numba  # noqa: E402

numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]


def thread_count() -> int:
    """Return how many threads draw: all cores, or what `NUMBA_NUM_THREADS` says."""
    return int(numba.config.NUMBA_NUM_THREADS)


# Kernels allocate nothing, so they need not count who uses an array. Numba would: two atomic
# operations for each array handed on, which threads that share the arrays pay for dearly
# (pictures took three times as long).
KERNEL_SETTINGS = {"cache": True, "error_model": "numpy", "fastmath": False, "_nrt": False}


def _compiled(function: Function, **settings: object) -> Function:
    """Return the function as numba will compile it, once for whole numbers of any kind.

    For calls `f(0)`, `f(1)` and `f(i)` in other kernels numba would compile `f` three times, and
    once more where `i` has 32 bits.
    """
    dispatcher = numba.njit(**KERNEL_SETTINGS, **settings)(function)
    template = dispatcher.get_call_template

    def template_for_any(args: tuple[object, ...], kws: dict[str, object]) -> object:
        return template(tuple(map(_widened, args)), {name: _widened(kws[name]) for name in kws})

    dispatcher.get_call_template = template_for_any
    return cast("Function", dispatcher)


def _widened(kind: object) -> object:
    kind = numba.types.unliteral(kind)
    signed = isinstance(kind, numba.types.Integer) and kind.signed
    return numba.types.int64 if signed else kind


def kernel(function: Function) -> Function:
    """Compile a scalar function without allocation, so that CUDA kernels can call it too."""
    return _compiled(function)


# What only kernels call needs no way in from Python; leaving it out saves a quarter of the time
# that compiling the renderer takes.
_INNER = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def inner_kernel(function: Function) -> Function:
    """Compile like `kernel`, for calls from other kernels only; Python cannot call it."""
    return _compiled(function, **_INNER)


def inlined_kernel(function: Function) -> Function:
    """Compile like `inner_kernel`, and have LLVM put it into its callers: for once a pixel."""
    return _compiled(function, **_INNER, forceinline=True)
