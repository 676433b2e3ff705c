"""The functions of NVIDIA's driver that are needed, by ctypes over the library that comes with it.

Names and types are those of `cuda.h`, the driver's interface, which NVIDIA keeps stable: functions
with a changed one get a name with `_v2`.
"""

import ctypes
import os
from ctypes import POINTER, c_char_p, c_float, c_int, c_size_t, c_ubyte, c_uint, c_uint64, c_void_p
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from eyas.gpu.cuda.code import OLDEST
from eyas.lanes.trusted import OWNER

VARIABLE = f"{OWNER.upper()}_LIBCUDA"
"""Environment variable: path of the driver's library, instead of the system's `libcuda.so.1`."""

OUT_OF_MEMORY = 2  # CUDA_ERROR_OUT_OF_MEMORY

_NOT_INITIALIZED, _NO_DEVICE = 3, 100

_BY_KERNELS = frozenset({700, 702, *range(714, 720)})
"""Errors of kernels, such as CUDA_ERROR_ILLEGAL_ADDRESS, told at whatever is called later."""

_ADDRESS = c_uint64
"""CUdeviceptr. Contexts, modules, functions, streams, events and graphs are pointers."""

_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "cuInit": (c_uint,),
    "cuDriverGetVersion": (POINTER(c_int),),
    "cuDeviceGetCount": (POINTER(c_int),),
    "cuDeviceGet": (POINTER(c_int), c_int),
    "cuDeviceGetName": (c_char_p, c_int, c_int),
    "cuDeviceGetAttribute": (POINTER(c_int), c_int, c_int),
    "cuDeviceTotalMem_v2": (POINTER(c_size_t), c_int),
    "cuDevicePrimaryCtxRetain": (POINTER(c_void_p), c_int),
    "cuCtxPushCurrent_v2": (c_void_p,),
    "cuCtxPopCurrent_v2": (POINTER(c_void_p),),
    "cuMemGetInfo_v2": (POINTER(c_size_t), POINTER(c_size_t)),
    "cuMemAlloc_v2": (POINTER(_ADDRESS), c_size_t),
    "cuMemFree_v2": (_ADDRESS,),
    "cuMemcpyHtoD_v2": (_ADDRESS, c_void_p, c_size_t),
    "cuMemcpyDtoH_v2": (c_void_p, _ADDRESS, c_size_t),
    "cuMemsetD8Async": (_ADDRESS, c_ubyte, c_size_t, c_void_p),
    "cuModuleLoadDataEx": (
        *(POINTER(c_void_p), c_void_p, c_uint),
        *(POINTER(c_int), POINTER(c_void_p)),
    ),
    "cuModuleGetFunction": (POINTER(c_void_p), c_void_p, c_char_p),
    "cuFuncGetAttribute": (POINTER(c_int), c_int, c_void_p),
    "cuFuncSetAttribute": (c_void_p, c_int, c_int),
    "cuLaunchKernel": (
        *(c_void_p, *[c_uint] * 6, c_uint, c_void_p),
        *(POINTER(c_void_p), POINTER(c_void_p)),
    ),
    "cuStreamCreate": (POINTER(c_void_p), c_uint),
    "cuStreamDestroy_v2": (c_void_p,),
    "cuStreamSynchronize": (c_void_p,),
    "cuStreamWaitEvent": (c_void_p, c_void_p, c_uint),
    "cuStreamBeginCapture_v2": (c_void_p, c_int),
    "cuStreamEndCapture": (c_void_p, POINTER(c_void_p)),
    "cuGraphInstantiateWithFlags": (POINTER(c_void_p), c_void_p, c_uint64),
    "cuGraphLaunch": (c_void_p, c_void_p),
    "cuGraphDestroy": (c_void_p,),
    "cuGraphExecDestroy": (c_void_p,),
    "cuEventCreate": (POINTER(c_void_p), c_uint),
    "cuEventRecord": (c_void_p, c_void_p),
    "cuEventSynchronize": (c_void_p,),
    "cuEventElapsedTime": (POINTER(c_float), c_void_p, c_void_p),
    "cuEventDestroy_v2": (c_void_p,),
}
"""Types of the parameters; all functions return a CUresult, an int that is 0 if all is well."""


class CudaError(RuntimeError):
    """A graphics processor cannot be used, or not for what was attempted.

    Attributes:
        code: The driver's number of the error; 0 if the error is not the driver's.
    """

    def __init__(self, message: str, code: int = 0) -> None:
        super().__init__(message)
        self.code = code


