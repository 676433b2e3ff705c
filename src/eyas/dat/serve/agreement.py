"""Comparison of the settings of a server with those that its clients read."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from eyas.dat.wire.config import WireConfig
from eyas.engine.core.config import shown
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import read_settings

__all__ = ["tell_disagreements"]

_LOG = logging.getLogger("eyas")

_CLIENT = Path("Alg_Base", "DAT_Benchmark", "config.json")

_SHARED = ("Tracker_Def", "Control_Frequence", "Train_Total_Steps", "Init_No_Done_Steps")
"""Keys of `env_config.json` that clients read."""

_ALIKE = {
    "port_process": "Config_Agen_Num_Port",
    "Control_Frequence": "Control_Frequence",
    "RewardParams": "Customized_Rewards",
    "CloudPoint": "Lidar_Enable",
}
"""Keys of the clients' `config.json`, and the keys of `env_config.json` that must be equal: with
others, a client is not heard, counts wrongly, or waits for ever."""


def tell_disagreements(config: EyasConfig, root: Path, settings: Path) -> None:
    """Warn of each value in the clients' files that is not that of the server.

    Args:
        config: Settings of the server.
        root: Folder with the original's `Alg_Base`.
        settings: The `env_config.json` that clients read.
    """
    ours = _ours(config)
    for path, keys, group in (
        (settings, {key: key for key in _SHARED}, None),
        (root / _CLIENT, _ALIKE, "Benchmark"),
    ):
        for key, said, served in _differences(path, keys, group, ours):
            _LOG.warning(
                "%s: %s is %s, but is served as %s: clients that read this file go wrong",
                *(path, key, shown(said), shown(served)),
            )


def _differences(
    path: Path, keys: dict[str, str], group: str | None, ours: dict[str, Any]
) -> Iterator[tuple[str, Any, Any]]:
    """Yield key, value in a file and value of the server, where they differ."""
    if not path.exists():
        return
    try:
        values = read_settings(path)
    except EyasError as error:
        _LOG.warning("%s; clients cannot read it either", error)
        return
    inside = values if group is None else values.get(group)
    for key, same in keys.items():
        if isinstance(inside, dict) and key in inside and inside[key] != ours[same]:
            yield key, inside[key], ours[same]


def _ours(config: EyasConfig) -> dict[str, Any]:
    """Return the values of the server by the original's keys."""
    wire, done = WireConfig.of(config), config.done
    return {
        "Tracker_Def": config.tracker.original_name,
        "Control_Frequence": config.control.frequency,
        "Train_Total_Steps": done.total_steps,
        "Init_No_Done_Steps": done.grace_steps,
        "Config_Agen_Num_Port": wire.port,
        "Customized_Rewards": wire.reward_packet,
        "Lidar_Enable": config.lidar.enabled,
    }
