"""A graphics processor of NVIDIA as a device for kernels.

All work goes to the driver's legacy default stream, in which PyTorch works too unless it is told
otherwise. So each sees the other's results in the order of the calls, and nothing has to wait. With
a stream of our own that would take an event, made and waited for, at every change of hands.
"""

import ctypes
import os
import threading
import weakref
from collections.abc import Callable, Sequence
from ctypes import byref, c_int, c_uint64, c_void_p
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from eyas.gpu.cuda.bundles import Blocks, CudaBundle
from eyas.gpu.cuda.code import Ptx, ptx_code
from eyas.gpu.cuda.context import Context, Memory
from eyas.gpu.cuda.driver import CudaError, driver
from eyas.gpu.cuda.memory import CudaArray
from eyas.gpu.cuda.order import LEGACY, CudaEvent, CudaGraph, recorded
from eyas.lanes.calls import ParallelCall
from eyas.lanes.vector import BLOCK

_LOCAL_BYTES, _REGISTERS = 3, 4  # CU_FUNC_ATTRIBUTE_LOCAL_SIZE_BYTES and _NUM_REGS

_ERROR_LOG, _ERROR_LOG_SIZE = 5, 6  # CU_JIT_ERROR_LOG_BUFFER and _SIZE_BYTES


class Function(NamedTuple):
    """A kernel, compiled for a card."""

    handle: c_void_p
    name: str
    registers: int  # Of a thread
    local: int  # Memory of a thread beside its registers [bytes]


