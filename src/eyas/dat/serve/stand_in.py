"""A program named `webots`, which starts `eyas serve` for programs that start the original."""

import os
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path, PureWindowsPath

from eyas.dat.settings.entries import WorldPath
from eyas.engine.core.config import shown
from eyas.engine.core.errors import ConfigError, DataFileError, OutputError
from eyas.engine.core.files import refusals, write_atomic

PROGRAM = "webots"

_MARK = "# Made by `eyas webots-shim`: starts Eyas in the place of Webots.\n"
_SIMULATOR = "Webots_Simulation"
_WORLD = WorldPath("the world", "map", "weather")


def install(
    folder: Path, root: Path | None, overrides: Sequence[str], until_idle: float | None = None
) -> Path:
    """Write the program into a folder; return its path.

    Args:
        folder: Made if it does not exist.
        root: The original's folder, with `Webots_Simulation`; None: found at each start.
        overrides: Settings as `key=value`, for each start.
        until_idle: Time without a client after which it ends [s]; None: it does not.

    Raises:
        OutputError: Another program of that name is there, or writing failed.
    """
    path = folder / PROGRAM
    if os.path.lexists(path) and not _is_ours(path):
        raise OutputError(
            f"{path}: another program is there, and stays; name a folder without a '{PROGRAM}'"
        )
    fixed = [word for override in overrides for word in ("--set", override)]
    if root is not None:
        fixed += ["--root", str(root.resolve())]
    if until_idle is not None:
        fixed += ["--until-idle", repr(until_idle)]
    # Without -P, modules of the program's folder would be taken for those of Eyas and others.
    command = [sys.executable, "-P", "-m", "eyas.dat.shim", *fixed, "--"]
    text = f'#!/bin/sh\n{_MARK}exec {shlex.join(command)} "$@"\n'
    with refusals(path):
        folder.mkdir(parents=True, exist_ok=True)
    write_atomic(path, text.encode())
    with refusals(path):
        path.chmod(0o755)
    return path


def serve_arguments(words: Sequence[str], folder: Path, root: Path | None = None) -> list[str]:
    """Return what `eyas serve` is told where Webots is told `words`.

    Args:
        words: Options, which are ignored, and the path of a world file; the file need not exist.
        folder: Where the program was started.
        root: The original's folder; None: the one above the world file, or above `folder`, that
            holds `Webots_Simulation`.

    Raises:
        ConfigError: No world file is named, or one whose name names no map and weather.
        DataFileError: No folder of the original was found.
    """
    worlds = [word for word in words if word.endswith(".wbt")]
    if not worlds:
        raise ConfigError(
            f"{PROGRAM} (Eyas): {shlex.join(words) or 'no argument'} is not allowed; allowed: any "
            "options, and the path of a world such as worlds/citystreet-night.wbt"
        )
    world = worlds[-1]
    told = _WORLD.read({"the world": world})
    if not told:
        raise ConfigError(
            f"{PROGRAM} (Eyas): {shown(world)} names no map and weather; allowed: <map>-<weather>"
            ".wbt, such as citystreet-night.wbt or simpleway-grass_day.wbt"
        )
    chosen = root or _root(folder / _on_this_system(world), folder)
    return ["--root", str(chosen), "--map", str(told["map"]), "--weather", str(told["weather"])]


def _root(world: Path, folder: Path) -> Path:
    """Return the folder that holds the original's simulator."""
    whole = Path(os.path.abspath(world))  # links stay as they are
    for above in (*whole.parents, folder.absolute(), *folder.absolute().parents):
        if (above / _SIMULATOR).is_dir():
            return above
    raise DataFileError(
        f"{whole}: no folder above it holds '{_SIMULATOR}', nor one above {folder}; tell which: "
        "eyas webots-shim --install DIR --root DAT"
    )


def _on_this_system(path: str) -> Path:
    return Path(PureWindowsPath(path).as_posix()) if "\\" in path else Path(path)


def _is_ours(path: Path) -> bool:
    try:
        return _MARK in path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return False
