"""Speed and memory by commit, and whether one commit differs from another beyond noise.

    python bench/history.py record              # this commit, into bench/history (asv's format)
    python bench/history.py compare main HEAD   # two commits in turn; --rounds 9
    python bench/history.py page > history.md   # what is recorded, as a table

Each measurement is a new process (`bench/probe.py`) in a copy of its commit, with a cache of its
own. `compare` runs the two commits in turn, A B B A A B ..., so that whatever else the machine does
meets both alike. A row has changed if the 95 % interval of the median of its ratios leaves out 1.
`asv publish` draws the history, too: `bench/asv.conf.json`.
"""

import argparse
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import comb
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "bench/history"
PROBE = Path(__file__).with_name("probe.py")
UNITS = {"time": "seconds", "peakmem": "bytes"}
Rows = dict[str, float]


class Change(NamedTuple):
    """How a row of B compares with that of A."""

    name: str
    ratio: float
    """Median of B / A."""
    low: float
    """Ends of its interval."""
    high: float

    @property
    def beyond_noise(self) -> bool:
        """Whether the interval leaves out 1."""
        return self.low > 1.0 or self.high < 1.0


def git(*words: str) -> str:
    """Return what git says in this repository."""
    done = subprocess.run(["git", "-C", ROOT, *words], check=True, capture_output=True, text=True)
    return done.stdout.strip()


@contextmanager
def checked_out(commit: str, work: Path) -> Iterator[Path]:
    """Give a copy of a commit, with an empty cache beside it."""
    place = work / commit[:12]
    git("worktree", "add", "--detach", str(place / "tree"), commit)
    try:
        yield place
    finally:
        git("worktree", "remove", "--force", str(place / "tree"))
        shutil.rmtree(place, ignore_errors=True)


def measured(place: Path) -> Rows:
    """Measure a copy of a commit, in a new process."""
    own = {"PYTHONPATH": str(place / "tree/src"), "EYAS_CACHE_DIR": str(place / "cache")}
    own |= {"NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, PROBE], env=os.environ | own, check=True, stdout=subprocess.PIPE, text=True
    )
    rows: Rows = json.loads(done.stdout.splitlines()[-1])
    return rows


