"""Variants of a car's body: others of the same model, size and words, as streets show them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from eyas.engine.world.cars.shape import CarShape

_VARIANTS: Mapping[str, tuple[dict[str, Any], ...]] = {
    "saloon": (
        {"bodywork": "saloon_sunroof"},
        {"bodywork": "saloon_worn"},
        {"bodywork": "saloon_worn", "dark_bumpers": True},
    ),
    "hatch": (
        {"bodywork": "hatch_sunroof", "rack": False},
        {"bodywork": "hatch_worn", "dark_bumpers": True, "rack": False},
        {"bodywork": "hatch_sunroof", "rack": True},
    ),
    "van": (
        {"dark_bumpers": False, "rack": True},
        {"bodywork": "van_worn", "rack": True},
    ),
}
"""What each further body of a kind of bodywork has that the first has not."""


def variants_of(shape: CarShape) -> tuple[CarShape, ...]:
    """Return the shapes of the further bodies of a car."""
    return tuple(replace(shape, **changes) for changes in _VARIANTS.get(shape.bodywork, ()))
