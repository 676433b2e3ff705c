"""The driver that runs programs, as `eyas.gpu.cuda` finds it."""

import atexit
import ctypes
import lzma
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import POINTER, c_char_p, c_int, c_int64, c_size_t, c_uint, c_uint64, c_void_p
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from emulated_card.instructions import statement
from emulated_card.program import Places, Program, read_program
from eyas.gpu.cuda import CudaArray, device
from eyas.gpu.cuda.code import ARCHIVE
from eyas.gpu.cuda.driver import VARIABLE, driver
from eyas.lanes.container import unpacked

__all__ = ["EmulatedCard", "Loaded", "driver_library", "emulated_card"]

_ROOM = Path(__file__).parent

_OPTIONS = (
    *("-shared", "-fPIC", "-O2", "-ftree-vectorize", "-march=native"),
    *("-ffp-contract=off", "-fwrapv", "-fno-strict-aliasing"),
)
"""None lets the compiler fuse a multiplication with an addition."""

_MEMORY = 8 << 30
"""What it is said to have [bytes]."""

_ILLEGAL_ADDRESS = 700
"""CUDA_ERROR_ILLEGAL_ADDRESS."""

_PLACE = np.dtype([("register", "i8"), ("value", "i8")])

_LOAD = ctypes.CFUNCTYPE(c_void_p, c_char_p, c_void_p)
_RUN = ctypes.CFUNCTYPE(c_int, c_void_p, c_uint, c_uint, POINTER(c_uint64))

_LISTS = ("constants", "shared", "local", "data")


class _Program(ctypes.Structure):
    """`Program` of machine.c."""

    _fields_ = [
        *[(name, c_void_p) for name in ("instructions", "targets", *_LISTS)],
        *[(name, c_void_p) for name in ("special", "parameters")],
        *[(f"{name}_count", c_int64) for name in _LISTS],
        *[(name, c_int64) for name in ("start", "registers", "shared_size", "local_size")],
        *[("content", c_void_p), ("content_size", c_int64)],
        *[(name, c_void_p) for name in ("turns", "threads", "pieces")],
    ]


