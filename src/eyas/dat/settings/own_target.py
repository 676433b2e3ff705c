"""Targets of one's own, named in the original's `Tracking_Object` as its manual says."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from eyas.dat.settings.layout import Nested
from eyas.engine.core.config import shown
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.custom.config import ENDINGS
from eyas.engine.targets.config import TargetName

CUSTOM = "custom"  # Key of ours in the original's file: settings of a target of one's own

_KEY = "Tracking_Object"
_TRAJECTORY = ".csv"


def own_target_folders(file: Path | None) -> tuple[Path, ...]:
    """Return the folders that may hold shapes and trajectories, for settings in a file.

    They are the original's `protos`, the folder of the file, and the current one with its
    `targets`.
    """
    here = (Path("targets"), Path())
    if file is None:
        return here
    return (file.parent.parent / "protos", file.parent, *here)


def with_own_target(
    values: Nested, folders: Sequence[Path]
) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Return the original's keys without a name that it does not know, and what that name means.

    A name that is not a kind of target is that of the settings `custom` beside it, or of files in
    one of the folders: `<name>.proto` or a mesh, `<name>.csv`, or both. No code is looked for.

    Args:
        values: Keys of the original, and perhaps `custom`.
        folders: Where to look for files, in this order.

    Returns:
        The keys, and the settings `custom`; None if there are none.

    Raises:
        ConfigError: The name is that of nothing.
    """
    rest = {key: value for key, value in values.items() if key != CUSTOM}
    custom, name = values.get(CUSTOM), rest.get(_KEY)
    if custom is not None and not isinstance(custom, dict):
        raise ConfigError(f"{CUSTOM}: {shown(custom)} is not allowed: an object")
    if not isinstance(name, str) or name in list(TargetName):
        return rest, custom
    found = custom or _found(name, folders)
    if found is None:
        looked = ", ".join(str(folder) for folder in dict.fromkeys(folders))
        raise _unknown(name, looked)
    rest[_KEY] = TargetName.PEDESTRIAN.value  # as no vehicle drives where an object is followed
    return rest, found


def _found(name: str, folders: Sequence[Path]) -> dict[str, Any] | None:
    """Return the settings of files of that name in the first folder that has some."""
    if not re.fullmatch(r"\w[\w .+-]{0,99}", name):
        return None
    for folder in folders:
        shapes = [
            folder / f"{name}{ending}"
            for ending in sorted(ENDINGS, key=lambda ending: ending != ".proto")
        ]
        shape = next((path for path in shapes if path.is_file()), None)
        track = folder / f"{name}{_TRAJECTORY}"
        made: dict[str, Any] = {} if shape is None else {"mesh": str(shape)}
        if track.is_file():
            made["trajectory"] = str(track)
        if made:
            return made
    return None


def _unknown(name: str, looked: str) -> UnknownNameError:
    error = UnknownNameError(_KEY, name, [known.value for known in TargetName])
    endings = ", ".join((*ENDINGS, _TRAJECTORY))
    error.args = (
        f'{error}; or a target of your own: settings "{CUSTOM}" beside it, or a file of that name '
        f"({endings}) in {looked}",
    )
    return error
