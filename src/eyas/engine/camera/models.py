"""Cameras by their data sheets: settings that `camera.model` puts in the place of defaults.

A model is what its sheet says of light, sensor and link; size and field of view of the picture stay
those of the task. The sheets:

- `small-drone`: a 1/2.3-inch colour sensor, 12 megapixels of 1.55 micrometres behind f/2.8, as in
  most drones below 250 g. Full well of 8,180 electrons, 12 bits, and noise of 3 to 1.5 electrons by
  gain are those that J. Hogan measured of a Sony IMX477 ("Pi HQ Cam Sensor Performance",
  strollswithmydog.com, 2020). Its 1,080 rows of video are read in 20 ms, 50 pictures a second (the
  driver of the Raspberry Pi). Pictures of our size skip photosites: no binning, and one photosite
  of the Bayer mosaic for each pixel. Programs get them as a coded stream.
- `global-shutter`: a grey sensor of 3.45 micrometres with a global shutter, as for machine vision:
  signal to noise of 40.3 dB, dynamic range of 71.3 dB, 12 bits (Sony IMX255 in Matrix Vision's
  manual of the mvBlueFOX3, 20.7). So its well holds 10^(40.3 / 10) = 10,700 electrons, and its
  noise is 10^(71.3 / 20) times less: 2.9.
- `analogue-video`: a 1/4-inch camera on a chip for composite video, 656x492 photosites of 6
  micrometres: signal to noise of 48 dB, dynamic range of 49 dB, fixed pattern of 0.22 % of the
  highest signal (OmniVision OV7950, preliminary data sheet, 2006). So: 63,000 electrons, noise of
  224. Its rows are read in a field of 1/60 s.

What no sheet tells is of the size that is usual for their kinds: quantum efficiency behind filters,
unevenness, dark current when warm, f-numbers, how fast exposure is regulated, how well the stream
is coded.
"""

from collections.abc import Mapping
from typing import Any, Literal

from eyas.engine.core.config import Config, group_of

ModelName = Literal["small-drone", "global-shutter", "analogue-video"]

Values = Mapping[str, Any]

MODELS: dict[ModelName, Values] = {
    "small-drone": {
        "imager": {
            "f_number": 2.8,
            "pixel_pitch": 1.55,
            "quantum_efficiency": (0.40, 0.52, 0.42),
            "full_well": 8180.0,
            "read_noise": 2.2,
            "dark_current": 6.0,
            "dark_nonuniformity": 0.7,
            "gain_nonuniformity": 0.01,
            "row_noise": 0.25,
            "bits": 12,
            "mosaic": "bilinear",
        },
        "exposure": {"time": (1.0 / 8000.0, 1.0 / 60.0), "iso": (100.0, 3200.0)},
        "shutter": {"blur": True, "readout": 0.02},
        "dirt": {"spots": 0},
        "link": {"quality": 70},
    },
    "global-shutter": {
        "spectrum": "grey",
        "imager": {
            "f_number": 2.8,
            "pixel_pitch": 3.45,
            "quantum_efficiency": (0.55, 0.63, 0.50),
            "full_well": 10700.0,
            "read_noise": 2.9,
            "dark_current": 4.0,
            "dark_nonuniformity": 1.0,
            "gain_nonuniformity": 0.008,
            "row_noise": 0.1,
            "bits": 12,
        },
        "exposure": {"time": (2e-5, 0.01), "iso": (100.0, 6400.0), "metering": "average"},
        "shutter": {"blur": True},
    },
    "analogue-video": {
        "imager": {
            "f_number": 2.0,
            "pixel_pitch": 6.0,
            "quantum_efficiency": (0.25, 0.30, 0.22),
            "full_well": 63000.0,
            "read_noise": 224.0,
            "dark_current": 2000.0,
            "dark_nonuniformity": 60.0,
            "gain_nonuniformity": 0.02,
            "row_noise": 30.0,
            "bits": 8,
        },
        "exposure": {"time": (1e-5, 1.0 / 60.0), "iso": (50.0, 1600.0), "speed": 0.2},
        "shutter": {"blur": True, "readout": 1.0 / 60.0},
    },
}
"""Settings of each model, as in a file of settings."""


def laid_under(
    group: type[Config],  # Class of the settings
    under: Values,  # Settings of the model
    given: Values | Config,  # The settings
) -> dict[str, Any]:
    """Return settings, and those of a model wherever they have their defaults."""
    values = dict(given) if isinstance(given, Mapping) else _values_of(given)
    for name, value in under.items():
        field = group.model_fields[name]
        inner, own = group_of(field), values.get(name)
        if inner is not None and isinstance(own, Mapping | Config):
            values[name] = laid_under(inner, value, own)
        elif name not in values or _same(own, field.get_default()):
            values[name] = value
    return values


def without(given: Config, under: Values) -> dict[str, Any]:
    """Return settings that differ from their defaults, without those that are a model's."""
    fields = type(given).model_fields
    values = {
        name: own for name, own in _values_of(given).items() if own != fields[name].get_default()
    }
    for name, value in under.items():
        own = values.get(name)
        if isinstance(value, Mapping) and isinstance(own, Config):
            values[name] = without(own, value)
            if not values[name]:
                del values[name]
        elif name in values and _same(own, value):
            del values[name]
    return values


def _values_of(config: Config) -> dict[str, Any]:
    return {name: getattr(config, name) for name in type(config).model_fields}


def _same(one: object, other: object) -> bool:
    """Return whether two values of settings are the same; a list may stand for a tuple."""
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return list(one) == list(other)
    return one == other
