"""Refusal of settings that need a part that is not in this version yet."""

from eyas.settings.config import EyasConfig
from eyas.settings.legacy.adapter import legacy_key_of
from eyas.sim.supported import missing_parts

__all__ = ["require_supported"]


def require_supported(config: EyasConfig) -> None:
    """Refuse settings that need a part that this version does not have.

    A simulation also refuses them; here, the error names the setting in both notations. Maps and
    weathers are refused when they are looked up.

    Raises:
        NotInThisVersionError: One line that names the setting, in both notations.
    """
    for missing in missing_parts(config):
        raise missing.error(legacy_key_of(missing.path))
