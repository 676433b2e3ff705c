"""Try Eyas under every Python, with the newest and the oldest packages, as other processors.

    python tools/ci_matrix.py             # all; about 20 minutes on 2 quiet cores
    python tools/ci_matrix.py --list      # what there is to try
    python tools/ci_matrix.py 3.12 oldest # only what has all these words in its name

It installs what it needs: `uv` from PyPI, which finds the oldest packages that `pyproject.toml`
admits, and QEMU by apt. Everything is written to a temporary folder. The last lines say what was
tried, how long it took and what failed; then the exit code is 1.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]

TESTS = (
    "tests/engine/core/cache",
    "tests/engine/core/test_config.py",
    "tests/engine/core/test_registry.py",
    "tests/engine/core/test_variation.py",
    "tests/engine/core/test_exact_everywhere.py",
    "tests/engine/settings",
    "tests/dat/settings",
    "tests/engine/mesh",
    "tests/engine/envs/test_tracking_env.py",
    "tests/engine/exports/test_labels.py",
)
"""Quick tests that a plain install can run: they need no extras."""

TESTERS = (
    *("pytest>=8", "hypothesis>=6.100", "pytest-xdist>=3.6", "jsonschema>=4.20"),
    *("pygame>=2.6; python_version < '3.14'", "pygame-ce>=2.5; python_version >= '3.14'"),
    *("numba>=0.61,<0.70", "llvmlite>=0.44"),  # the extra `compile`, for other processors
)
"""What tests need; installed after a film was recorded without it, by machine code that ships."""

LEFT_OUT = "not (test_each_command_refuses_and_is_told_to_trust_by_a_flag and train)"
"""All but a test that needs the extra `train`."""

SHORT = " --set video.total_time=1 --set video.channels=2"
"""Shortens the README's first command."""

_FOUND = """
import numpy
print(*numpy.show_config(mode="dicts")["SIMD Extensions"].get("found", []))
"""
"""Prints the instructions that numpy has found beyond those that it needs."""

_OLDER_C = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F"

PROCESSORS: dict[str, dict[str, str]] = {
    "this processor, 1 thread": {"NUMBA_NUM_THREADS": "1"},
    "this processor, 2 threads": {"NUMBA_NUM_THREADS": "2"},
    "Nehalem, 5 threads": {
        "NUMBA_NUM_THREADS": "5",
        "NUMBA_CPU_NAME": "nehalem",
        "OPENBLAS_CORETYPE": "Nehalem",
        "NPY_DISABLE_CPU_FEATURES": "all",
        "GLIBC_TUNABLES": _OLDER_C,
    },
    "Haswell, 2 threads": {
        "NUMBA_NUM_THREADS": "2",
        "NUMBA_CPU_NAME": "haswell",
        "OPENBLAS_CORETYPE": "Haswell",
        "NPY_DISABLE_CPU_FEATURES": "AVX-512",
    },
    "SkylakeX, 1 thread": {
        "NUMBA_NUM_THREADS": "1",
        "NUMBA_CPU_NAME": "skylake-avx512",
        "OPENBLAS_CORETYPE": "SkylakeX",
    },
    "old libraries, 1 thread": {
        "NUMBA_NUM_THREADS": "1",
        "OPENBLAS_CORETYPE": "Nehalem",
        "NPY_DISABLE_CPU_FEATURES": "all",
        "GLIBC_TUNABLES": _OLDER_C,
    },
}
"""Each kind of processor that a machine is made to look like, by the libraries' own variables."""

PARTS = (
    ("newest", "3.11", ("Nehalem, 5 threads",)),
    ("newest", "3.12", ("Haswell, 2 threads",)),
    ("newest", "3.13", ("SkylakeX, 1 thread", "old libraries, 1 thread")),
    ("newest", "3.14", ("Haswell, 2 threads",)),
    ("oldest", "3.11", ("old libraries, 1 thread",)),
    ("oldest", "3.12", ("this processor, 1 thread",)),
    ("oldest", "3.13", ("this processor, 2 threads",)),
)
"""Which of them is tried with which packages under which Python: each once, not all by all."""


class Tried(NamedTuple):
    """Something that was tried."""

    name: str
    seconds: float
    fault: str
    """Nothing if it went well."""


