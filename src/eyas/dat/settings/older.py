"""Keys and values of older versions of the original's `env_config.json`."""

import logging
from collections.abc import Mapping
from typing import Any

from eyas.dat.settings.layout import Nested

__all__ = ["renewed"]

_LOG = logging.getLogger("eyas")

_RENAMED = {
    ("Reward_Config", "reward_range"): (
        "distance_range",
        "that version had the reward_type 'distance' only, which is 'view' unless it is given",
    ),
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
