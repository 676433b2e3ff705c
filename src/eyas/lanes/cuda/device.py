"""A graphics processor of NVIDIA as a device for kernels.

All work goes to the legacy default stream, which is also the one in which PyTorch works unless told
otherwise, so both see each other's results in the order of the calls, without waiting. A stream of
our own would be faster nowhere: kernels here fill the card.
"""

import ctypes
import os
import threading
import weakref
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from ctypes import byref, c_float, c_int, c_size_t, c_uint64, c_void_p
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from eyas.lanes.calls import ParallelCall
from eyas.lanes.cuda.bundles import laid, mapped, types_of
from eyas.lanes.cuda.code import OLDEST, Ptx, ptx_code
from eyas.lanes.cuda.driver import OUT_OF_MEMORY, CudaError, driver
from eyas.lanes.cuda.memory import CudaArray, Memory

__all__ = ["CudaBundle", "CudaDevice", "CudaEvent", "Graph", "cuda_device", "gpu_line"]

_MAJOR, _MINOR = 75, 76
"""CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR and _MINOR."""

_REGISTERS, _LOCAL_BYTES, _DYNAMIC_SHARED = 4, 3, 8
"""CU_FUNC_ATTRIBUTE_NUM_REGS, _LOCAL_SIZE_BYTES and _MAX_DYNAMIC_SHARED_SIZE_BYTES."""

_SHARED = 48 * 1024
"""Shared memory that a block has without asking for more [bytes]."""

_ERROR_LOG, _ERROR_LOG_SIZE = 5, 6
"""CU_JIT_ERROR_LOG_BUFFER and _SIZE_BYTES."""

_NON_BLOCKING = 1
"""CU_STREAM_NON_BLOCKING: not ordered with the legacy default stream."""

_RELAXED = 2
"""CU_STREAM_CAPTURE_MODE_RELAXED: memory may be allocated meanwhile."""

_SPARE = 4096
"""Size of the memory where empty arrays are [bytes], see `eyas.lanes.held`."""

_SLAB = 1 << 20
"""Memory for bundles is allocated in pieces of this size [bytes]; a bundle takes some kilobytes."""


class CudaBundle:
    """A bundle in the memory of a graphics processor.

    Attributes:
        address: There.
        kind: Identifies its type, see `eyas.lanes.held.Held`.
        bundle: The tuple, with all its arrays in the device's memory.
    """

    def __init__(self, device: "CudaDevice", bundle: Any, kind: str, memory: "_Block") -> None:  # noqa: ANN401
        self.bundle, self.kind = bundle, kind
        self.address = memory.address
        weakref.finalize(self, device.give_back, memory).atexit = False


class _Block(NamedTuple):
    """A small piece of the device's memory."""

    address: int
    size: int
    """[bytes]"""


class _Function(NamedTuple):
    """A kernel, compiled by the driver."""

    handle: c_void_p
    name: str
    registers: int
    """Of a thread."""
    local: int
    """Memory of a thread beside its registers [bytes]."""


class CudaEvent:
    """A moment in the work of a device, to measure how long it takes."""

    def __init__(self, device: "CudaDevice") -> None:
        self._device, self._handle = device, c_void_p()
        with device.current() as call:
            call("cuEventCreate", byref(self._handle), 0)
            call("cuEventRecord", self._handle, device.stream)
        weakref.finalize(self, device.destroy, "cuEventDestroy_v2", self._handle).atexit = False

    def since(self, earlier: "CudaEvent") -> float:
        """Return the time from another event to this [s], after waiting for this."""
        passed = c_float()
        with self._device.current() as call:
            call("cuEventSynchronize", self._handle)
            call("cuEventElapsedTime", byref(passed), earlier._handle, self._handle)
        return passed.value / 1000.0


