"""Make what a release consists of, after checking all that can be checked on one machine.

    python tools/release.py                 # all checks, then the packages; hours
    python tools/release.py --packages      # the packages alone: minutes

It needs the extras `dev`, `docs` and `release`. The packages, and a list of their parts (an SBOM in
the form of CycloneDX), are written to `dist`. It publishes nothing: the last lines say which tag to
push, after which `.github/workflows/release.yml` does.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

from version import REPOSITORY, version

ROOT = Path(__file__).resolve().parents[1]
DIST = ROOT / "dist"
LARGEST_WHEEL = 32.5e6
"""Largest size of the wheel [bytes]; `tests/test_wheel.py` checks it too."""
FIRST = ("video", "--set", "video.channels=1", "--set", "video.total_time=1", "--out", "first")
"""The README's first command, shortened."""
CHECKS: tuple[tuple[str, ...], ...] = (
    ("ruff", "check"),
    ("ruff", "format", "--check"),
    ("python", "tools/spelling.py"),
    ("mypy",),
    ("lint-imports",),
    ("python", "tools/write_docs.py", "--check"),
    ("python", "tools/ship_kernels.py", "--check"),
    ("python", "tools/docs_pictures.py", "--stale"),
    ("eyas", "verify"),
    ("python", "-m", "sphinx", "-W", "-q", "docs", "site"),
    ("python", "-m", "pytest", "-n", "2", "--dist", "loadfile"),
    ("python", "-m", "pytest", "-n", "2", "--dist", "loadfile", "-m", "thorough"),
    ("python", "tools/check_peers.py"),
    ("python", "tools/ci_matrix.py"),
)
PROGRAMS = Path(sys.executable).parent


def run(*command: object, folder: Path = ROOT) -> str:
    """Run a command of this environment; return what it prints.

    Raises:
        SystemExit: It has failed.
    """
    words = [str(word) for word in command]
    print("+", *words, flush=True)
    clean = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    own = PROGRAMS / words[0]
    words[0] = str(own) if own.exists() else words[0]
    done = subprocess.run(words, cwd=folder, env=clean, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"{done.stdout}\ntools/release.py: failed: {' '.join(words)}")
    return done.stdout


def texts_of(release: str) -> list[str]:
    """Return what is not ready for a version in the texts that name it."""
    log, citation = (ROOT / "CHANGELOG.md").read_text(), (ROOT / "CITATION.cff").read_text()
    missing = []
    if not re.search(rf"^## {re.escape(release)} - \d{{4}}-\d\d-\d\d$", log, re.MULTILINE):
        missing.append(f"CHANGELOG.md: has no section '## {release} - YEAR-MONTH-DAY'")
    if re.search(r"^## Unreleased\n+-", log, re.MULTILINE):
        missing.append("CHANGELOG.md: has entries under Unreleased")
    if f"\nversion: {release}\n" not in citation:
        missing.append(f"CITATION.cff: is not of version {release}")
    if f"\nrepository-code: {REPOSITORY}\n" not in citation:
        missing.append(f"CITATION.cff: repository-code is not {REPOSITORY}")
    if "OWNER" in REPOSITORY:
        missing.append("tools/version.py: REPOSITORY still has OWNER in the place of an account")
    return missing


def build() -> list[Path]:
    """Build the sdist, and the wheel from the sdist; return both.

    Raises:
        SystemExit: A package is wrong.
    """
    DIST.mkdir(exist_ok=True)
    for old in DIST.glob("eyas-*"):
        old.unlink()
    run("python", "-m", "build", "--outdir", DIST)  # the wheel from the sdist
    packages = sorted(DIST.glob("eyas-*"), reverse=True)  # the wheel is last
    run("python", "-m", "twine", "check", "--strict", *packages)
    (wheel,) = DIST.glob("*.whl")
    if wheel.stat().st_size > LARGEST_WHEEL:
        raise SystemExit(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB, more than allowed")
    return packages


def install(package: Path, work: Path) -> Path:
    """Install a package into an environment of its own, and record there; return its Python."""
    place = work / package.suffix.strip(".")
    venv.create(place, with_pip=True)
    python = place / "bin/python"
    run(python, "-m", "pip", "install", "-q", package, folder=work)
    said = run(place / "bin/eyas", "--version", folder=work)
    if said.split()[1] != version():
        raise SystemExit(f"{package}: says that it is {said}")
    run(place / "bin/eyas", *FIRST, "--overwrite", "--quiet", folder=work)
    if not (work / "first/DRONE0/episode0/labels.jsonl").exists():
        raise SystemExit(f"{package}: has recorded nothing")
    return python


def main() -> None:
    """Check and build."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--packages", action="store_true", help="without the checks")
    packages_only = parser.parse_args().packages
    release = version()
    print(f"Eyas {release}")
    missing = texts_of(release.partition(".dev")[0])
    if run("git", "status", "--porcelain"):
        missing.append("git: there are changes that are not committed")
    if missing:
        raise SystemExit("\n".join(missing))
    for command in () if packages_only else CHECKS:
        run(*command)
    with tempfile.TemporaryDirectory(prefix="eyas-release-") as folder:
        for package in build():
            python = install(package, Path(folder))
        parts = DIST / f"eyas-{release}.cdx.json"
        run("cyclonedx-py", "environment", "--of", "JSON", "-o", parts, python)
    print(*(f"{path.name}: {path.stat().st_size:,} bytes" for path in DIST.iterdir()), sep="\n")
    if ".dev" in release:
        tag = f"v{release.partition('.dev')[0]}"
        print(f"{release} is in development: tag the commit (git tag -s {tag}) and run this again")
    else:
        print(f"git push origin v{release}  # publishes: .github/workflows/release.yml")


if __name__ == "__main__":
    main()
