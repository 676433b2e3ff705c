"""A section of the settings that a house brings."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

from eyas.engine.core.config import Config, validated

if TYPE_CHECKING:  # which is made of the sections
    from eyas.engine.settings.config import EngineConfig

Changes = Mapping[str, Any]


class Section(Config):
    """A section of the settings that a house brings (group `eyas.settings` of its door), or a
    package (entry point of that group), whose section lies in `own`: `own.my_package.speed`.
    """

    section: ClassVar[str]
    """Name of the section."""

    @classmethod
    def of(cls, config: "EngineConfig") -> Self:
        """Return this section of settings; that of a package lies in `own`."""
        found = getattr(config, cls.section, None)
        if isinstance(found, cls):
            return found
        return validated(cls, config.own.get(cls.section, {}), f"own.{cls.section}")

    def variants(self, config: "EngineConfig") -> Iterator[tuple[str, Changes]]:
        """Yield changes of the settings under which a run of them flies, too, by their path in this
        section, such as the stages of a curriculum.
        """
        yield from ()

    def alone(self) -> Self:
        """Return the section without its variants."""
        return self
