"""The groups and keys of an `env_config.json`, of older versions too, and targets of one's own."""

import json
import logging
import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from eyas.dat.settings.entries import OriginalEntry, Values
from eyas.engine.core.config import Problem, shown, unknown_keys
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.custom.config import ENDINGS
from eyas.engine.targets.config import TargetName

Nested = Mapping[str, Any]  # The content of a JSON object

_LOG = logging.getLogger("eyas")

_RENAMED = {
    ("Reward_Config", "reward_range"): (
        "distance_range",
        "that version had the reward_type 'distance' only, which is 'view' unless it is given",
    )
}
"""Keys in groups, their names in the present version, and a remark."""

_REMOVED = {"Sumo_Random_Mode": "routes are drawn as by its mode 2, the recommended one"}
"""Keys of the top level that the present version does without."""

_VALUES = {("Sumo_Params", "car_type", "private"): "passenger"}
"""Values of keys in groups, and their names in the present version."""


def renewed(values: Nested) -> dict[str, Any]:
    """Return the content of an `env_config.json` in the words of the present version.

    A line in the log names each key and value that is of an older one.
    """
    new = {
        key: dict(value) if isinstance(value, Mapping) else value for key, value in values.items()
    }
    for key in _REMOVED.keys() & new.keys():
        del new[key]
        _LOG.warning("%s: a key of older versions, left out: %s", key, _REMOVED[key])
    for (group, old), (name, remark) in _RENAMED.items():
        if (inner := _group(new, group)) is None or old not in inner:
            continue
        value = inner.pop(old)
        if name in inner:
            _LOG.warning("%s.%s: left out beside %s, its present name", group, old, name)
            continue
        inner[name] = value
        _LOG.warning("%s.%s: the older name of %s, read as such; %s", group, old, name, remark)
    for (group, key, old), name in _VALUES.items():
        if (inner := _group(new, group)) is not None and inner.get(key) == old:
            inner[key] = name
            _LOG.warning("%s.%s: '%s' is the older name of '%s'", group, key, old, name)
    return new


def _group(values: Nested, name: str) -> dict[str, Any] | None:
    group = values.get(name)
    return group if isinstance(group, dict) else None


_COUNTS = "_Steps"  # End of the keys of numbers of steps, which may be written as 1500.0 too.


@cache
def original_defaults() -> Nested:
    """Return the values that keys have if a file does not contain them."""
    values: dict[str, Any] = json.loads(
        files("eyas.dat.settings").joinpath("defaults.json").read_text()
    )
    return values


def every_key() -> dict[str, object]:
    """Return the values of all keys if a file contains none of them."""
    return flat(original_defaults())


def flat(values: Nested) -> dict[str, object]:
    """Return values by dotted path.

    Raises:
        ConfigError: Keys that the original does not have, or a value that should be a group.
    """
    defaults = original_defaults()
    if unknown := unknown_keys(_unknown(values)):
        raise unknown.error()
    by_path: dict[str, object] = {}
    for key, value in values.items():
        known = defaults[key]
        if not isinstance(known, Mapping):
            by_path[key] = _whole(value) if key.endswith(_COUNTS) else value
            continue
        if not isinstance(value, Mapping):
            raise Problem((key,), value, f"an object with {', '.join(known)}").error()
        by_path |= {f"{key}.{inner}": inner_value for inner, inner_value in value.items()}
    return by_path


def _unknown(values: Nested) -> list[Problem]:
    """Return a problem for each key that the original does not have."""
    defaults = original_defaults()
    unknown: list[tuple[tuple[str, ...], Nested]] = [
        ((key,), defaults) for key in values if key not in defaults
    ]
    for group, known in defaults.items():
        inside = values.get(group)
        if isinstance(known, Mapping) and isinstance(inside, Mapping):
            unknown += [((group, key), known) for key in inside if key not in known]
    return [Problem(path, None, "", tuple(known), unknown_key=True) for path, known in unknown]


def nested(by_path: Values) -> dict[str, Any]:
    """Return values by dotted path as groups; also those of our settings."""
    groups: dict[str, Any] = {}
    for path, value in by_path.items():
        *above, name = path.split(".")
        inner = groups
        for group in above:
            inner = inner.setdefault(group, {})
        inner[name] = value
    return groups


def check_kinds(entry: OriginalEntry, values: Values, *, idle: bool = False) -> None:
    """Refuse switches and numbers of a wrong type.

    A key for one field is checked by that field, unless the entry has no effect (`idle`).
    """
    for key in entry.keys:
        if isinstance(values[key], Mapping) and isinstance(every_key()[key], str):
            allowed = f"a name; more than one: {', '.join(entry.paths)}"
            raise Problem((key,), values[key], allowed).error()
    if len(entry.keys) == 1 and not idle:
        return
    for key in entry.keys:
        value, default = values[key], every_key()[key]
        if isinstance(default, bool):
            fits, allowed = isinstance(value, bool), "true or false"
        elif isinstance(default, list):
            fits, allowed = _are_numbers(value, len(default)), f"a list of {len(default)} numbers"
        else:
            fits, allowed = _is_number(value), "a number"
        if not fits:
            raise Problem((key,), value, allowed).error()


def _whole(value: object) -> object:
    """Return 1500.0 as 1500."""
    whole = isinstance(value, float) and value.is_integer() and abs(value) < 2**53
    return int(value) if whole and isinstance(value, float) else value


def _is_number(value: object) -> bool:
    """Return whether a JSON value is a finite number, not a truth value."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) < 1e308


def _are_numbers(value: object, count: int) -> bool:
    return isinstance(value, list) and len(value) == count and all(map(_is_number, value))


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
    values: Nested,  # Keys of the original, and perhaps `custom`
    folders: Sequence[Path],  # Where to look for files, in this order
) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Return the original's keys without a name that it does not know, and what that name means.

    A name that is not a kind of target is that of the settings `custom` beside it, or of files in
    one of the folders: `<name>.proto` or a mesh, `<name>.csv`, or both. No code is looked for.

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
        raise _not_a_target(name, looked)
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


def _not_a_target(name: str, looked: str) -> UnknownNameError:
    error = UnknownNameError(_KEY, name, [known.value for known in TargetName])
    endings = ", ".join((*ENDINGS, _TRAJECTORY))
    error.args = (
        f'{error}; or a target of your own: settings "{CUSTOM}" beside it, or a file of that name '
        f"({endings}) in {looked}",
    )
    return error
