"""Measurements of `eyas bench`: how calls are timed, and the table."""

import ctypes
import os
import platform
import statistics
import struct
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from rich.table import Table

_CALL = {"x86_64": 298, "aarch64": 241}  # Number of the system call `perf_event_open`
_CYCLES, _INSTRUCTIONS = 0, 1
_SIZE = 64
_OWN_CODE_ONLY = 1 << 5 | 1 << 6  # Neither the kernel of the system nor a hypervisor


class HardwareCounts(NamedTuple):
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


def counted(call: Callable[[], object]) -> HardwareCounts:
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
    return HardwareCounts(*(b - a for a, b in zip(before, after, strict=True)))


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


_BLOCK = 0.05  # Calls are repeated for at least this time for one timing [s]


@dataclass(frozen=True, slots=True)
class Measurement:
    """One line of the table."""

    name: str
    value: float  # Median
    unit: str
    includes: str  # What the figure covers
    repeats: int  # Number of timings of which it is the median
    cpu_microseconds: float | None = None
    """Processor time of all threads for a picture, step, reset or start [µs], median; else None."""
    instructions: float | None = None
    """User instructions for one pixel; None: no picture, or no access to hardware counters."""
    cycles: float | None = None  # User cycles for one pixel; None likewise


@dataclass(frozen=True, slots=True)
class Timing:
    """Timing of repeated calls."""

    rate: float  # Calls per second, median
    cpu: float  # Time of all threads on the processor for one call [s], median
    repeats: int


def timed(call: Callable[[], object], seconds: float) -> Timing:
    """Return the timing of a call: medians over blocks of at least 50 ms."""
    call()
    call()
    rates: list[float] = []
    spent: list[float] = []
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or len(rates) < 3:
        start, on_processor, calls = time.perf_counter(), time.process_time(), 0
        while (elapsed := time.perf_counter() - start) < _BLOCK or not calls:
            call()
            calls += 1
        rates.append(calls / elapsed)
        spent.append((time.process_time() - on_processor) / calls)
    return Timing(statistics.median(rates), statistics.median(spent), len(rates))


def of_pictures(
    name: str, includes: str, draw: Callable[[], object], size: tuple[int, int, int], seconds: float
) -> Measurement:
    """Return the measurement of a call that draws pictures.

    Args:
        seconds: Time to measure [s].
    """
    timing = timed(draw, seconds)
    count, width, height = size
    instructions = cycles = None
    if why_not() is None:
        counts = counted(draw)
        pixels = count * width * height
        instructions, cycles = counts.instructions / pixels, counts.cycles / pixels
    return Measurement(
        name,
        timing.rate * count,
        "/s",
        includes,
        timing.repeats,
        1e6 * timing.cpu / count,
        instructions,
        cycles,
    )


def measurement_table(results: list[Measurement], machine: str) -> Table:
    """Return the measurements as a table; without columns that are empty."""
    table = Table(title=f"eyas bench on {machine}", title_justify="left")
    table.add_column("measurement")
    table.add_column("median", justify="right")
    table.add_column("unit")
    table.add_column("CPU time of one", justify="right")
    columns = {"instructions a pixel": "instructions", "cycles a pixel": "cycles"}
    shown = {
        title: field
        for title, field in columns.items()
        if any(getattr(result, field) is not None for result in results)
    }
    for title in shown:
        table.add_column(title, justify="right")
    table.add_column("includes")
    for result in results:
        counts = [getattr(result, field) for field in shown.values()]
        cells = ("" if count is None else f"{count:,.0f}" for count in counts)
        *first, includes = measurement_cells(result)
        table.add_row(*first, *cells, includes)
    return table


def measurement_cells(result: Measurement) -> tuple[str, str, str, str, str]:
    """Return name, median, unit, processor time of one, and what is included, as texts."""
    digits = 0 if result.value >= 100 else 3 if result.value < 10 else 1
    value, cpu = f"{result.value:,.{digits}f}", _duration(result.cpu_microseconds)
    return result.name, value, result.unit, cpu, result.includes


def _duration(microseconds: float | None) -> str:
    if microseconds is None:
        return ""
    if microseconds >= 1e5:
        return f"{1e-6 * microseconds:.2f} s"
    return f"{microseconds:,.{0 if microseconds >= 100 else 2}f} µs"
