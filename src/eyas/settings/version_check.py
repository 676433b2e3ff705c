"""Refusal of settings that need a part that is not in this version yet."""

from collections.abc import Iterator

from eyas.settings.config import EyasConfig
from eyas.settings.legacy.adapter import legacy_key_of
from eyas.sim.supported import Missing, missing_parts

__all__ = ["require_supported"]


def require_supported(config: EyasConfig) -> None:
    """Refuse settings that need a part that this version does not have.

    A simulation also refuses them; here, the error names the setting in both notations. Maps and
    weathers are refused when they are looked up.

    Raises:
        NotInThisVersionError: One line that names the setting, in both notations.
    """
    for missing in _missing(config):
        raise missing.error(legacy_key_of(missing.path))


def _missing(config: EyasConfig) -> Iterator[Missing]:
    yield from missing_parts(config)
    if config.wire.lidar:
        yield Missing("wire.lidar", value=True, part="the lidar")