class CudaDriver:
    """The driver of this process."""

    def __init__(
        self,
        path: str,  # Its library
    ) -> None:
        try:
            self._library = ctypes.CDLL(path)
            for name, types in _SIGNATURES.items():
                function = getattr(self._library, name)
                function.argtypes, function.restype = types, c_int
        except OSError as error:
            raise CudaError(f"there is no driver of NVIDIA: {error}") from None
        except AttributeError as error:
            raise CudaError(f"the driver of NVIDIA is too old: {error}") from None
        self._process = os.getpid()
        self.call("cuInit", 0)

    def check(self) -> None:
        """Raise a `CudaError` unless this process may use the driver."""
        if os.getpid() != self._process:
            raise CudaError(
                "a process forked from one that uses a graphics processor cannot use it; start "
                'processes with multiprocessing\'s method "spawn"'
            )

    def call(self, name: str, *arguments: Any, doing: str = "") -> None:  # noqa: ANN401
        """Call a function of the driver by its name; `doing` says to people what is attempted.

        Raises:
            CudaError: It failed, or the process is forked from one that uses the driver.
        """
        self.check()
        code = getattr(self._library, name)(*arguments)
        if code:
            raise CudaError(f"{doing or name}: {self._text(code)}", code)

    def number(self, name: str, *arguments: Any, kind: Any = c_int) -> int:  # noqa: ANN401
        """Return the number that a function of the driver writes to its first parameter."""
        found = kind()
        self.call(name, ctypes.byref(found), *arguments)
        return found.value or 0

    def _text(self, code: int) -> str:
        """Return the driver's name of an error and what it says about it."""
        parts = []
        for name in ("cuGetErrorName", "cuGetErrorString"):
            text = c_char_p()
            getattr(self._library, name)(c_int(code), ctypes.byref(text))
            parts.append((text.value or b"?").decode())
        if code == _NOT_INITIALIZED:
            parts.append("was this process forked from one that uses a graphics processor?")
        if code in _BY_KERNELS:
            parts.append("a kernel did that; CUDA_LAUNCH_BLOCKING=1 tells which")
        return f"error {code}, " + ": ".join(parts)


@cache
def driver() -> CudaDriver:
    """Return the driver.

    Raises:
        CudaError: There is none, or it finds no graphics processor.
    """
    try:
        return CudaDriver(os.environ.get(VARIABLE) or "libcuda.so.1")
    except CudaError as error:
        if error.code == _NO_DEVICE:
            raise CudaError("there is no graphics processor of NVIDIA", error.code) from None
        raise


_MAJOR, _MINOR = 75, 76  # CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR and _MINOR

_VERSION = Path("/sys/module/nvidia/version")
"""Where Linux tells the version of the driver; its library knows only that of its interface."""


class CardProperties(NamedTuple):
    """What the driver says about a graphics processor."""

    handle: int
    name: str
    memory: int  # [bytes]
    capability: tuple[int, int]
    cards: int  # How many graphics processors there are

    def check(self) -> None:
        """Raise a `CudaError` if it is too old."""
        if self.capability < OLDEST:
            raise CudaError(
                f"{self.name} has compute capability {_dotted(self.capability)}; "
                f"needed is {_dotted(OLDEST)} or more"
            )


def card(
    ordinal: int,  # Its number, as the driver counts those that it shows (`CUDA_VISIBLE_DEVICES`)
) -> CardProperties:
    """Return what the driver says about a graphics processor.

    Raises:
        CudaError: There is none.
    """
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
    return CardProperties(handle, name.value.decode(), memory, (major, minor), count)


def gpu_line(
    ordinal: int = 0,  # See `card`
) -> str:
    """Return in one line what graphics processor there is, or why none can be used.

    Processes that are forked later from this one cannot use it; others can.
    """
    try:
        found = card(ordinal)
        found.check()
        version = driver().number("cuDriverGetVersion")
    except CudaError as error:
        return str(error)
    parts = [found.name, gib(found.memory), f"compute capability {_dotted(found.capability)}"]
    cuda = f"CUDA {version // 1000}.{version % 1000 // 10}"
    try:
        parts.append(f"driver {_VERSION.read_text().strip()} ({cuda})")
    except OSError:  # such as Linux in Windows
        parts.append(cuda)
    if found.cards > 1:
        parts.append(f"number {ordinal} of {found.cards}")
    return ", ".join(parts)


def gib(size: int) -> str:
    """Return a size in bytes for people."""
    return f"{size / 2**30:.2f} GiB"


def _dotted(capability: tuple[int, int]) -> str:
    return "{}.{}".format(*capability)
