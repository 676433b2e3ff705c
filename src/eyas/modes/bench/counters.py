"""Hardware counters of this process: instructions and cycles of its own code, all threads.

They repeat within a thousandth and a tenth on a busy machine, which times do not. Linux gives
access to them, but seldom in containers and virtual machines.
"""

import ctypes
import os
import platform
import struct
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

__all__ = ["Counts", "counted", "why_not"]

_CALL = {"x86_64": 298, "aarch64": 241}
"""Number of the system call `perf_event_open`."""

_CYCLES, _INSTRUCTIONS = 0, 1
_SIZE = 64
_OWN_CODE_ONLY = 1 << 5 | 1 << 6
"""Neither the kernel of the system nor a hypervisor."""


class Counts(NamedTuple):
    """What the code of this process did."""

    instructions: int
    cycles: int


class _NoAccessError(Exception):
    """The system gives no access; the text says why."""


def why_not() -> str | None:
    """Return why the counters cannot be read; None if they can."""
    try:
        os.close(_opened(_CYCLES, os.getpid()))
    except _NoAccessError as error:
        return str(error)
    return None


def counted(call: Callable[[], object]) -> Counts:
    """Return what a call does in all threads that exist before it."""
    threads = [int(path.name) for path in Path("/proc/self/task").iterdir()]
    files = [[_opened(kind, thread) for thread in threads] for kind in (_INSTRUCTIONS, _CYCLES)]
    try:
        before = [sum(map(_read, group)) for group in files]
        call()
        after = [sum(map(_read, group)) for group in files]
    finally:
        for group in files:
            for file in group:
                os.close(file)
    return Counts(*(b - a for a, b in zip(before, after, strict=True)))


def _opened(kind: int, thread: int) -> int:
    """Return the file of a counter of one thread."""
    number = _CALL.get(platform.machine())
    if platform.system() != "Linux" or number is None:
        raise _NoAccessError(f"{platform.system()} {platform.machine()}")
    # type, size, what to count, period, samples, format, flags, three for other uses
    attributes = struct.pack("=IIQQQQQIIQ", 0, _SIZE, kind, 0, 0, 0, _OWN_CODE_ONLY, 0, 0, 0)
    library = ctypes.CDLL(None, use_errno=True)
    file: int = library.syscall(
        *(number, ctypes.c_char_p(attributes), thread, -1, -1, ctypes.c_ulong(0))
    )
    if file < 0:
        raise _NoAccessError(os.strerror(ctypes.get_errno()))
    return file


def _read(file: int) -> int:
    (value,) = struct.unpack("=Q", os.read(file, 8))
    return int(value)
