"""Kernels: functions to be compiled, which other kernels call."""

import functools
import hashlib
import os
import re
import types
from collections.abc import Callable
from typing import Any, TypeVar, cast, overload

from eyas.lanes.identity import identity
from eyas.lanes.interrupts import shielded

Function = TypeVar("Function", bound=Callable[..., Any])


class LanesError(ValueError):
    """What a user can mend, in one line."""


class VariableError(LanesError):
    """An environment variable has a value that cannot be used."""


class CompilerError(LanesError):
    """A kernel has to be compiled, and the compiler is not installed."""


def thread_count() -> int:
    """Return the number of threads that draw: all cores, or `NUMBA_NUM_THREADS`.

    Raises:
        VariableError: That is not a number of threads.
    """
    named = os.environ.get("NUMBA_NUM_THREADS")
    if named:
        if not re.fullmatch("[0-9]{1,4}", named) or not int(named):
            raise VariableError(
                f"NUMBA_NUM_THREADS: {named!r} is not allowed; allowed: 1 to 9999 threads"
            )
        return int(named)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def limit_threads(count: int) -> None:
    """Let this process, and those that it starts, draw with so many threads."""
    os.environ["NUMBA_NUM_THREADS"] = str(count)


class Kernel:
    """A function to be compiled; numba is imported when that is needed.

    Attributes:
        py_func: The function.
        threads: What takes its place on graphics processors, None: the same.
        apart: Whether it is never inlined there.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        *,
        inline: bool | None = None,
        double: bool = False,
        threads: Callable[..., Any] | None = None,
        apart: bool = False,
    ) -> None:
        functools.update_wrapper(self, function)
        self.py_func = function
        self.threads, self.apart = threads, apart
        self._inline, self._double = inline, double

    @functools.cached_property
    def _numba_type_(self) -> object:
        """The type by which numba knows it in functions that call it."""
        from eyas.lanes.compilation import KernelType

        made_of = identity(self) if self.py_func.__closure__ is None else None
        threads = None if self.threads is None else getattr(self.threads, "py_func", self.threads)
        return KernelType(
            self.py_func, made_of, inline=self._inline, double=self._double, threads=threads,
            apart=self.apart,
        )  # fmt: skip

    @functools.cached_property
    def _compiled(self) -> Callable[..., Any]:
        from eyas.lanes.compilation import caller_from_python

        return caller_from_python(self.py_func)

    def __call__(self, *args: object) -> Any:  # noqa: ANN401  # as the function
        """Call the compiled function; for tests, since it is compiled in each process anew.

        Programs call what is `compiled`, and compute single numbers by what is `interpreted`.
        """
        with shielded():
            return self._compiled(*args)


@overload
def kernel(function: Function, /) -> Function: ...
@overload
def kernel(
    *,
    inline: bool | None = None,
    double: bool = False,
    threads: Callable[..., Any] | None = None,
    apart: bool = False,
) -> Callable[[Function], Function]: ...
def kernel(
    function: Function | None = None,
    /,
    *,
    inline: bool | None = None,
    double: bool = False,
    threads: Callable[..., Any] | None = None,
    apart: bool = False,
) -> Function | Callable[[Function], Function]:
    """Compile a function that allocates nothing, so that a graphics processor can run it too.

    Args:
        function: A plain function.
        inline: True: LLVM inlines it into its callers: for functions that are called for each
            pixel, and for those whose arguments are records of dozens of arrays, which would
            otherwise be copied at each call. False: never. None: as LLVM thinks best.
        double: Whether numbers of any kind are given to it as float64.
        threads: A kernel that does the same where each lane is a thread of a graphics processor,
            and may go its own way (`eyas.lanes.vector.own`). For loops; what they compute is
            written once, in kernels that both call.
        apart: Whether it is never inlined there: for what loops seldom call. A loop that does not
            fit into the small memory for instructions waits for most of them.
    """

    def made(function: Function) -> Function:
        made = Kernel(function, inline=inline, double=double, threads=threads, apart=apart)
        return cast("Function", made)

    return made if function is None else made(function)


def interpreted(function: Function) -> Function:
    """Return a kernel of plain numbers as a function of Python.

    For few calls: numba, which `Kernel.__call__` needs, takes half a second to import.
    """
    plain = cast("Kernel", function).py_func
    names = plain.__globals__
    called = {name: names[name] for name in plain.__code__.co_names if name in names}
    own = {k: interpreted(v) if isinstance(v, Kernel) else v for k, v in called.items()}
    return cast("Function", types.FunctionType(plain.__code__, own, plain.__name__))


def specialised(function: Function, **kernels: Callable[..., Any]) -> Function:
    """Return a function that calls other kernels instead of some that its module names.

    The kernels that a step calls are chosen when it is built, not in each step. The compiled
    result is cached on disk like any kernel; the names and sources of the chosen kernels are part
    of its name there.

    Args:
        function: A plain function of this package, to be compiled, or a kernel.
        kernels: The kernels to call, keyed by the names they replace in the function's module.
    """
    if isinstance(function, Kernel):
        function = cast("Function", function.py_func)
    if all(function.__globals__[name] is kernel for name, kernel in kernels.items()):
        return function
    names = {**function.__globals__, **kernels}
    made = types.FunctionType(function.__code__, names, function.__name__)
    parts = [identity(kernel) for _, kernel in sorted(kernels.items())]
    digest = hashlib.sha256("".join(parts).encode()).hexdigest()[:16]
    made.__module__ = function.__module__
    made.__qualname__ = f"{function.__qualname__}_{digest}"
    return cast("Function", made)
