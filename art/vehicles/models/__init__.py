"""The models of vehicles: a file for each, which holds all that is known of it as `MODEL`.

Sizes are the overall sizes of the original's simplified vehicle models. Masses are those of such
vehicles, empty. A new file needs no line anywhere; it changes what is drawn at random, and so
every episode.
"""

from importlib import import_module
from pkgutil import iter_modules

from art.vehicles.vehicle import VehicleModel

__all__ = ["VEHICLES"]

_ORDER = (
    *("bmw_x5", "citroen_c_zero", "toyota_prius", "lincoln_mkz", "range_rover", "tesla_model_3"),
    *("mercedes_sprinter", "bus", "truck", "truck_box", "truck_tank", "scooter", "motorbike"),
)
"""Files of the first models: their indices are in recordings, and in what is drawn at random."""


def _read() -> tuple[VehicleModel, ...]:
    later = sorted({module.name for module in iter_modules(__path__)} - {*_ORDER})
    return tuple(import_module(f"{__name__}.{file}").MODEL for file in (*_ORDER, *later))


VEHICLES: tuple[VehicleModel, ...] = _read()
"""All models of vehicles: those of `_ORDER`, then others by the names of their files."""