class Graph:
    """Launches recorded by `CudaDevice.recorded`, to be done again by one call."""

    def __init__(self, device: "CudaDevice", handle: c_void_p, kept: list[Any]) -> None:
        self._device, self._handle, self._kept = device, handle, kept
        weakref.finalize(self, device.destroy, "cuGraphExecDestroy", handle).atexit = False

    def __call__(self) -> None:
        """Do them, as any other work."""
        with self._device.current() as call:
            call("cuGraphLaunch", self._handle, self._device.stream)


class CudaDevice:
    """A graphics processor of NVIDIA; see `eyas.lanes.device.Device`, and `cuda_device`.

    Several threads may use it. Its context is the one that PyTorch has.

    Args:
        ordinal: Its number, as the driver counts those that it shows (`CUDA_VISIBLE_DEVICES`).

    Raises:
        CudaError: It cannot be used.
    """

    def __init__(self, ordinal: int = 0) -> None:
        self._driver = driver()
        about = _about(ordinal)
        if about.capability < OLDEST:
            raise CudaError(
                f"{about.name} has compute capability {_dotted(about.capability)}; "
                f"needed is {_dotted(OLDEST)} or more"
            )
        self.name, self.ordinal, self.capability = about.name, ordinal, about.capability
        self.stream = c_void_p(None)
        """Where work goes now: to the legacy default stream, or into a graph."""
        self._context = c_void_p()
        self._driver.call(
            "cuDevicePrimaryCtxRetain", byref(self._context), about.handle,
            doing=f"beginning to use {self.name}",
        )  # fmt: skip
        self._lock = threading.RLock()
        self._uploaded: dict[int, tuple[weakref.ref[Any], CudaArray]] = {}
        self._free: dict[int, list[int]] = {}
        self._slab, self._slab_left = 0, 0
        self._tables: dict[tuple[int, ...], int] = {}
        self._functions: weakref.WeakKeyDictionary[ParallelCall, dict[Any, _Function]]
        self._functions = weakref.WeakKeyDictionary()
        self._loaded: dict[Ptx, _Function] = {}
        self._recorded: list[Any] | None = None
        self._last = "nothing"
        self._nothing = self.zeros(_SPARE, np.uint8)

    @contextmanager
    def current(self) -> Iterator[Callable[..., None]]:
        """Make this device the one that the driver works with, and yield how to call the driver."""
        self._driver.call("cuCtxPushCurrent_v2", self._context)
        try:
            yield self._driver.call
        finally:
            self._driver.call("cuCtxPopCurrent_v2", byref(c_void_p()))

    # Memory

    def allocated(self, size: int) -> int:
        """Return the address of so many bytes of new memory.

        Raises:
            CudaError: There is too little.
        """
        address, free, total = c_uint64(), c_size_t(), c_size_t()
        with self.current() as call:
            try:
                call("cuMemAlloc_v2", byref(address), max(size, 1))
            except CudaError as error:
                if error.code != OUT_OF_MEMORY:
                    raise
                call("cuMemGetInfo_v2", byref(free), byref(total))
                raise CudaError(
                    f"{self.name} has too little memory: {_gib(size)} were asked for, "
                    f"{_gib(free.value)} of {_gib(total.value)} are free",
                    error.code,
                ) from None
        return address.value

    def free(self, address: int) -> None:
        """Give memory back to the driver, which waits until no work uses it."""
        self.destroy("cuMemFree_v2", address)

    def destroy(self, function: str, handle: Any) -> None:  # noqa: ANN401
        """Have the driver destroy what nothing refers to any more, if there is a driver still."""
        if self._driver.usable:
            try:
                with self.current() as call:
                    call(function, handle)
            except CudaError:  # after an error of a kernel, or at the end of the process
                pass

    def empty(self, shape: int | Sequence[int], dtype: DTypeLike) -> CudaArray:
        """See `Device`."""
        kind = np.dtype(dtype)
        if kind.hasobject:
            raise TypeError("objects of Python cannot be on a graphics processor")
        whole = np.broadcast_to(np.empty((), kind), shape)  # reads the shape as numpy does
        if not whole.size:
            return CudaArray(self._nothing.memory, self._nothing.address, whole.shape, kind)
        memory = Memory(self, whole.size * kind.itemsize)
        return CudaArray(memory, memory.address, whole.shape, kind)

    def zeros(self, shape: int | Sequence[int], dtype: DTypeLike) -> CudaArray:
        """See `Device`."""
        array = self.empty(shape, dtype)
        self.clear(array)
        return array

    def upload(self, array: NDArray[Any]) -> CudaArray:
        """See `Device`."""
        copy = self.empty(array.shape, array.dtype)
        self._put(copy.address, np.ascontiguousarray(array), copy.nbytes)
        return copy

    def write(self, array: CudaArray, values: NDArray[Any], first: int = 0) -> None:
        """See `Device`."""
        rows = array[first : first + len(values)]
        if rows.shape != values.shape:
            raise ValueError(f"cannot write {values.shape} into {rows.shape}")
        self._put(rows.address, np.ascontiguousarray(values, array.dtype), rows.nbytes)

    def _put(self, address: int, values: NDArray[Any] | bytes, size: int) -> None:
        """Copy from the memory of this processor, which has been read when this returns."""
        if not size:
            return
        place = values if isinstance(values, bytes) else c_void_p(values.ctypes.data)
        with self.current() as call:  # not the function with a stream, which may read it later
            call("cuMemcpyHtoD_v2", address, place, size, doing=f"copying to {self.name}")

    def read(self, array: CudaArray) -> NDArray[Any]:
        """See `Device`."""
        values = np.empty(array.shape, array.dtype)
        if values.size:
            with self.current() as call:
                place = c_void_p(values.ctypes.data)
                call(
                    "cuMemcpyDtoH_v2", place, array.address, array.nbytes, doing=self._waiting()
                )  # fmt: skip
        return values

    def clear(self, array: CudaArray) -> None:
        """See `Device`."""
        if array.nbytes:
            with self.current() as call:
                call("cuMemsetD8Async", array.address, 0, array.nbytes, self.stream)

    # Bundles

    def held(self, bundle: Any) -> CudaBundle:  # noqa: ANN401
        """See `Device`.

        What a kernel writes into an array that came from numpy stays on the device, and what is
        written into that here after the first upload does not get there; use a `CudaArray`, and
        `write`. Arrays that are read-only or not contiguous are neither on the device.
        """
        whole = mapped(bundle, self._on_device)
        content, kind = laid(whole, self._nothing.address)
        block = self._block(len(content))
        self._put(block.address, content, len(content))
        return CudaBundle(self, whole, kind, block)

    def _on_device(self, part: Any) -> Any:  # noqa: ANN401  # anything in a bundle
        if isinstance(part, CudaArray) and part.device is not self:
            raise ValueError(f"{part} is not on {self.name}")
        return self._upload_once(part) if isinstance(part, np.ndarray) else part

    def _upload_once(self, array: NDArray[Any]) -> CudaArray:
        with self._lock:
            found = self._uploaded.get(id(array))
            if found is not None and found[0]() is array:
                return found[1]
            name, kept = id(array), self._uploaded

            def forget(reference: object) -> None:
                if name in kept and kept[name][0] is reference:
                    del kept[name]

            copy = self.upload(array)
            kept[name] = weakref.ref(array, forget), copy
            return copy

    def _block(self, size: int) -> _Block:
        """Return memory for a bundle: used before, or of a slab, or its own."""
        size = max(256, 1 << (size - 1).bit_length())
        with self._lock:
            free = self._free.setdefault(size, [])
            if free:
                return _Block(free.pop(), size)
            if size > _SLAB:
                return _Block(self.allocated(size), size)
            if size > self._slab_left:
                self._slab, self._slab_left = self.allocated(_SLAB), _SLAB
            self._slab_left -= size
            return _Block(self._slab + self._slab_left, size)

    def give_back(self, block: _Block) -> None:
        """Use a block again: what is written there then comes after all work so far."""
        self._free[block.size].append(block.address)

    # Kernels

    def launch(
        self,
        call: ParallelCall,
        workers: int,
        *bundles: CudaBundle,
        threads: int = 1,
        block: int = 128,
        shared: int = 0,
    ) -> None:
        """See `Device`.

        Args:
            call: See there.
            workers: See there.
            bundles: See there.
            threads: See there.
            block: Threads of a block, a multiple of 32.
            shared: Shared memory of a block [bytes].

        Raises:
            CudaError: The driver refuses the kernel, or an earlier one has failed.
        """
        if block % 32 or not 0 < block <= 1024:
            raise ValueError(f"a block of {block} threads; allowed: 32 to 1024, a multiple of 32")
        if not workers:
            return
        function = self.function(call, *bundles, threads=threads)
        numbers = c_uint64(self._table(bundles)), c_uint64(0), c_uint64(workers)
        given = (c_void_p * 3)(*[ctypes.addressof(number) for number in numbers])
        blocks = -(-workers * threads // block)
        if self._recorded is not None:
            self._recorded += bundles
        self._last = function.name
        with self.current() as do:
            if shared > _SHARED:
                do("cuFuncSetAttribute", function.handle, _DYNAMIC_SHARED, shared)
            do(
                "cuLaunchKernel", function.handle, blocks, 1, 1, block, 1, 1, shared, self.stream,
                given, None, doing=f"launching {function.name} with {blocks} blocks of {block}",
            )  # fmt: skip

    def function(self, call: ParallelCall, *bundles: CudaBundle, threads: int = 1) -> _Function:
        """Return a kernel for bundles of these kinds, compiled by the driver at the first call."""
        kinds = tuple([bundle.kind for bundle in bundles])
        known = self._functions.get(call)
        found = known and known.get((kinds, threads))
        if found:
            return found
        types = tuple([types_of(bundle.bundle) for bundle in bundles])
        ptx = ptx_code(call, types, kinds, threads)
        with self._lock:
            if ptx not in self._loaded:
                self._loaded[ptx] = self._load(ptx, call.function.__name__)
            known = self._functions.setdefault(call, {})
            return known.setdefault((kinds, threads), self._loaded[ptx])

    def _load(self, ptx: Ptx, name: str) -> _Function:
        """Have the driver compile a kernel."""
        log = ctypes.create_string_buffer(8192)
        options = (c_int * 2)(_ERROR_LOG, _ERROR_LOG_SIZE)
        values = (c_void_p * 2)(ctypes.addressof(log), len(log))
        module, handle = c_void_p(), c_void_p()
        with self.current() as call:
            try:
                call(
                    "cuModuleLoadDataEx", byref(module), ctypes.c_char_p(ptx.text), 2, options,
                    values, doing=f"compiling {name} for {self.name}",
                )  # fmt: skip
            except CudaError as error:
                said = log.value.decode(errors="replace").strip()
                raise CudaError(f"{error}\n{said}" if said else str(error), error.code) from None
            call("cuModuleGetFunction", byref(handle), module, ptx.entry.encode())
            number = self._driver.number
            registers = number("cuFuncGetAttribute", _REGISTERS, handle)
            local = number("cuFuncGetAttribute", _LOCAL_BYTES, handle)
        return _Function(handle, name, registers, local)

    def _table(self, bundles: tuple[CudaBundle, ...]) -> int:
        """Return the address of a table of the bundles' addresses; one is right for ever."""
        addresses = tuple([bundle.address for bundle in bundles])
        with self._lock:
            found = self._tables.get(addresses)
            if found is None:
                content = np.array(addresses or (0,), np.uint64)
                found = self._block(content.nbytes).address
                self._put(found, content, content.nbytes)
                self._tables[addresses] = found
            return found

    # Order

    def synchronise(self) -> None:
        """See `Device`."""
        with self.current() as call:
            call("cuStreamSynchronize", self.stream, doing=self._waiting())

    def _waiting(self) -> str:
        return f"waiting for {self.name}, which was given {self._last} last"

    def let_wait(self, stream: int) -> None:
        """Have a stream of the driver's wait for all work so far."""
        moment = CudaEvent(self)
        with self.current() as call:
            call("cuStreamWaitEvent", c_void_p(stream), moment._handle, 0)

    def event(self) -> CudaEvent:
        """Return the moment when all work so far is done."""
        return CudaEvent(self)

    def recorded(self, work: Callable[[], None]) -> Graph:
        """Return what a function launches and clears, without doing it, to be done by one call.

        It must have run before: what is compiled, uploaded or laid out is not recorded.
        """
        stream, graph, handle = c_void_p(), c_void_p(), c_void_p()
        with self._lock, self.current() as call:
            call("cuStreamCreate", byref(stream), _NON_BLOCKING)
            call("cuStreamBeginCapture_v2", stream, _RELAXED)
            before, self.stream, kept = self.stream, stream, []
            self._recorded = kept
            try:
                work()
            finally:
                self.stream, self._recorded = before, None
                call("cuStreamEndCapture", stream, byref(graph))
                call("cuStreamDestroy_v2", stream)
            call("cuGraphInstantiateWithFlags", byref(handle), graph, 0)
            call("cuGraphDestroy", graph)
        return Graph(self, handle, kept)


class _About(NamedTuple):
    """What the driver says about a card."""

    handle: int
    name: str
    memory: int
    """[bytes]"""
    capability: tuple[int, int]
    count: int
    """How many cards there are."""


def _about(ordinal: int) -> _About:
    number = driver().number
    count = number("cuDeviceGetCount")
    if not 0 <= ordinal < count:
        raise CudaError(f"there is no graphics processor {ordinal}; the driver shows {count}")
    handle = number("cuDeviceGet", ordinal)
    name = ctypes.create_string_buffer(256)
    driver().call("cuDeviceGetName", name, len(name), handle)
    memory = number("cuDeviceTotalMem_v2", handle, kind=c_size_t)
    major = number("cuDeviceGetAttribute", _MAJOR, handle)
    minor = number("cuDeviceGetAttribute", _MINOR, handle)
    return _About(handle, name.value.decode(), memory, (major, minor), count)


def _dotted(capability: tuple[int, int]) -> str:
    return "{}.{}".format(*capability)


def _gib(size: int) -> str:
    return f"{size / 2**30:.2f} GiB"


_devices: dict[int, CudaDevice] = {}

_LOCK = threading.Lock()


def _renew_lock() -> None:
    """Begin anew in a forked process, where nobody would open a lock that was held."""
    global _LOCK  # noqa: PLW0603
    _LOCK = threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_lock)


def cuda_device(ordinal: int = 0) -> CudaDevice:
    """Return a graphics processor of NVIDIA, one object for each in a process.

    Args:
        ordinal: Its number, as the driver counts those that it shows (`CUDA_VISIBLE_DEVICES`).

    Raises:
        CudaError: There is none, or it cannot be used; one line says why.
    """
    driver().check()
    with _LOCK:
        if ordinal not in _devices:
            _devices[ordinal] = CudaDevice(ordinal)
        return _devices[ordinal]


def gpu_line(ordinal: int = 0) -> str:
    """Return in one line what graphics processor there is, or why none can be used."""
    try:
        about = _about(ordinal)
        version = driver().number("cuDriverGetVersion")
    except CudaError as error:
        return str(error)
    parts = [about.name, _gib(about.memory), f"compute capability {_dotted(about.capability)}"]
    if about.capability < OLDEST:
        parts[-1] += f", needed is {_dotted(OLDEST)} or more"
    parts.append(f"CUDA {version // 1000}.{version % 1000 // 10}")
    if about.count > 1:
        parts.append(f"number {ordinal} of {about.count}")
    return ", ".join(parts)