class Place(NamedTuple):
    """A copy of the repository with a virtual environment in `.venv`."""

    folder: Path
    cache: Path

    @property
    def python(self) -> Path:
        """The interpreter of the environment."""
        return self.folder / ".venv/bin/python"


def interpreters() -> dict[str, Path]:
    """Return the Pythons that the machine has and Eyas supports, by version."""
    low, high = map(int, re.findall(r'requires-python = ">=3\.(\d+),<3\.(\d+)"', _project())[0])
    found: dict[str, Path] = {}
    for minor in range(low, high):
        name = f"3.{minor}"
        homes = sorted(Path.home().glob(f".pyenv/versions/{name}.*/bin/python"), reverse=True)
        known = shutil.which(f"python{name}")
        for path in [*homes, *([Path(known)] if known else [])]:
            if _output([path, "-c", "import sys; print('%d.%d' % sys.version_info[:2])"]) == name:
                found[name] = path
                break
    return found


def _project() -> str:
    return (ROOT / "pyproject.toml").read_text()


def _output(command: list[object]) -> str:
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def first_command(python: Path) -> str:
    """Return the README's first command, for a Python, shortened."""
    block = re.search(
        r"```sh\n(python3 -m venv .*eyas video .*)\n```", (ROOT / "README.md").read_text()
    )
    assert block, "README.md: where is the first command?"
    return block[1].replace("python3", str(python), 1) + SHORT


def run(
    command: list[object] | str, place: Path, more: Mapping[str, str], limit: float | None = None
) -> str:
    """Run a command; return nothing, or the end of what it printed if it failed.

    One that is not done after a limit [s] counts as skipped.
    """
    clean = {
        key: value
        for key, value in os.environ.items()
        if not key.startswith(("EYAS_", "PYTHONPATH"))
    }
    try:
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", command]
            if isinstance(command, str)
            else [*map(str, command)],
            cwd=place,
            env=clean | dict(more),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
            timeout=limit,
        )
    except subprocess.TimeoutExpired:
        return f"skipped: not done after {limit:.0f} s"
    return "" if done.returncode == 0 else "\n".join(done.stdout.splitlines()[-60:]) or "failed"


def copy_of_tree(folder: Path) -> None:
    """Copy what git knows, changed or not, and what it would add."""
    names = _output(["git", "-C", ROOT, "ls-files", "--cached", "--others", "--exclude-standard"])
    for name in names.splitlines():
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)


def variables(kind: str, place: Place) -> dict[str, str] | None:
    """Return the variables of a kind of processor; None where this one cannot play it."""
    chosen = dict(PROCESSORS[kind])
    flags = Path("/proc/cpuinfo").read_text()
    if "SkylakeX" in kind and "avx512f" not in flags:
        return None
    if "Haswell" in kind and "avx2" not in flags:
        return None
    asked = chosen.get("NPY_DISABLE_CPU_FEATURES")
    if asked:
        found = _output([place.python, "-c", _FOUND]).split()
        newer = [name for name in found if asked == "all" or "512" in name or name == "X86_V4"]
        chosen["NPY_DISABLE_CPU_FEATURES"] = " ".join(newer)
    return chosen


