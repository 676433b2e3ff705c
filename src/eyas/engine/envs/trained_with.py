"""Settings of an environment, written onto its space of actions: libraries save the space with a
model, so that the settings of a policy's training travel with it.
"""

from collections.abc import Mapping
from typing import Any

import gymnasium

from eyas.engine.settings.config import EyasConfig

_KEY = "eyas_settings"
ELSEWHERE = ("control", "start", "camera", "tracker")
"""Groups that a protocol decides, not the policy."""


def describe(space: gymnasium.Space[Any], config: EyasConfig) -> None:
    """Write the settings of an environment onto its space, as JSON values."""
    env = config.env.model_dump(mode="json", exclude={"log_folder", "mixture"})
    groups = {
        name: getattr(config, name).model_dump(mode="json", exclude_defaults=True)
        for name in ELSEWHERE
    }
    space.__dict__[_KEY] = {"env": env, **groups}


def trained_with(space: object) -> Mapping[str, Any]:
    """Return the settings of the environment that a space is of; none if it says nothing."""
    settings = getattr(space, _KEY, {})
    return settings if isinstance(settings, Mapping) else {}
