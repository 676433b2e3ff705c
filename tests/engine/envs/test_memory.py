"""The budget of memory: one process, one map."""

import subprocess
import sys

import gymnasium

import eyas  # noqa: F401  # makes the environments known

NAME = "eyas/citystreet-day-v0"
BUDGET = 1 << 30
"""Largest resident memory of a process with one environment [bytes]."""

# `ru_maxrss` would do, but after an exec it still counts what the process had before, which is
# what the tests have: Linux keeps the peak of the program alone here.
PROGRAM = f"""
import re, gymnasium, eyas
env = gymnasium.make("{NAME}")
env.reset(seed=1)
for action in range(6):
    env.step(action)
print(1024 * int(re.search(r"VmHWM:\\s+(\\d+) kB", open("/proc/self/status").read())[1]))
"""


def test_a_process_with_one_environment_stays_within_its_memory():
    gymnasium.make(NAME).reset(seed=1)  # compiles and fills the caches, once for each version
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True
    )
    peak = int(done.stdout)
    assert 100 << 20 < peak < BUDGET, f"{peak / 2**20:.0f} MiB"