def tries(words: list[str], work: Path) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield what there is to try: a name, and a function that returns what is wrong."""
    known = interpreters()
    for packages, version, kinds in PARTS:
        if version not in known:
            continue
        place = Place(work / f"{version}-{packages}", work / f"cache-{version}-{packages}")
        name = f"Python {version}, {packages} packages"
        todo = [(f"{name}: quick tests", _tests(place))]
        todo += [(f"{name}: eyas verify as {kind}", _verify(place, kind)) for kind in kinds]
        install = f"{name}: install and first command"
        chosen = [(title, each) for title, each in todo if all(word in title for word in words)]
        if chosen or all(word in install for word in words):
            yield install, _installer(packages, known[version], place, work)
        yield from chosen
    if not words or "QEMU" in words:
        yield "QEMU: eyas verify on a Nehalem without AVX", _emulated(work, known)


def _installer(packages: str, python: Path, place: Place, work: Path) -> Callable[[], str]:
    def install() -> str:
        place.folder.mkdir()
        copy_of_tree(place.folder)
        more = {"EYAS_CACHE_DIR": str(place.cache)}
        if packages == "newest":
            return run(first_command(python), place.folder, more) or run(
                [_uv(work), "pip", "install", "-q", "--python", place.python, *TESTERS], work, more
            )
        oldest = ["--resolution", "lowest-direct", "--only-binary", ":all:", "--no-binary", "eyas"]
        add = [_uv(work), "pip", "install", "-q", "--python", place.python, *oldest]
        return (
            run([_uv(work), "venv", "-q", "--python", python, place.folder / ".venv"], work, more)
            or run([*add, place.folder], work, more)
            or run(f".venv/bin/eyas video --out runs/first{SHORT}", place.folder, more)
            or run([*add, *TESTERS], work, more)
        )

    return install


def _uv(work: Path) -> Path:
    """Return the program uv, installed if it is not."""
    path = work / "uv/bin/uv"
    if not path.exists():
        subprocess.run([sys.executable, "-m", "venv", work / "uv"], check=True)
        subprocess.run([work / "uv/bin/pip", "install", "-q", "uv"], check=True)
    return path


def _tests(place: Place) -> Callable[[], str]:
    def test() -> str:
        chosen = [name for name in TESTS if (place.folder / name).exists()]
        more = {"EYAS_CACHE_DIR": str(place.cache)}
        # By the installed package, so what the wheel lacks is missed.
        shutil.rmtree(place.folder / "src", ignore_errors=True)
        return run(
            [
                place.python,
                "-m",
                "pytest",
                "-n",
                "2",
                "-m",
                "not slow and not sumo",
                "-k",
                LEFT_OUT,
                *chosen,
            ],
            place.folder,
            more,
        )

    return test


def _verify(place: Place, kind: str) -> Callable[[], str]:
    def verify() -> str:
        chosen = variables(kind, place)
        if chosen is None:
            return "skipped: this processor cannot play it"
        more = {"EYAS_CACHE_DIR": str(place.cache), **chosen}
        return run([place.python, "-m", "eyas", "verify", "--quick"], place.folder, more)

    return verify


def _emulated(work: Path, known: Mapping[str, Path]) -> Callable[[], str]:
    def verify() -> str:
        if not shutil.which("qemu-x86_64"):
            fault = run("apt-get update -q && apt-get install -yq qemu-user", work, {})
            if fault:
                return fault
        for packages, version, kinds in PARTS:
            place = Place(work / f"{version}-{packages}", work / f"cache-{version}-{packages}")
            if "Nehalem, 5 threads" in kinds and place.python.exists():
                # Kernels that were compiled for it are in the cache: the compiler would take hours.
                more = {"EYAS_CACHE_DIR": str(place.cache), "NUMBA_CPU_NAME": "nehalem"}
                python = [place.python.resolve(), "-m", "eyas", "verify", "--map", SMALLEST]
                more["PYTHONPATH"] = str(next((place.folder / ".venv/lib").glob("*/site-packages")))
                return run(["qemu-x86_64", "-cpu", "Nehalem", *python], place.folder, more, 600.0)
        return "skipped: its Python is missing"

    return verify


SMALLEST = "desert-bare"
"""The map that is built soonest: in QEMU everything takes twenty times as long."""


def main() -> int:
    """Try everything, and print a line for each."""
    words = [word for word in sys.argv[1:] if word != "--list"]
    done: list[Tried] = []
    with tempfile.TemporaryDirectory(prefix="eyas-matrix-") as folder:
        Path(folder).chmod(0o755)  # some tests run as another user
        for name, function in tries(words, Path(folder)):
            if "--list" in sys.argv:
                print(name)
                continue
            print(f"+ {name}", flush=True)
            start = time.monotonic()
            fault = function()
            done.append(Tried(name, time.monotonic() - start, fault))
            if fault:
                print(fault, flush=True)
    for version in sorted({version for _, version, _ in PARTS} - interpreters().keys()):
        print(f"missing: Python {version}, so nothing was tried under it")
    failed = [one for one in done if one.fault and not one.fault.startswith("skipped")]
    for one in done:
        word = "failed" if one in failed else "skipped" if one.fault else "ok"
        print(f"{word:8}{one.seconds:6.0f} s  {one.name}")
    if done:
        print(f"{len(done) - len(failed)} of {len(done)} went well or were skipped")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
