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
        "lerobot": "eyas.datasets.formats.lerobot:LeRobot",
        "webdataset": "eyas.datasets.formats.shards:WebDataset",
        "minari": "eyas.datasets.formats.minari:Minari",
        "rerun": "eyas.datasets.formats.rerun:Rerun",
        "mcap": "eyas.datasets.formats.mcap:Mcap",
        "got10k": "eyas.datasets.formats.sot:Got10k",
    },
    group="eyas.formats",
)
"""All formats; a user's own is selected by its path, `my_package.module:Class`."""
