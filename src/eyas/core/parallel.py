"""Parallel kernels: one loop over workers for all of them, and arguments that are found by address.

numba's own way, `parallel=True` on each kernel, compiles all that the kernel calls three times
(half a minute for the renderer), and unpacks every array at every call (a tenth of a small
picture's time). Here the parallel loop is compiled alone and knows a kernel by its address only.
"""

import hashlib
import threading
from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.extending import intrinsic

from eyas.core.jit import KERNEL_SETTINGS, kernel, prange

__all__ = ["Held", "Pointer", "parallel_kernel"]

Bundle = TypeVar("Bundle")
Pointee = TypeVar("Pointee", covariant=True)


class Pointer(Protocol[Pointee]):
    """How a parallel kernel sees a bundle: `pointer[0]`."""

    def __getitem__(self, index: int) -> Pointee: ...


class Held(Generic[Bundle]):
    """A tuple of numbers, arrays and tuples of them, laid out once as kernels read it.

    Args:
        bundle: Its arrays are not copied: what is written into them later, kernels see.
    """

    __slots__ = ("_memory", "address", "bundle", "layout")

    def __init__(self, bundle: Bundle) -> None:
        self.bundle = bundle
        self._memory = np.empty(4096, np.uint8)
        self.layout = _lay_out(bundle, self._memory)
        if self.layout < 0:
            self._memory = np.empty(-self.layout, np.uint8)
            self.layout = _lay_out(bundle, self._memory)
        self.address = self._memory.ctypes.data


_ONE_AT_A_TIME = threading.Lock()


class parallel_kernel(Generic[Bundle]):  # noqa: N801  # a decorator like `kernel`
    """Compile a function that does the share of one worker, and call it for all workers at once.

    numba's workqueue layer, the one that survives forking, must not be entered from two Python
    threads at once, so calls wait for each other.

    Args:
        function: Called with `parts`, `worker` and `workers`; `parts[0]` has a pointer for each
            bundle, `parts[0][i][0]` is the bundle itself.
    """

    def __init__(self, function: Callable[[Pointer[Bundle], int, int], None]) -> None:
        self.__doc__ = function.__doc__
        self._function = function
        self._compiled: dict[tuple[int, ...], Any] = {}

    def __call__(self, workers: int, *parts: Held[Any]) -> None:
        """Run the shares of all workers and wait for them."""
        layouts = tuple([part.layout for part in parts])
        table = np.array([part.address for part in parts], np.int64)
        with _ONE_AT_A_TIME:
            if layouts not in self._compiled:
                self._compiled[layouts] = self._compile(parts)
            _run(self._compiled[layouts].address, table.ctypes.data, workers)

    def _compile(self, parts: tuple[Held[Any], ...]) -> Any:  # noqa: ANN401  # numba has no types
        pointers = [numba.types.CPointer(numba.typeof(part.bundle)) for part in parts]
        table = numba.types.CPointer(numba.types.Tuple(pointers))
        signature = numba.void(table, numba.intp, numba.intp)
        return numba.cfunc(signature, **KERNEL_SETTINGS)(self._function)


@intrinsic  # type: ignore[untyped-decorator]
def _size_of(typing_context, value):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, ARG001
    """Return how many bytes a value takes."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, ARG001
        size = context.get_abi_sizeof(context.get_data_type(value))
        return context.get_constant(numba.intp, size)

    return numba.intp(value), generate


@intrinsic  # type: ignore[untyped-decorator]
def _layout_of(typing_context, value):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, ARG001
    """Return a number that is the same for values of one type only, in every process."""
    number = int.from_bytes(hashlib.sha256(str(value).encode()).digest()[:7])

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, ARG001
        return context.get_constant(numba.intp, number)

    return numba.intp(value), generate


@intrinsic  # type: ignore[untyped-decorator]
def _store(typing_context, memory, value):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, ARG001
    """Write a value into memory, as `CPointer` reads it."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
        array = context.make_array(memory)(context, builder, arguments[0])
        kind = context.get_data_type(value).as_pointer()
        context.pack_value(builder, value, arguments[1], builder.bitcast(array.data, kind))
        return context.get_dummy_value()

    return numba.void(memory, value), generate


@intrinsic  # type: ignore[untyped-decorator]
def _call(typing_context, function, table, worker, workers):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, ARG001
    """Call a compiled kernel by its address."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, ARG001
        kind = ir.FunctionType(ir.VoidType(), [cgutils.intp_t] * 3)
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), arguments[1:])
        return context.get_dummy_value()

    return numba.void(*[numba.intp] * 4), generate


@kernel
def _lay_out(bundle, memory):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Write a bundle into memory and return its layout, or minus the bytes it needs."""
    if len(memory) < _size_of(bundle):
        return -_size_of(bundle)
    _store(memory, bundle)
    return _layout_of(bundle)


@numba.njit(cache=True, parallel=True)  # type: ignore[untyped-decorator]
def _run(function: int, table: int, workers: int) -> None:
    for worker in prange(workers):
        _call(function, table, worker, workers)