def interval(ratios: Sequence[float]) -> tuple[float, float, float]:
    """Return the median and the ends of its 95 % interval, by order statistics.

    The interval from the k-th smallest to the k-th largest of n holds the median with the
    probability 1 - 2 P(X < k), X binomial of n and 1/2. Fewer than six values hold too little.
    """
    ordered, n = sorted(ratios), len(ratios)
    middle = (ordered[(n - 1) // 2] + ordered[n // 2]) / 2
    k = 0
    while sum(comb(n, i) for i in range(k + 1)) / 2**n <= 0.025:
        k += 1
    if k == 0:
        return middle, 0.0, float("inf")
    return middle, ordered[k - 1], ordered[n - k]


def changes(first: Sequence[Rows], second: Sequence[Rows]) -> list[Change]:
    """Compare rounds of A and B, pair by pair."""
    return [
        Change(name, *interval([b[name] / a[name] for a, b in zip(first, second, strict=True)]))
        for name in first[0]
        if name in second[0]
    ]


def compare(first: str, second: str, rounds: int) -> int:
    """Print how the second commit differs from the first; return 1 if a row is beyond noise."""
    found: dict[str, list[Rows]] = {"A": [], "B": []}
    with tempfile.TemporaryDirectory(prefix="eyas-history-") as folder:
        a = checked_out(git("rev-parse", first), Path(folder) / "a")
        b = checked_out(git("rev-parse", second), Path(folder) / "b")
        with a as place_a, b as place_b:
            places = {"A": place_a, "B": place_b}
            for place in places.values():
                measured(place)  # fills the caches
            for number in range(rounds):
                for which in "AB" if number % 2 == 0 else "BA":
                    found[which].append(measured(places[which]))
                print(f"round {number + 1} of {rounds}", file=sys.stderr)
    told = changes(found["A"], found["B"])
    for change in told:
        said = "CHANGED" if change.beyond_noise else "as before"
        print(f"{change.name:28} {change.ratio:6.3f} [{change.low:.3f}, {change.high:.3f}]  {said}")
    return int(any(change.beyond_noise for change in told))


def result(rows: Rows, commit: str, date: int) -> dict[str, object]:
    """Return a commit's results in asv's format, version 2."""
    name = f"python{platform.python_version()}"
    return {
        "commit_hash": commit,
        "env_name": name,
        "date": date * 1000,
        "params": {**machine(), "python": platform.python_version()},
        "python": platform.python_version(),
        "requirements": {},
        "env_vars": {},
        "result_columns": ["result", "params", "version", "started_at", "duration"],
        "results": {
            key: [[value], [], "1", int(time.time() * 1000), None] for key, value in rows.items()
        },
        "durations": {},
        "version": 2,
    }


def machine() -> dict[str, str]:
    """Return what asv wants to know of a machine."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if sys.platform == "linux" else []
    names = [line.partition(": ")[2] for line in lines if line.startswith("model name")]
    cpu = names[0] if names else platform.processor()
    return {
        "machine": cpu.replace(" ", "-").replace("(", "").replace(")", "") or "unknown",
        "arch": platform.machine(),
        "cpu": cpu,
        "num_cpu": str(os.cpu_count()),
        "os": f"{platform.system()} {platform.release()}",
        "ram": "",
    }


def record() -> None:
    """Write the results of this commit."""
    commit = git("rev-parse", "HEAD")
    with tempfile.TemporaryDirectory() as folder, checked_out(commit, Path(folder)) as place:
        measured(place)  # fills the cache
        rows = measured(place)
    write(rows, commit, int(git("show", "-s", "--format=%ct", commit)), FOLDER)


def write(rows: Rows, commit: str, date: int, folder: Path) -> Path:
    """Write results, and what asv needs beside them; return the path of the results."""
    own = folder / machine()["machine"]
    own.mkdir(parents=True, exist_ok=True)
    said = {
        name: {
            **{"name": name, "code": "", "param_names": [], "params": [], "timeout": 60},
            **{"type": name.split("_")[0], "unit": UNITS[name.split("_")[0]], "version": "1"},
        }
        for name in rows
    }
    (folder / "benchmarks.json").write_text(json.dumps(said | {"version": 2}, indent=1) + "\n")
    (own / "machine.json").write_text(json.dumps(machine() | {"version": 1}, indent=1) + "\n")
    path = own / f"{commit[:8]}-python{platform.python_version()}.json"
    path.write_text(json.dumps(result(rows, commit, date), indent=1) + "\n")
    return path


def page(folder: Path) -> str:
    """Return what is recorded as a table, the newest commit first."""
    told = [json.loads(path.read_text()) for path in folder.glob("*/*-python*.json")]
    told.sort(key=lambda one: one["date"], reverse=True)
    names = sorted({name for one in told for name in one["results"]})
    lines = [f"| commit | day | {' | '.join(names)} |", "|---|---|" + "---|" * len(names)]
    for one in told:
        day = time.strftime("%Y-%m-%d", time.gmtime(one["date"] / 1000))
        cells = [_shown(name, one["results"].get(name)) for name in names]
        lines.append(f"| `{one['commit_hash'][:8]}` | {day} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _shown(name: str, row: list[list[float]] | None) -> str:
    if row is None:
        return ""
    value = row[0][0]
    return f"{value / 2**20:.0f} MiB" if name.startswith("peakmem") else f"{value * 1e3:.3f} ms"


def main() -> int:
    """Do what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked = parser.add_subparsers(dest="what", required=True)
    asked.add_parser("record")
    asked.add_parser("page")
    two = asked.add_parser("compare")
    two.add_argument("first")
    two.add_argument("second")
    two.add_argument("--rounds", type=int, default=9)
    said = parser.parse_args()
    if said.what == "compare":
        return compare(said.first, said.second, said.rounds)
    if said.what == "record":
        record()
    else:
        print(page(FOLDER))
    return 0


if __name__ == "__main__":
    sys.exit(main())
