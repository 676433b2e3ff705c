"""The formats by name."""

from typing import Any

from eyas.core.registry import Registry

__all__ = ["FORMATS", "SETTING"]

SETTING = "--format"

FORMATS: Registry[type[Any]] = Registry(
    SETTING,
    type,
    {
        "coco": "eyas.datasets.formats.coco:Coco",
        "got10k": "eyas.datasets.formats.sot:Got10k",
    },
    group="eyas.formats",
)
"""All formats; a user's own is selected by its path, `my_package.module:Class`."""
