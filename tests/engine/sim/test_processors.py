"""A flight has the same bytes on another processor, with other variants of the C library.

The other processor is this one, in a process in which the C library, numpy and BLAS are told to do
without its newer instructions: their functions then have other last bits.
"""

import os
import subprocess
import sys

import numpy as np
import pytest

NEWER = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
OTHER = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F",
    "NPY_DISABLE_CPU_FEATURES": " ".join(NEWER),
    "OPENBLAS_CORETYPE": "Nehalem",
}

FLIES = """
import hashlib
import sys
import numpy as np
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone

simulation = build_simulation(SimConfig(**eval(sys.argv[1])), each_alone(32))
simulation.reset()
rng, found = np.random.default_rng(1), {}
for _ in range(150):
    command = rng.uniform(-1.0, 1.0, (32, 4)) * (4.0, 4.0, 0.5, 0.5)
    result = simulation.advance(command, 10)
    trackers, cameras, targets, episodes, _ = simulation.snapshot
    basic, reward = simulation.packets()
    parts = {
        "rewards": result.reward,
        "positions": trackers.position,
        "attitudes": trackers.orientation,
        "cameras": cameras.rotation,
        "targets": targets.centre,
        "basic packets": basic,
        "reward packets": reward,
    }
    for name, part in parts.items():
        found.setdefault(name, hashlib.sha256()).update(part.tobytes())
    simulation.reset(result.done)
for name, digest in found.items():
    print(name, digest.hexdigest())
print("rewarded", result.reward.max() > 0.0)
"""

FLOWN = {
    "supervised": False,
    "drag_area": 0.05,
    "motor_time_constant": 0.03,
    "wind": {"speed": 3.0, "turbulence": 4.0},
}


def flown(settings, variables) -> str:
    command = [sys.executable, "-c", FLIES, repr(settings)]
    run = subprocess.run(
        command, env=os.environ | variables, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert "rewarded True" in run.stdout
    return run.stdout


@pytest.mark.slow
@pytest.mark.skipif(not NEWER, reason="this processor has no newer instructions to do without")
@pytest.mark.parametrize("tracker", [{}, FLOWN], ids=["supervised", "flown"])
def test_a_flight_has_the_same_bytes_on_another_processor(tracker):
    settings = {"tracker": tracker, "sensors": {"imu": {"noise": 0.1}}}
    assert flown(settings, OTHER) == flown(settings, {})
