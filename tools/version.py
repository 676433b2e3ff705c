"""The version of Eyas, from the tags of git; hatchling asks for it when it builds.

A commit with the tag `v1.2.3` is 1.2.3, the fifth one after it 1.2.4.dev5. An sdist says which it
is; a copy without git, and one in which no tag is known, is the development version of `NEXT`.
"""

import re
import subprocess
from pathlib import Path

NEXT = "1.0.0"
"""The version that is being made, until it has a tag."""
REPOSITORY = "https://github.com/OWNER/eyas"
"""Address of the repository. `OWNER` is filled in before the first release: `tools/release.py`
refuses it. `CITATION.cff` and `.github/ISSUE_TEMPLATE/config.yml` repeat it."""
ROOT = Path(__file__).resolve().parents[1]


def version() -> str:
    """Return the version."""
    packed = ROOT / "PKG-INFO"  # an sdist's
    if packed.exists():
        found = re.search(r"^Version: (.+)$", packed.read_text(), re.MULTILINE)
        if found:
            return found[1]
    return of_description(_described())


def of_description(described: str) -> str:
    """Return the version of what `git describe --tags --long` says; empty: no tag is known."""
    found = re.fullmatch(r"v(\d+)\.(\d+)\.(\d+)((?:a|b|rc)\d+)?-(\d+)-g[0-9a-f]+", described)
    if not found:
        return f"{NEXT}.dev0"
    major, minor, patch, phase, since = found.groups()
    if since == "0":
        return f"{major}.{minor}.{patch}{phase or ''}"
    later = f"{patch}{phase}" if phase else str(int(patch) + 1)
    return f"{major}.{minor}.{later}.dev{since}"


def _described() -> str:
    """Return what git says of this commit, if this folder is the root of its own repository."""
    if not (ROOT / ".git").exists():
        return ""
    command = ("git", "-C", ROOT, "describe", "--tags", "--long", "--match", "v[0-9]*")
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:  # no git on this machine
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


if __name__ == "__main__":
    print(version())
