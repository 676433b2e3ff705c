"""The language of kernels works without the rest of Eyas."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import eyas.lanes

KERNEL = """
import numpy as np
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import sin_cos
from eyas.lanes.vector import WIDTH, load, select, store, lane_numbers

@kernel(inline=True)
def turned(angle):
    sine, cosine = sin_cos(angle)
    return sine + cosine

@compiled
def write(angles, doubled):
    for k in range(len(angles)):
        angles[k] = turned(angles[k])
    values = load(doubled, 0)
    store(doubled, 0, select(lane_numbers() < np.int32(4), values + values, values))

angles, doubled = np.zeros(3), np.arange(WIDTH, dtype=np.float32)
write(angles, doubled)
print(angles.tolist(), doubled.astype(int).tolist())
import sys
print(sorted(name for name in sys.modules if name.startswith("eyas.") and "lanes" not in name))
"""


@pytest.mark.slow
def test_a_kernel_compiles_and_runs_where_there_are_lanes_alone(tmp_path):
    package = tmp_path / "eyas"
    leave = shutil.ignore_patterns("__pycache__", "shipped")
    shutil.copytree(Path(eyas.lanes.__file__).parent, package / "lanes", ignore=leave)
    (package / "__init__.py").write_text("")
    (tmp_path / "own.py").write_text(KERNEL)
    done = subprocess.run(
        [sys.executable, "own.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "EYAS_CACHE_DIR": str(tmp_path / "cache")},
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["[1.0, 1.0, 1.0] [0, 2, 4, 6, 4, 5, 6, 7]", "[]"]
