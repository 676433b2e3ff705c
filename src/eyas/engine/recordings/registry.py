"""The formats by name."""

from typing import Any

from eyas.engine.core.registry import Registry

__all__ = ["FORMATS", "SETTING"]

SETTING = "--format"

FORMATS: Registry[type[Any]] = Registry(
    SETTING,
    type,
    group="eyas.formats",
)
"""All formats; a user's own is selected by its path, `my_package.module:Class`."""
