"""The root of all settings: those of the engine, and the sections that houses bring."""

from collections.abc import Iterator
from enum import StrEnum
from importlib import import_module
from typing import TYPE_CHECKING, Any, Self

from pydantic import Field, create_model, model_validator

from eyas.engine.core.config import updated, validated
from eyas.engine.core.doors import brought, brought_object, installed
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.settings.env import EnvConfig
from eyas.engine.settings.section import Changes, Section
from eyas.engine.settings.video import VideoConfig
from eyas.engine.sim.config import SimConfig

__all__ = ["EngineConfig", "EyasConfig", "Mode", "variants"]

Value = bool | int | float | str | tuple[float, ...]


class Mode(StrEnum):
    """Intended use of a configuration; the original's `Simulation_Mode`."""

    DEMO = "demo"
    VIDEO = "video"
    TRAIN = "train"


class EngineConfig(SimConfig):
    """Settings of the simulation, of environments and of recordings."""

    mode: Mode = Mode.VIDEO
    """Intended use of the configuration."""
    verbose: bool = False
    """Whether each step is logged in the original's words: by `eyas video` in `<tracker>.log`
    beside `dir_info.json`, by `eyas serve` in the original's `logs/Agent<i>.log`, by environments
    to Python's logger `eyas.steps` (show it with `logging.basicConfig()`) and to
    `env.log_folder`. Each episode that ends is one line of the logger `eyas`."""
    env: EnvConfig = EnvConfig()
    video: VideoConfig = VideoConfig()
    own: dict[str, dict[str, Any]] = {}  # noqa: RUF012  # pydantic copies it
    """Sections of packages of others, by the names of their entry points in `eyas.settings`."""
    if TYPE_CHECKING:
        original: dict[str, Value] | None = None  # a field of the whole, below: last in files

    @model_validator(mode="after")
    def _gimbal_there(self) -> Self:
        if self.env.actions.gimbal and self.camera.mount is not None:
            raise ValueError(
                "env.actions must be without '+gimbal': camera.mount fixes the camera to the body"
            )
        return self

    @model_validator(mode="after")
    def _check_own(self) -> Self:
        for name, values in self.own.items():
            section = brought_object("eyas.settings", name)
            if section is None or name in brought("eyas.settings"):
                raise UnknownNameError("own", name, tuple(installed("eyas.settings")))
            validated(section, values, f"own.{name}")
        return self

    @model_validator(mode="after")
    def _check_variants(self) -> Self:
        for _ in variants(self):
            pass
        return self


_ORIGINAL = (
    "Values of the original's `env_config.json` that no other setting holds, such as those whose "
    "switch is off: they are written back with it. None if the settings do not come from such a "
    "file."
)


def _sections() -> dict[str, Any]:
    """Return the fields of the sections by name."""
    fields: dict[str, Any] = {}
    for name, place in brought("eyas.settings").items():
        module, _, attribute = place.partition(":")
        section = getattr(import_module(module), attribute)
        fields[name] = (section, section())
    return fields


if TYPE_CHECKING:

    class EyasConfig(EngineConfig):
        """All settings of a run: `EngineConfig`, and a `Section` of each house."""
else:
    EyasConfig = create_model(
        "EyasConfig",
        __base__=EngineConfig,
        __module__=__name__,
        __doc__="All settings of a run.",
        **_sections(),
        original=(dict[str, Value] | None, Field(None, description=_ORIGINAL)),
    )


def variants(config: EngineConfig) -> Iterator[tuple[str, "EyasConfig"]]:
    """Yield the settings of each kind of a mixture and of each variant of a section, by their path.

    Mixture and variants themselves are left out of them.

    Raises:
        ConfigError: Some of them are wrong: one line.
    """
    assert isinstance(config, EyasConfig)
    every = (getattr(config, name) for name in type(config).model_fields)
    sections = [part for part in every if isinstance(part, Section)]
    parts: list[tuple[str, Changes]] = [
        (f"env.mixture.{at}", part.settings) for at, part in enumerate(config.env.mixture)
    ]
    for section in sections:
        of_section = section.variants(config)
        parts += ((f"{section.section}.{path}", changes) for path, changes in of_section)
    if not any(settings for _, settings in parts):
        return
    env = config.env.model_copy(update={"mixture": ()})
    alone: dict[str, Any] = {section.section: section.alone() for section in sections}
    common = config.model_copy(update={"env": env, **alone})
    for path, settings in parts:
        try:
            variant = updated(common, settings)
        except ConfigError as error:
            raise ConfigError(f"{path}.settings.{error}") from None
        yield f"{path}.settings", variant
