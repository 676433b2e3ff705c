"""Files that a description of a robot names: beside it, in its package, or in Webots' folder."""

import os
import re
from pathlib import Path, PurePosixPath

_HIGHEST = 8  # Number of folders above a file in which a path is looked for
_WEBOTS = re.compile(
    r"webots://|https?://raw\.githubusercontent\.com/cyberbotics/webots/[^/]+/", re.IGNORECASE
)
_SCHEME = re.compile(r"(\w+)://")


def found_file(path: Path, address: str) -> Path | None:
    """Return the file that an address stands for; None if it is not on this machine.

    An address of Webots' own is one in the folder that `WEBOTS_HOME` of the environment names. Of
    `package://`, of other schemes, and of a path of another machine, as much as is there is looked
    for in the folders above the file.

    Args:
        path: The file that names it.
        address: A path, or a URL.
    """
    try:
        return next((one for one in _candidates(path, address) if one.is_file()), None)
    except (OSError, ValueError):  # a name that no file can have
        return None


def _candidates(path: Path, address: str) -> list[Path]:
    if (webots := _WEBOTS.match(address)) is not None:
        home = os.environ.get("WEBOTS_HOME")
        inside = _plain(address[webots.end() :])
        return [Path(home, *inside)] if home and inside else []
    scheme = _SCHEME.match(address)
    if scheme is not None and scheme[1].lower().startswith("http"):
        return []
    rest = address[scheme.end() :] if scheme else address
    first = [] if scheme else [path.parent / rest]
    if scheme is not None and scheme[1].lower() == "file":
        first = [Path("/" + rest.lstrip("/"))]
    parts = _plain(rest)
    folders = [path.parent, *path.absolute().parent.parents][: _HIGHEST + 1]
    for k in range(min(len(parts), 2 * _HIGHEST)):
        # A name alone is looked for beside the file only.
        near = folders if len(parts) - k > 1 else folders[:1]
        first += [folder.joinpath(*parts[k:]) for folder in near]
    return first


def _plain(address: str) -> tuple[str, ...]:
    """Return the parts of a path without those that lead up."""
    parts = PurePosixPath(address.replace("\\", "/")).parts
    return tuple(part for part in parts if part not in ("/", "..", "."))