class Functions:
    """The kernels of a context, each compiled at its first call."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._lock = threading.Lock()
        self._of_call: weakref.WeakKeyDictionary[ParallelCall, dict[Any, Function]]
        self._of_call = weakref.WeakKeyDictionary()
        self._loaded: dict[Ptx, Function] = {}

    def function(
        self, call: ParallelCall, bundles: tuple[CudaBundle, ...], threads: int
    ) -> Function:
        """Return a kernel for bundles of these kinds; see `eyas.lanes.device.Device.launch`."""
        kinds = tuple([bundle.kind for bundle in bundles])
        known = self._of_call.get(call)
        found = None if known is None else known.get((kinds, threads))
        if found is not None:
            return found
        types = tuple([bundle.types for bundle in bundles])
        ptx = ptx_code(call, types, kinds, threads)
        with self._lock:
            if ptx not in self._loaded:
                self._loaded[ptx] = function_of(self._context, ptx, call.function.__name__)
            self._of_call.setdefault(call, {})[kinds, threads] = self._loaded[ptx]
        return self._loaded[ptx]


def function_of(
    context: Context,  # Where it is to run
    ptx: Ptx,  # The kernel
    name: str,  # Its name for people
) -> Function:
    """Have the driver compile a kernel, or find it in its cache.

    Raises:
        CudaError: The driver refuses it; its log is in the message.
    """
    log = ctypes.create_string_buffer(8192)
    options = (c_int * 2)(_ERROR_LOG, _ERROR_LOG_SIZE)
    values = (c_void_p * 2)(ctypes.addressof(log), len(log))
    text = ctypes.create_string_buffer(ptx.text)  # with a zero at its end
    module, handle = c_void_p(), c_void_p()
    doing = f"compiling {name} for {context.name}"
    with context.current() as call:
        try:
            call("cuModuleLoadDataEx", byref(module), text, 2, options, values, doing=doing)
        except CudaError as error:
            said = log.value.decode(errors="replace").strip()
            raise CudaError(f"{error}\n{said}" if said else str(error), error.code) from None
        call("cuModuleGetFunction", byref(handle), module, ptx.entry.encode(), doing=doing)
        registers, local = c_int(), c_int()
        call("cuFuncGetAttribute", byref(registers), _REGISTERS, handle)
        call("cuFuncGetAttribute", byref(local), _LOCAL_BYTES, handle)
    return Function(handle, name, registers.value, local.value)


_SPARE = 4096  # Size of the memory where empty arrays are [bytes], see `eyas.lanes.bundles`.


class CudaDevice:
    """A graphics processor of NVIDIA; see `eyas.lanes.device.Device`, and `cuda_device`.

    Several threads may use it.

    Args:
        ordinal: See `eyas.gpu.cuda.driver.card`.

    Attributes:
        name: Of the card.

    Raises:
        CudaError: There is no such card, or it cannot be used.
    """

    def __init__(self, ordinal: int = 0) -> None:
        self.context = Context(ordinal)
        self.name, self.ordinal = self.context.name, ordinal
        self._lock = threading.RLock()
        self._uploaded: dict[int, tuple[weakref.ref[NDArray[Any]], CudaArray]] = {}
        self._blocks = Blocks(self.context)
        self._tables: dict[tuple[int, ...], int] = {}
        self._functions = Functions(self.context)
        self._stream = LEGACY
        self._used: list[object] | None = None
        self._last = "nothing"
        self._nothing = Memory(self.context, _SPARE)
        self.clear(CudaArray(self._nothing, self._nothing.address, (_SPARE,), np.dtype(np.uint8)))

    def empty(self, shape: int | Sequence[int], dtype: DTypeLike) -> CudaArray:
        """See `Device`."""
        kind = np.dtype(dtype)
        if kind.hasobject:
            raise TypeError("objects of Python cannot be on a graphics processor")
        whole = np.broadcast_to(np.empty((), kind), shape)  # reads the shape as numpy does
        size = whole.size * kind.itemsize
        memory = Memory(self.context, size) if size else self._nothing
        return CudaArray(memory, memory.address, whole.shape, kind)

    def zeros(self, shape: int | Sequence[int], dtype: DTypeLike) -> CudaArray:
        """See `Device`."""
        array = self.empty(shape, dtype)
        self.clear(array)
        return array

    def upload(self, array: NDArray[Any]) -> CudaArray:
        """See `Device`."""
        copy = self.empty(array.shape, array.dtype)
        self.context.put(copy.address, np.ascontiguousarray(array))
        return copy

    def write(self, array: CudaArray, values: NDArray[Any], first: int = 0) -> None:
        """See `Device`."""
        rows = array[first : first + len(values)]
        if rows.shape != values.shape:
            raise ValueError(f"cannot write {values.shape} into {rows.shape}")
        self.context.put(rows.address, np.ascontiguousarray(values, array.dtype))

    def read(self, array: CudaArray) -> NDArray[Any]:
        """See `Device`."""
        values = np.empty(array.shape, array.dtype)
        self.context.got(array.address, values, self._waiting())
        return values

    def clear(self, array: CudaArray) -> None:
        """See `Device`."""
        size = array.nbytes
        self._use(array)
        if size:
            self.context.call("cuMemsetD8Async", array.address, 0, size, self._stream)

    def held(self, bundle: Any) -> CudaBundle:  # noqa: ANN401
        """See `Device`.

        What is written later into an array of numpy does not get to its copy on the card, nor what
        kernels write there back: that is for a `CudaArray`. All arrays are C-contiguous and may be
        written to on the card, whatever those of numpy are.
        """
        return CudaBundle(bundle, self._on_card, self._blocks, self._nothing.address)

    def _on_card(self, part: Any) -> Any:  # noqa: ANN401  # anything in a bundle
        if isinstance(part, np.ndarray):
            return self._upload_once(part)
        if isinstance(part, CudaArray) and part.memory.context is not self.context:
            raise ValueError(f"{part} is not on this graphics processor")
        return part

    def _upload_once(self, array: NDArray[Any]) -> CudaArray:
        """Return the copy of an array; it is kept as long as the array, or a bundle with it."""
        name, kept = id(array), self._uploaded
        with self._lock:
            if name not in kept:
                copy = self.upload(array)
                kept[name] = weakref.ref(array, lambda _: kept.pop(name, None)), copy
            return kept[name][1]

    def launch(
        self,
        call: ParallelCall,
        workers: int,
        *bundles: CudaBundle,
        threads: int = 1,
        block: int | None = None,
    ) -> None:
        """See `Device`.

        Raises:
            CudaError: The driver refuses the kernel, or an earlier one has failed.
        """
        if block is None:
            block = 128 if threads == 1 else BLOCK
        if block % 32 or not 32 <= block <= 1024:
            raise ValueError(f"a block of {block} threads; allowed: multiples of 32 up to 1024")
        if not workers:
            return
        function = self.function(call, *bundles, threads=threads)
        self._use(bundles)
        numbers = (c_uint64 * 3)(self._table(bundles), 0, workers)
        first = ctypes.addressof(numbers)
        given = (c_void_p * 3)(first, first + 8, first + 16)
        blocks = -(-workers * threads // block)
        self._last = function.name
        self.context.call(
            *("cuLaunchKernel", function.handle, blocks, 1, 1, block, 1, 1, 0, self._stream),
            *(given, None),
            doing=f"launching {function.name} for {workers} workers",
        )

    def function(self, call: ParallelCall, *bundles: CudaBundle, threads: int = 1) -> Function:
        """Return what is launched, compiled if it is not yet; arguments as of `launch`."""
        return self._functions.function(call, bundles, threads)

    def _table(self, bundles: tuple[CudaBundle, ...]) -> int:
        """Return the address of a table of the bundles' addresses; what is in it stays true."""
        addresses = tuple([bundle.address for bundle in bundles])
        with self._lock:
            if addresses not in self._tables:
                content = np.array(addresses, np.uint64).tobytes()
                self._tables[addresses] = self._blocks.filled(content)
            return self._tables[addresses]

    def _use(self, what: object) -> None:
        """Keep what recorded work uses."""
        if self._used is not None:
            self._used.append(what)

    def synchronise(self) -> None:
        """See `Device`."""
        self.context.call("cuStreamSynchronize", LEGACY, doing=self._waiting())

    def _waiting(self) -> str:
        return f"waiting for {self.name}, whose last kernel was {self._last}"

    def event(self) -> CudaEvent:
        """Return the moment when all work so far is done."""
        return CudaEvent(self.context)

    def recorded(self, work: Callable[[], None]) -> CudaGraph:
        """Return what a function launches and clears, without doing it, to be done by one call.

        The function has run before, so that all is compiled; `write` and `read` are not recorded
        but done. No other thread may use the device meanwhile.
        """

        def given_to(stream: c_void_p) -> list[object]:
            used: list[object] = []
            self._stream, self._used = stream, used
            try:
                work()
            finally:
                self._stream, self._used = LEGACY, None
            return used

        with self._lock:
            return recorded(self.context, given_to)


_devices: dict[int, CudaDevice] = {}

_lock = threading.Lock()


def _renew_lock() -> None:
    """Have a lock that is free in a forked process."""
    global _lock
    _lock = threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_lock)


def cuda_device(
    ordinal: int = 0,  # See `eyas.gpu.cuda.driver.card`
) -> CudaDevice:
    """Return a graphics processor of NVIDIA: one object for each in a process.

    Raises:
        CudaError: There is none, or it cannot be used; one line says why.
    """
    driver().check()
    with _lock:
        if ordinal not in _devices:
            _devices[ordinal] = CudaDevice(ordinal)
        return _devices[ordinal]
