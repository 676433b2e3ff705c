"""Kinds of things that many maps have."""

from collections.abc import Sequence

from eyas.engine.state.mesh import Material
from eyas.engine.world.build.placed import Placed
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings.cottages import Cottage
from eyas.maps.plan.plan import ThingKind
from eyas.maps.plants.shrubs import PLANTS
from eyas.maps.street.clutter import CLUTTER
from eyas.maps.street.furniture import FURNITURE
from eyas.maps.street.parked_cars import CARS

CAR_KINDS = tuple(ThingKind(name=name, make="parked car", variant=k) for k, name in enumerate(CARS))
CLUTTER_KINDS = tuple(ThingKind(name=name) for name in CLUTTER)
FURNITURE_KINDS = tuple(ThingKind(name=name) for name in FURNITURE)
STREET_KINDS = (ThingKind(name="traffic light"), ThingKind(name="street lamp"))


def plant_kinds(chance: str) -> tuple[ThingKind, ...]:
    """Return borders, hedges and islands, whose shapes share a chance."""
    return tuple(ThingKind(name=name, chance=chance) for name in PLANTS)


def wild_kinds(*makes: str, shapes: int = 2, looks: Sequence[int] = ()) -> tuple[ThingKind, ...]:
    """Return stones or plants that nobody tends, in some different shapes.

    Args:
        makes: What they are, rows of `eyas.maps.things.kinds.THINGS`.
        looks: Looks of each, in place of one look in that many shapes.
    """
    return tuple(
        ThingKind(name=f"{make} {k}", make=make, variant=k)
        for make in makes
        for k in (looks or range(shapes))
    )


def houses(
    cottages: Sequence[Cottage],
    looks: Sequence[tuple[Material, Material]],  # Walls and roof of each look
) -> tuple[tuple[ThingKind, ...], list[Placed]]:
    """Return detached houses: their kinds, and their places."""
    kinds, placed = {}, []
    for house in cottages:
        which = house.look % len(looks)
        walls, roof = looks[which]
        name = f"house of {house.storeys} storeys {which}"
        kinds[name] = ThingKind(
            name=name, make="house", storeys=house.storeys, walls=walls, roof=roof
        )
        placed.append(Placed.at(name, house.place, FLOOR_HEIGHT, house.turn))
    return tuple(kinds.values()), placed
