"""A section of the settings that a house brings."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

from eyas.engine.core.config import Config

if TYPE_CHECKING:  # which is made of the sections
    from eyas.engine.settings.config import EngineConfig

__all__ = ["Changes", "Section"]

Changes = Mapping[str, Any]


class Section(Config):
    """A section of the settings that a house brings (group `eyas.settings` of its door)."""

    section: ClassVar[str]
    """Name of the section."""

    @classmethod
    def of(cls, config: "EngineConfig") -> Self:
        """Return this section of settings."""
        found = getattr(config, cls.section)
        assert isinstance(found, cls)
        return found

    def variants(self, config: "EngineConfig") -> Iterator[tuple[str, Changes]]:
        """Yield changes of the settings under which a run of them flies, too, by their path in this
        section, such as the stages of a curriculum.
        """
        yield from ()

    def alone(self) -> Self:
        """Return the section without its variants."""
        return self
