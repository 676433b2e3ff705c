"""The way in which Eyas was installed, from which the command for a missing extra follows."""

import json
import shlex
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution, version
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

_CLONE = Path(__file__).parents[4]


@cache
def installed_version() -> str:
    """Return the version of this Eyas; "0" in a folder that is not installed."""
    try:
        return version("eyas")
    except PackageNotFoundError:
        return "0"


def install_command(extra: str) -> str:
    """Return the command that installs an extra of Eyas from where Eyas itself has come.

    From an index of packages, by its name; from a clone, a file or a repository, by its place.
    """
    origin = _origin()
    url = urlsplit(str(origin.get("url", "")))
    path = Path(unquote(url.path))
    if "vcs_info" in origin:
        kind = origin["vcs_info"].get("vcs", "git")
        commit = origin["vcs_info"].get("commit_id", "")
        requirement = f"eyas[{extra}] @ {kind}+{origin['url']}@{commit}"
    elif url.scheme == "file" and path.is_dir():
        requirement = f"{path}[{extra}]"
    elif url.scheme in ("file", "http", "https"):
        requirement = f"eyas[{extra}] @ {origin['url']}"
    else:
        requirement = f"eyas[{extra}]"
    quoted = shlex.quote(requirement)
    return f"pip install {'-e ' * _editable(origin)}{quoted}"


def _origin() -> dict[str, Any]:
    """Return what the installer has noted (PEP 610); nothing where it came from an index."""
    try:
        noted = json.loads(distribution("eyas").read_text("direct_url.json") or "{}")
    except PackageNotFoundError:  # its sources are used where they lie
        if (_CLONE / "pyproject.toml").is_file():
            return {"url": _CLONE.as_uri(), "dir_info": {"editable": True}}
        return {}
    except ValueError:
        return {}
    return noted if isinstance(noted, dict) else {}


def _editable(origin: dict[str, Any]) -> bool:
    return bool(origin.get("dir_info", {}).get("editable", False))
