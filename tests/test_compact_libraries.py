"""Libraries without the zeros between their parts load, and compute what they did."""

import runpy
import struct
import subprocess
import sys
from pathlib import Path

import pytest

TOOL = runpy.run_path(str(Path(__file__).parents[1] / "tools/compact_libraries.py"))
compacted, PART, LOADED = TOOL["compacted"], TOOL["PART"], TOOL["LOADED"]
ANSWERS = """
import ctypes, sys
math = ctypes.CDLL(sys.argv[1])
math.cos.restype, math.cos.argtypes = ctypes.c_double, [ctypes.c_double]
print(math.cos(0.0))
"""


@pytest.fixture
def math():
    """The C library's mathematics, which numpy has loaded."""
    mapped = [line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines()]
    return Path(next(path for path in mapped if Path(path).name.startswith("libm.so"))).read_bytes()


def with_a_gap(data):
    """Return a library with two megabytes of zeros before the last part that is loaded."""
    (first,), (count,) = struct.unpack_from("<Q", data, 32), struct.unpack_from("<H", data, 56)
    places = [first + PART.size * i for i in range(count)]
    parts = [list(PART.unpack_from(data, place)) for place in places]
    begins = max(part[2] for part in parts if part[0] == LOADED)
    made = bytearray(data[:begins] + bytes(2 << 20) + data[begins:])
    for place, part in zip(places, parts, strict=True):
        part[2] += (2 << 20) * (part[2] >= begins)
        PART.pack_into(made, place, *part)
    return bytes(made)


def test_a_library_still_computes(math, tmp_path):
    (tmp_path / "math.so").write_bytes(compacted(math))
    said = subprocess.run(
        [sys.executable, "-c", ANSWERS, tmp_path / "math.so"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (said.returncode, said.stdout) == (0, "1.0\n"), said.stderr


def test_a_gap_is_taken_out(math):
    made = compacted(with_a_gap(math))
    assert made == compacted(math)
    assert len(made) < len(math)
