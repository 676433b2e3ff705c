"""Where compiled kernels are kept, in processes of their own."""

import os
import subprocess
import sys
import time
from pathlib import Path

import eyas

TELLS = """
from eyas.lanes.folder import kernel_folder, refusal
print(not refusal(), kernel_folder())
"""

COMPILES = """
from eyas.engine.core.frames import wrap_angle
import numpy as np
from eyas.lanes.elementary.arrays import sin
from eyas.lanes.folder import refusal
sin(np.zeros(1))
print(not refusal(), wrap_angle(1.0))
"""


def run(program, cache):
    """Run a program with a cache of its own, and no machine code that ships; return what it says
    and what it warns of.
    """
    environment = {**os.environ, "EYAS_CACHE_DIR": str(cache), "EYAS_SHIPPED_CODE": "0"}
    environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    return done.stdout.split(), done.stderr


def test_kernels_are_kept_in_the_cache_and_their_use_is_remembered(tmp_path):
    (kept, folder), _ = run(TELLS, tmp_path)
    assert kept == "True"
    assert Path(folder).parent == tmp_path / "kernels"
    os.utime(folder, (0, 0))
    run(TELLS, tmp_path)
    assert time.time() - Path(folder).stat().st_mtime < 100


def test_where_nothing_can_be_kept_kernels_are_not_kept_beside_their_sources(tmp_path):
    (tmp_path / "file").write_text("in the way")
    beside = set(Path(eyas.__file__).parent.rglob("*.nb[ci]"))
    said, warned = run(COMPILES, tmp_path / "file" / "cache")
    assert said == ["False", "1.0"]
    assert warned.count("\n") == 1
    assert "cannot write: Not a directory; so every start" in warned
    assert set(Path(eyas.__file__).parent.rglob("*.nb[ci]")) == beside
