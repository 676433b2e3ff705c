"""Refusal of settings of a simulation that need a part missing from this version."""

from collections.abc import Iterator
from dataclasses import dataclass

from eyas.core.config import shown
from eyas.core.errors import NotInThisVersionError
from eyas.sim.config import SimConfig

__all__ = ["Missing", "missing_parts", "require_parts"]


@dataclass(frozen=True, slots=True)
class Missing:
    """A setting that needs a part that this version does not have."""

    path: str
    """Dotted path of the setting."""
    value: object
    """Value of the setting."""
    part: str
    """The part that is missing, in words."""

    def error(self, other_name: str = "") -> NotInThisVersionError:
        """Return the error to raise, with the setting's name in another notation if given."""
        also = f" ({other_name})" if other_name else ""
        return NotInThisVersionError(
            f"{self.path}{also}: {shown(self.value)}: {self.part} is not in this version yet"
        )


def require_parts(config: SimConfig) -> None:
    """Refuse settings that need a part that this version does not have.

    Maps and weathers are refused when they are looked up.

    Raises:
        NotInThisVersionError: One line that names the setting.
    """
    for missing in missing_parts(config):
        raise missing.error()


def missing_parts(config: SimConfig) -> Iterator[Missing]:
    """Yield the settings of a simulation that need a part that this version does not have."""
    yield from ()
