"""What graphics processors of NVIDIA there are."""

import ctypes
from ctypes import c_size_t
from pathlib import Path
from typing import NamedTuple

from eyas.gpu.cuda.code import OLDEST
from eyas.gpu.cuda.driver import CudaError, driver

_MAJOR, _MINOR = 75, 76  # CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR and _MINOR

_VERSION = Path("/sys/module/nvidia/version")
"""Where Linux tells the version of the driver; its library knows only that of its interface."""


class Card(NamedTuple):
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


def card(ordinal: int) -> Card:
    """Return what the driver says about a graphics processor.

    Args:
        ordinal: Its number, as the driver counts those that it shows (`CUDA_VISIBLE_DEVICES`).

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
    return Card(handle, name.value.decode(), memory, (major, minor), count)


def gpu_line(ordinal: int = 0) -> str:
    """Return in one line what graphics processor there is, or why none can be used.

    Processes that are forked later from this one cannot use it; others can.

    Args:
        ordinal: See `card`.
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
