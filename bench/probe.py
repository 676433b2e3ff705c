"""Measure a few rows in this process, and print them as JSON: run by `bench/history.py`.

It uses public names only, so that it measures earlier and later commits alike. Times are those of
the processor, all threads together.
"""

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable

import eyas

VIEWS, ROUNDS = 16, 5


def median_of(action: Callable[[], object], repeats: int) -> float:
    """Return the median CPU time of an action [s], after one that is not counted."""
    action()
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        for _ in range(repeats):
            action()
        times.append((time.process_time() - start) / repeats)
    return sorted(times)[ROUNDS // 2]


def child(*words: str) -> float:
    """Return the CPU time of a Python process [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *words], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print the rows."""
    rows = {
        "time_import": min(child("-c", "import eyas") for _ in range(3)),
        "time_help": min(child("-m", "eyas", "--help") for _ in range(3)),
    }
    envs = eyas.make_vec("citystreet-day", num_envs=VIEWS)
    envs.reset(seed=1)
    still = [0] * VIEWS
    rows["time_step_with_picture"] = median_of(lambda: envs.step(still), 20) / VIEWS
    rows["time_reset_with_picture"] = median_of(lambda: envs.reset(seed=1), 5) / VIEWS
    envs.close()
    blind = {"parts": ["sensors"]}
    envs = eyas.make_vec("citystreet-day", num_envs=VIEWS, observation=blind)
    envs.reset(seed=1)
    rows["time_step_without_picture"] = median_of(lambda: envs.step(still), 200) / VIEWS
    envs.close()
    rows["peakmem_all"] = float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
    print(json.dumps(rows))


if __name__ == "__main__":
    main()
