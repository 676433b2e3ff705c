"""The manifest: hashes of what Eyas computes, the same on every machine."""

import json
from importlib.resources import files
from pathlib import Path

from eyas import __version__
from eyas.core.errors import DataFileError

__all__ = ["Hashes", "manifest_path", "read_manifest", "text_of"]

Hashes = dict[str, dict[str, str]]
"""Of cases by name, of each by the name of what they are of."""


def manifest_path() -> Path:
    """Return the file that comes with the package."""
    return Path(str(files("eyas.modes.verify"))) / "manifest.json"


def read_manifest() -> Hashes:
    """Return the hashes of the manifest.

    Raises:
        DataFileError: The installation is damaged.
    """
    try:
        told: Hashes = json.loads(manifest_path().read_text())["hashes"]
    except (OSError, ValueError, KeyError) as error:
        raise DataFileError(f"{manifest_path()}: missing or damaged; install Eyas again") from error
    return told


def text_of(hashes: Hashes) -> str:
    """Return the content of the file."""
    return json.dumps({"eyas": __version__, "hashes": hashes}, indent=1) + "\n"
