"""Compilation of kernels: one set of numba settings, cached on disk by a hash of the sources.

numba's own cache notices a change in a function's file, but not in the files of the functions it
calls. So the folder of kernels is named after a hash of every source file that holds kernels.
"""

import hashlib
import inspect
import os
import types
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar, cast

from eyas.core.cache.folder import Kind, cache_folder, touch

__all__ = [
    "KERNEL_SETTINGS",
    "inlined_kernel",
    "inner_kernel",
    "kernel",
    "kernel_folder",
    "may_be_kept",
    "nothing_compiled",
    "specialised",
    "step_kernel",
    "thread_count",
]

Function = TypeVar("Function", bound=Callable[..., Any])


def _source_hash() -> str:
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.parent.rglob("*.py")):
        text = path.read_bytes()
        if b"kernel" in text or b"numba" in text:
            digest.update(text)
    return digest.hexdigest()[:16]


def kernel_folder() -> Path:
    """Return the folder of the kernels compiled from exactly these sources."""
    return cache_folder() / Kind.KERNELS / _source_hash()


def _can_be_written(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


def nothing_compiled() -> bool:
    """Return whether no kernel is cached yet, as at the first start of a version."""
    return not any(Path(os.environ["NUMBA_CACHE_DIR"]).rglob("*.nbc"))


os.environ.setdefault("NUMBA_CACHE_DIR", str(kernel_folder()))
touch(Path(os.environ["NUMBA_CACHE_DIR"]))

# numba reads the variable above when it is imported, and may have been imported before.
import numba  # noqa: E402

numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]


def thread_count() -> int:
    """Return the number of threads that draw: all cores, or `NUMBA_NUM_THREADS`."""
    return int(numba.config.NUMBA_NUM_THREADS)


# Kernels allocate nothing, so they need no reference counting of arrays (`_nrt`). It costs two
# atomic operations for each array passed on, which is slow when threads share the arrays: pictures
# took three times as long.
#
# If the folder cannot be written to, nothing is cached: numba would otherwise keep kernels beside
# their sources, and use outdated ones after a change in the functions they call.
KERNEL_SETTINGS = {
    "cache": _can_be_written(Path(os.environ["NUMBA_CACHE_DIR"])),
    "error_model": "numpy",
    "fastmath": False,
    "_nrt": False,
}


def _compiled(function: Function, **settings: object) -> Function:
    """Return the function for numba to compile, once for all types of signed whole numbers.

    For the calls `f(0)`, `f(1)` and `f(i)` in other kernels numba would compile `f` three times,
    and once more if `i` has 32 bits.
    """
    dispatcher = numba.njit(**KERNEL_SETTINGS, **settings)(function)
    template = dispatcher.get_call_template

    def template_for_any(args: tuple[object, ...], kws: dict[str, object]) -> object:
        return template(tuple(map(_widened, args)), {name: _widened(kws[name]) for name in kws})

    dispatcher.get_call_template = template_for_any
    cache = dispatcher._cache
    save = cache.save_overload

    def save_for_all(kinds: tuple[object, ...], compiled: object) -> None:
        if may_be_kept(function, kinds):
            save(kinds, compiled)

    cache.save_overload = save_for_all
    return cast("Function", dispatcher)


def may_be_kept(function: Callable[..., Any], kinds: Iterable[object]) -> bool:
    """Return whether a function compiled for these argument types may be kept on disk.

    numba lists the argument types of all compiled versions of a function in one file. A program
    that lacks the class of one of them, such as the memory of a user-defined tracker, could not
    read that file.
    """
    own = not function.__module__.startswith("eyas.") or hasattr(function, "specialised")
    return own or all(map(_known_to_all, kinds))


def _known_to_all(kind: object) -> bool:
    """Return whether every program that runs Eyas has the classes in the type."""
    if isinstance(kind, numba.types.CPointer):
        return _known_to_all(kind.dtype)
    if isinstance(kind, numba.types.BaseNamedTuple):
        if not kind.instance_class.__module__.startswith("eyas."):
            return False
    return not isinstance(kind, numba.types.BaseTuple) or all(map(_known_to_all, kind.types))


def _widened(kind: object) -> object:
    kind = numba.types.unliteral(kind)
    signed = isinstance(kind, numba.types.Integer) and kind.signed
    return numba.types.int64 if signed else kind


def kernel(function: Function) -> Function:
    """Compile a scalar function that allocates nothing, so that CUDA kernels can call it too."""
    return _compiled(function)


def step_kernel(function: Function) -> Function:
    """Compile like `kernel`, and have LLVM inline it into its callers.

    For parts of the simulation's step: their arguments are records of dozens of arrays, which
    would otherwise be copied at each call.
    """
    return _compiled(function, forceinline=True)


# Functions that only kernels call need no wrapper for calls from Python; leaving it out saves a
# quarter of the renderer's compile time.
_INNER = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def inner_kernel(function: Function) -> Function:
    """Compile like `kernel`, for calls from other kernels only; Python cannot call it."""
    return _compiled(function, **_INNER)


def inlined_kernel(function: Function) -> Function:
    """Compile like `inner_kernel` and inline, for functions that are called for each pixel."""
    return _compiled(function, **_INNER, forceinline=True)


def specialised(function: Function, **kernels: Callable[..., Any]) -> Function:
    """Return a function that calls other kernels instead of some that its module names.

    The kernels that a step calls are chosen when it is built, not in each step. The compiled
    result is cached on disk like any kernel; the names and sources of the chosen kernels are part
    of its name there.

    Args:
        function: A plain function of this package, to be compiled.
        kernels: The kernels to call, keyed by the names they replace in the function's module.
    """
    if all(function.__globals__[name] is kernel for name, kernel in kernels.items()):
        return function
    names = {**function.__globals__, **kernels}
    made = types.FunctionType(function.__code__, names, function.__name__)
    parts = [_identity(kernel) for _, kernel in sorted(kernels.items())]
    digest = hashlib.sha256("".join(parts).encode()).hexdigest()[:16]
    made.__module__ = function.__module__
    made.__qualname__ = f"{function.__qualname__}_{digest}"
    made.__dict__["specialised"] = digest
    return cast("Function", made)


def _identity(kernel: Callable[..., Any], seen: frozenset[str] = frozenset()) -> str:
    """Return a text that identifies a kernel and its source.

    It includes the kernels outside Eyas that it calls; those of Eyas determine the name of the
    folder.
    """
    function = kernel.py_func  # type: ignore[attr-defined]  # numba's dispatcher
    name = f"{function.__module__}.{function.__qualname__}"
    source = Path(inspect.getsourcefile(function) or "")
    text = source.read_text() if source.is_file() else repr(function.__code__.co_code)
    called = [function.__globals__.get(name) for name in function.__code__.co_names]
    others = [
        _identity(other, seen | {name})
        for other in called
        if hasattr(other, "py_func")
        and not other.py_func.__module__.startswith("eyas.")
        and f"{other.py_func.__module__}.{other.py_func.__qualname__}" not in seen | {name}
    ]
    return " ".join([name, text, *others])
