"""Adds to the wheel what is read from the texts of its files (`eyas.lanes.text_index`), so that a
start need not read them; hatchling calls it, also for a wheel that is made of an sdist.

Nothing is written into the sources: a clone keeps the same in the cache of its user.
"""

import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SOURCE = Path(__file__).resolve().parents[1] / "src"

INDEXES: dict[str, Callable[[bytes], bool]] = {
    "eyas.engine.core.identity.definitions": lambda text: True,
    "eyas.lanes.syntax": lambda text: b"kernel" in text,
}
"""Modules that read texts, and which files of the package they are asked for."""


class BuildHook(BuildHookInterface[Any]):
    """Makes the indexes."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Make them for a wheel; an editable one is a clone."""
        if version == "editable":
            return
        self.folder = TemporaryDirectory(prefix="eyas-indexes-")  # removed at the end
        for path, content in contents().items():
            made = Path(self.folder.name, path.name)
            made.write_bytes(content)
            build_data["force_include"][str(made)] = path.relative_to(SOURCE).as_posix()


def contents() -> dict[Path, bytes]:
    """Return the content of each index, by the path that it has beside the module that reads it."""
    texts = [path.read_bytes() for path in sorted((SOURCE / "eyas").rglob("*.py"))]
    for name in INDEXES:
        _stand_in(name)
    found = {}
    for name, wanted in INDEXES.items():
        index = import_module(name).INDEX
        found[index.shipped] = index.content(filter(wanted, texts))
    return found


def _stand_in(name: str) -> None:
    """Let a module be imported without its packages, which want numba, numpy and pydantic."""
    parts = name.split(".")[:-1]
    for length in range(1, len(parts) + 1):
        package = ".".join(parts[:length])
        if package not in sys.modules:
            sys.modules[package] = ModuleType(package)
            sys.modules[package].__path__ = [str(SOURCE.joinpath(*parts[:length]))]
