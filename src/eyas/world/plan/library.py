"""Kinds of things that many maps have."""

from eyas.world.plan.plan import Kind
from eyas.world.plants.shrubs import PLANTS
from eyas.world.street.furniture import FURNITURE
from eyas.world.street.parked_cars import CARS

__all__ = ["CAR_KINDS", "FURNITURE_KINDS", "STREET_KINDS", "plant_kinds"]

CAR_KINDS = tuple(Kind(name=name, make="parked car", variant=k) for k, name in enumerate(CARS))
FURNITURE_KINDS = tuple(Kind(name=name) for name in FURNITURE)
STREET_KINDS = (Kind(name="traffic light"), Kind(name="street lamp"))


def plant_kinds(chance: str) -> tuple[Kind, ...]:
    """Return borders, hedges and islands, whose shapes share a chance."""
    return tuple(Kind(name=name, chance=chance) for name in PLANTS)