class Loaded:
    """A program that has been loaded, and what has been counted of each of its instructions.

    Attributes:
        program: The program.
        turns: How often a warp did it.
        threads: How many threads took part.
        pieces: How many pieces of 32 bytes of memory they touched.
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        self.turns, self.threads, self.pieces = np.zeros((3, len(program.lines)), np.uint64)
        self._kept: list[Any] = []
        lists = [getattr(program, name) for name in _LISTS]
        content = np.frombuffer(program.content.ljust(1, b"\0"), np.uint8)
        self._laid_out = _Program(
            *[self._at(array) for array in (program.instructions, program.targets)],
            *[self._at(_places(rows)) for rows in lists],
            *[self._at(np.array(one, np.int64)) for one in (program.special, program.parameters)],
            *[len(rows) for rows in lists],
            *[program.start, program.registers, program.shared_size, program.local_size],
            *[self._at(content), len(content)],
            *[self._at(counts) for counts in (self.turns, self.threads, self.pieces)],
        )
        self.address = ctypes.addressof(self._laid_out)

    def _at(self, array: NDArray[Any]) -> int:
        self._kept.append(array)
        return array.ctypes.data


def _places(rows: Places) -> NDArray[np.void]:
    return np.array([(at, value - ((value >> 63) << 64)) for at, value in rows], _PLACE)


class EmulatedCard:
    """The driver's own side.

    Args:
        seed: Of the orders in which blocks are run, and threads that have parted; 0: always the
            same.

    Attributes:
        programs: What has been loaded, by address.
        wrong: What has been wrong, in words.

    Raises:
        RuntimeError: There is no C compiler.
    """

    def __init__(self, seed: int = 0) -> None:
        self.programs: dict[int, Loaded] = {}
        self.wrong: list[str] = []
        self._seed = seed
        self._driver = ctypes.CDLL(str(driver_library()))
        self._driver.fake_memory.argtypes = [c_size_t]
        self._driver.fake_memory(_MEMORY)
        self._callbacks = _LOAD(self._load), _RUN(self._run)
        self._driver.card_programs(*self._callbacks)

    def close(self) -> None:
        """Let go of the driver."""
        self._driver.card_programs(None, None)

    def _load(self, text: bytes, log: int) -> int:
        try:
            loaded = Loaded(_program(text))
        except (ValueError, KeyError) as error:
            said = f"{type(error).__name__}: {error}".encode()[:8000] + b"\0"
            ctypes.memmove(log, said, len(said))
            return 0
        self.programs[loaded.address] = loaded
        return loaded.address

    def _run(self, program: int, blocks: int, threads: int, parameters: Any) -> int:  # noqa: ANN401
        loaded, where = self.programs[program], (c_int64 * 2)()
        self._seed += self._seed > 0
        wrong = _machine().machine_run(
            c_void_p(program), self._driver.card_owns, c_uint(blocks), c_uint(threads), parameters,
            c_uint64(self._seed), where,
        )  # fmt: skip
        if wrong is None:
            return 0
        line = loaded.program.lines[where[0]]
        self.wrong.append(f"{loaded.program.entry}: {wrong.decode()}, {where[1]:#x}, in {line}")
        return _ILLEGAL_ADDRESS


_codes: dict[str, int] = {}
"""Numbers of all instructions that have been met in this process."""


@cache
def _program(text: bytes) -> Program:
    met = dict(_codes)
    program = read_program(text.decode(), met)
    for code in met.keys() - _codes.keys():
        statement(code)
    _codes.update(met)
    return program


def _machine() -> Any:  # noqa: ANN401
    """Return a machine for all instructions that have been met, and those of the shipped PTX."""
    _meet_what_ships()
    return _machine_for(len(_codes))


@cache
def _meet_what_ships() -> None:
    for text in unpacked(lzma.decompress(ARCHIVE.read_bytes()))[1]:
        _program(bytes(text))


@cache
def _machine_for(count: int) -> Any:  # noqa: ANN401
    cases = [f"case {number}: {statement(code)}\n" for code, number in _codes.items()]
    (_folder() / "instructions.inc").write_text("".join(cases))
    path = _folder() / f"machine-{count}.so"
    machine = ctypes.CDLL(str(_compiled(path, _ROOM / "machine.c", f"-I{_folder()}")))
    machine.machine_run.restype = c_char_p
    return machine


@cache
def driver_library() -> Path:
    """Return the driver, compiled; there is one in a process."""
    return _compiled(_folder() / "libcuda.so", _ROOM / "driver.c")


@cache
def _folder() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="emulated-card-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _compiled(path: Path, *arguments: Path | str) -> Path:
    command = ["cc", *_OPTIONS, "-o", str(path), *map(str, arguments), "-lm"]
    try:
        subprocess.run(command, check=True)
    except FileNotFoundError:
        raise RuntimeError("the emulated card needs a C compiler, cc") from None
    return path


@contextmanager
def emulated_card(seed: int = 0) -> Iterator[EmulatedCard]:
    """Have `eyas.gpu.cuda` find an emulated card; PyTorch takes its memory for the processor's.

    Args:
        seed: See `EmulatedCard`.
    """
    before, devices = os.environ.get(VARIABLE), dict(device._devices)
    place, card = CudaArray.__dlpack_device__, EmulatedCard(seed)
    os.environ[VARIABLE] = str(driver_library())
    CudaArray.__dlpack_device__ = lambda _: (1, 0)  # type: ignore[method-assign]  # kDLCPU
    device._devices.clear()
    driver.cache_clear()
    try:
        yield card
    finally:
        card.close()
        CudaArray.__dlpack_device__ = place  # type: ignore[method-assign]
        device._devices.clear()
        device._devices.update(devices)
        driver.cache_clear()
        os.environ.pop(VARIABLE)
        if before is not None:
            os.environ[VARIABLE] = before
