"""Settings of the sensors."""

from enum import StrEnum
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from eyas.core.config import Config
from eyas.core.variation import Variation, within

__all__ = ["CameraConfig", "ColourLayout", "Colours"]


class Colours(StrEnum):
    """Channels of a picture."""

    RGB = "rgb"
    GREY = "grey"


class ColourLayout(StrEnum):
    """Order of the axes of a picture."""

    HWC = "hwc"
    CHW = "chw"


class CameraConfig(Config):
    """A pinhole camera without distortion."""

    width: Annotated[int, Field(ge=8, le=8192)] = 320
    """[pixels]"""
    height: Annotated[int, Field(ge=8, le=8192)] = 240
    """[pixels]"""
    field_of_view: Annotated[Variation, AfterValidator(within(0.05, 2.8))] = 0.7854
    """Horizontal [rad]; a variation is drawn anew for each tracker at each reset."""
    samples: Literal[1, 4] = 1
    """Samples per pixel."""
