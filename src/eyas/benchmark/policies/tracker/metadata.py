"""What stands beside a network in its ONNX file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eyas.engine.core.decoding import decoded_json
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.policies.policy import env_config
from eyas.engine.settings.env import EnvConfig

METADATA, TRACKER = "eyas", "eyas.tracker"
"""Keys: changes of the defaults of `env`, and the settings of a tracker."""

OBSERVED = {"parts": ["image", "sensors"], "layout": "chw"}
"""Settings of `env.observation` that trackers and listeners cannot do without; their actions are
velocities."""


def metadata(path: Path, session: Any, key: str) -> Any:  # noqa: ANN401  # whatever JSON holds
    """Return what stands under a key; an empty dictionary: nothing.

    Raises:
        DataFileError: It is not JSON.
    """
    described = session.get_modelmeta().custom_metadata_map.get(key, "{}")
    try:
        return decoded_json(described.encode("utf-8", "surrogateescape"))
    except ValueError as error:
        raise DataFileError(f"{path}: metadata '{key}': not valid JSON") from error


def env_as_trained(path: Path, own: Mapping[str, Any], changes: Mapping[str, Any]) -> EnvConfig:
    """Return what a network that flies by velocities sees and does: as it was trained, but for
    `env.action_repeat` and `env.speeds`.

    Raises:
        EyasError: The user asks for something else, or the file lacks a part.
    """
    made, env = env_config(own), env_config(own, changes)
    if env.actions is not made.actions or env.observation != made.observation:
        raise ConfigError(
            f"env: '{path.stem}' sees and acts as it was trained: only env.action_repeat and "
            "env.speeds may be changed"
        )
    if not set(OBSERVED["parts"]) <= set(made.observation.parts):
        raise DataFileError(f"{path}: the network needs the parts 'image' and 'sensors'")
    return env
