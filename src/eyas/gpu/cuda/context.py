"""The driver's context of a graphics processor: its memory, and what else the driver made there."""

import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from ctypes import byref, c_size_t, c_uint64, c_void_p
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.gpu.cuda.driver import OUT_OF_MEMORY, CudaError, card, driver, gib


class Context:
    """The primary context of a graphics processor, which PyTorch uses too.

    Args:
        ordinal: See `eyas.gpu.cuda.driver.card`.

    Attributes:
        name: Of the card.

    Raises:
        CudaError: There is no such card, or it cannot be used.
    """

    def __init__(self, ordinal: int) -> None:
        found = card(ordinal)
        found.check()
        self.name, self.ordinal, self.capability = found.name, ordinal, found.capability
        self._driver, self._handle = driver(), c_void_p()
        doing = f"beginning to use {self.name}"
        retain = "cuDevicePrimaryCtxRetain"  # never released: it ends with the process
        self._driver.call(retain, byref(self._handle), found.handle, doing=doing)

    @contextmanager
    def current(self) -> Iterator[Callable[..., None]]:
        """Have the driver work in this context, and yield `Driver.call`; PyTorch's is as before
        afterwards.
        """
        self._driver.call("cuCtxPushCurrent_v2", self._handle)
        try:
            yield self._driver.call
        finally:
            self._driver.call("cuCtxPopCurrent_v2", byref(c_void_p()))

    def call(self, name: str, *arguments: Any, doing: str = "") -> None:  # noqa: ANN401
        """Call a function of the driver in this context, see `Driver.call`."""
        self._driver.call("cuCtxPushCurrent_v2", self._handle)  # `current` takes twice the time
        try:
            self._driver.call(name, *arguments, doing=doing)
        finally:
            self._driver.call("cuCtxPopCurrent_v2", byref(c_void_p()))

    def destroyed_with(self, owner: object, function: str, handle: Any) -> None:  # noqa: ANN401
        """Have the driver destroy something when nothing refers to its owner any more.

        What is left when the interpreter ends goes with the process.
        """
        weakref.finalize(owner, self._destroy, function, handle).atexit = False

    def _destroy(self, function: str, handle: Any) -> None:  # noqa: ANN401
        with suppress(CudaError):  # after the error of a kernel, and in a forked process
            self.call(function, handle)

    def allocated(self, size: int) -> int:
        """Return the address of so many bytes of new memory.

        Raises:
            CudaError: There is too little.
        """
        address, free, total = c_uint64(), c_size_t(), c_size_t()
        try:
            self.call("cuMemAlloc_v2", byref(address), size)
        except CudaError as error:
            if error.code != OUT_OF_MEMORY:
                raise
            self.call("cuMemGetInfo_v2", byref(free), byref(total))
            raise CudaError(
                f"{self.name} has too little memory: {gib(size)} were asked for, "
                f"{gib(free.value)} of {gib(total.value)} are free",
                error.code,
            ) from None
        return address.value

    def put(self, address: int, values: NDArray[Any] | bytes) -> None:
        """Copy values, C-contiguous, from the memory of this processor, after all work before.

        They have been read when this returns: the driver's function for that says so, and the one
        with a stream does not.
        """
        size = len(values) if isinstance(values, bytes) else values.nbytes
        place = values if isinstance(values, bytes) else c_void_p(values.ctypes.data)
        if size:
            doing = f"copying to {self.name}"
            self.call("cuMemcpyHtoD_v2", address, place, size, doing=doing)

    def got(self, address: int, values: NDArray[np.generic], doing: str) -> None:
        """Fill values, C-contiguous, from the memory of the card, after all work before."""
        if values.size:
            place = c_void_p(values.ctypes.data)
            self.call("cuMemcpyDtoH_v2", place, address, values.nbytes, doing=doing)


class Memory:
    """A piece of the card's memory, which the driver gets back when nothing refers to it any more
    and no work uses it.

    Attributes:
        context: Where it is.
        address: Its address there.
    """

    def __init__(self, context: Context, size: int) -> None:
        self.context, self.address = context, context.allocated(size)
        context.destroyed_with(self, "cuMemFree_v2", self.address)
