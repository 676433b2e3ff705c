"""Make what a release consists of, after checking all that can be checked on one machine.

    python tools/release.py                 # all checks, then the packages; hours
    python tools/release.py --packages      # the packages alone: minutes
    python tools/release.py --tag 1.0.0     # the release: dates the texts, commits, checks, tags
    python tools/release.py --notes         # prints what the changelog says of this version

It needs the extras `dev`, `docs` and `release`. The packages, a list of their parts (an SBOM in the
form of CycloneDX) and the page as PyPI shows it are written to `dist`. It publishes nothing: the
last line says what to push, after which `.github/workflows/release.yml` does. `--account` fills in
the account on GitHub, once, before the first release.
"""

import argparse
import datetime
import os
import re
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

import pypi_page
from version import REPOSITORY, version

ROOT = Path(__file__).resolve().parents[1]
DIST = ROOT / "dist"
LARGEST_WHEEL = 32.5e6
"""Largest size of the wheel [bytes]; `tests/test_wheel.py` checks it too."""
LARGEST_SDIST = 48e6
"""Largest size of the sdist [bytes]; PyPI takes files of up to 100 MB."""
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


def notes(release: str) -> str:
    """Return what the changelog says of a version, without its heading.

    Raises:
        SystemExit: It says nothing.
    """
    log = (ROOT / "CHANGELOG.md").read_text()
    found = re.search(
        rf"^## {re.escape(release)} [^\n]*\n(.*?)(?=^## |\Z)", log, re.MULTILINE | re.DOTALL
    )
    if not found or not found[1].strip():
        raise SystemExit(f"CHANGELOG.md: has no section of {release}")
    return found[1].strip()


def dated(release: str, day: str, account: str | None) -> None:
    """Write a version and its day into the texts that name it, and commit them.

    Args:
        account: The account on GitHub, where the texts still have `OWNER`.

    Raises:
        SystemExit: The changelog has no section that becomes this version's.
    """
    own = r"^## (Unreleased|[\d.]+ \(in development\))$"
    _replace("CHANGELOG.md", own, f"## {release} - {day}")
    _replace("CITATION.cff", r"^version: .*(\ndate-released: .*)?$", f"version: {release}")
    _replace("CITATION.cff", r"^(version: .*)$", rf'\1\ndate-released: "{day}"')
    _replace("tools/version.py", r"^NEXT = .*$", f'NEXT = "{release}"')
    if account is not None:
        for path in run("git", "grep", "-l", "github.com/OWNER/eyas").split():
            _replace(path, r"github\.com/OWNER/eyas", f"github.com/{account}/eyas")
    run("git", "commit", "-qam", f"Eyas {release}")


def _replace(path: str, pattern: str, text: str) -> None:
    old = (ROOT / path).read_text(encoding="utf-8")
    new, count = re.subn(pattern, text, old, flags=re.MULTILINE)
    if not count:
        raise SystemExit(f"{path}: has no line like {pattern}")
    (ROOT / path).write_text(new, encoding="utf-8")


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
    for package in packages:
        size, limit = package.stat().st_size, LARGEST_WHEEL if package == wheel else LARGEST_SDIST
        if size > limit:
            raise SystemExit(f"{package}: {size / 1e6:.1f} MB; allowed: {limit / 1e6:.1f} MB")
    pypi_page.check(wheel, DIST / f"eyas-{version()}.pypi.html")
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


def packages_of(release: str) -> None:
    """Build the packages, try each, and list their parts."""
    with tempfile.TemporaryDirectory(prefix="eyas-release-") as folder:
        for package in build():
            python = install(package, Path(folder))
        parts = DIST / f"eyas-{release}.cdx.json"
        run("cyclonedx-py", "environment", "--of", "JSON", "-o", parts, python)


def main() -> None:
    """Check and build."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--packages", action="store_true", help="without the checks")
    parser.add_argument("--tag", metavar="VERSION", help="date and commit the texts, and tag")
    parser.add_argument("--account", help="with --tag: the account on GitHub, where OWNER stands")
    parser.add_argument("--notes", action="store_true", help="print the changelog of this version")
    asked = parser.parse_args()
    release = version()
    if asked.notes:
        print(notes(release.partition(".dev")[0]))
        return
    print(f"Eyas {release}")
    if run("git", "status", "--porcelain"):
        raise SystemExit("git: there are changes that are not committed")
    if asked.tag:
        dated(asked.tag, f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}", asked.account)
        # In a process of its own, which reads the texts that were just written.
        again = [sys.executable, __file__, *(["--packages"] if asked.packages else [])]
        run("git", "tag", "-a", f"v{asked.tag}", "-m", f"Eyas {asked.tag}")
        if subprocess.run(again, cwd=ROOT).returncode:
            run("git", "tag", "-d", f"v{asked.tag}")
            raise SystemExit(f"the tag v{asked.tag} is taken back; the commit stays")
        return
    missing = texts_of(release.partition(".dev")[0])
    if missing and ".dev" not in release:
        raise SystemExit("\n".join(missing))
    for command in () if asked.packages else CHECKS:
        run(*command)
    packages_of(release)
    print(*(f"{path.name}: {path.stat().st_size:,} bytes" for path in DIST.iterdir()), sep="\n")
    if ".dev" in release:
        tag = release.partition(".dev")[0]
        print(f"All is well. {release} is in development; to release it:")
        print(f"python tools/release.py --tag {tag}  # it mends:", *missing, sep="\n    ")
    else:
        print(f"git push origin HEAD v{release}  # publishes: .github/workflows/release.yml")


if __name__ == "__main__":
    main()
