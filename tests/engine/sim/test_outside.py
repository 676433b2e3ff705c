"""Kernels call nothing outside: the C library's functions have other bytes on other machines."""

import runpy
import struct
import subprocess
import sys
from pathlib import Path

import pytest

from eyas.lanes.folder import kernel_folder
from eyas.lanes.machine_code import SUFFIX, read_code
from eyas.lanes.shipped import LEVELS, WIDE, KernelLibrary

TOOL = Path(__file__).parents[3] / "tools" / "ship_kernels.py"

MEMORY = {"memcpy", "memmove", "memset"}
"""What LLVM itself calls to copy and to clear memory; there is only one result."""

BAKING = {"bake_openness", "bake_tiles", "cloud_rays"}
"""Not compiled where their results are in the cache."""

SYMBOLS, ENTRY, UNDEFINED = (2, 11), 24, 0


def outside(code: bytes) -> set[str]:
    """Return the names that an object file or library of 64-bit ELF leaves undefined."""
    assert code[:5] == b"\x7fELF\x02"
    (start,), (count,) = struct.unpack_from("<Q", code, 40), struct.unpack_from("<H", code, 60)
    sections = [struct.unpack_from("<IIQQQQIIQQ", code, start + 64 * k) for k in range(count)]
    found = set()
    for _, kind, _, _, offset, size, link, *_ in sections:
        if kind not in SYMBOLS:
            continue
        names = sections[link][4]
        for at in range(offset, offset + size, ENTRY):
            name, _, _, section = struct.unpack_from("<IBBH", code, at)
            if name and section == UNDEFINED:
                found.add(code[names + name : code.index(b"\0", names + name)].decode())
    return found


def _kernel(name):
    return name.partition("-")[0]


@pytest.mark.skipif(sys.platform != "linux", reason="reads object files of Linux")
@pytest.mark.slow  # runs, and perhaps compiles, every kernel
def test_no_kernel_calls_a_function_of_the_c_library():
    program = runpy.run_path(str(TOOL))
    subprocess.run([sys.executable, "-c", program["USES_ALL"]], check=True)
    codes = {file.name: read_code(file) for file in kernel_folder().glob(f"*{SUFFIX}")}
    codes = {name: code for name, code in codes.items() if _kernel(name) in program["kernels"]()}
    libraries = [level.library for level in (*LEVELS.values(), WIDE)]
    ships = KernelLibrary.opened(LEVELS["x86_64"].library).names
    found = set(map(_kernel, (*codes, *ships)))
    assert program["kernels"]() - BAKING <= found  # none of a test's own
    needs = {name: outside(bytes(code.code)) for name, code in codes.items()}
    needs |= {path.name: outside(path.read_bytes()) for path in libraries}
    assert {name: found - MEMORY for name, found in needs.items() if found - MEMORY} == {}
