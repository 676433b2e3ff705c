"""Cars that never leave their car parks, and bicycles: part of the scene, not of the traffic.

They ship as data: `art/cars/parked.py` makes them, packed by `python -m art.ship`.
"""

from functools import cache
from pathlib import Path
from typing import NamedTuple

from eyas.engine.core.cache.flat import restore
from eyas.engine.mesh.shipped import Block, Meshes, index_of, read_block
from eyas.engine.world.build.scene_builder import Levels

FILE = Path(__file__).with_name("parked_cars.eya")

SHA256 = "ac39b5bd0d724b5f6b94a6d7fd4dee8ea3f4a78bd6c63c44fc0d63e1abef1476"
"""Of its index, which has the digest of its arrays: it stands for them in the keys of scenes."""

VARIANTS = 32  # Number of kinds of cars; each is as frequent as another

# order: bytes of plans depend on it, which draw an index of `CARS`
CARS = tuple(f"parked car {k}" for k in range(VARIANTS))  # Names of these kinds


class ParkedIndex(NamedTuple):
    """The index of the file."""

    sizes: tuple[tuple[float, float, float], ...]  # Of the solid shapes of the kinds [m]
    cars: Block  # Meshes of the kinds, and then of a taxi
    bicycles: Block


def parked_car(
    variant: int,  # Index in `CARS`
) -> Levels:
    """Return a car, the finest level of detail first.

    It stands on the origin and faces along x; lengths are in metres.
    """
    return _levels()[variant]


def parked_taxi() -> Levels:
    """Return a yellow taxi, as `parked_car` does."""
    return _levels()[VARIANTS]


def solid_size(variant: int) -> tuple[float, float, float]:
    """Return length, width and height of the solid shape of a kind [m]."""
    return _index().sizes[variant]


def bicycle_levels(which: int) -> Levels:
    """Return a parked bicycle, one after the other in another paint, as `parked_car` does."""
    bicycles = _bicycles()
    return bicycles[which % len(bicycles)]


@cache
def _index() -> ParkedIndex:
    return restore(ParkedIndex, index_of(FILE, SHA256), ())


@cache
def _levels() -> list[Levels]:
    return read_block(FILE, _index().cars, Meshes).split()


@cache
def _bicycles() -> list[Levels]:
    return read_block(FILE, _index().bicycles, Meshes).split()
