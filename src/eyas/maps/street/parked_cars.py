"""Cars that never leave their car parks: part of the scene, not of the traffic.

They ship as data: `art/cars/parked.py` makes them, packed by `python -m art.ship`.
"""

from functools import cache
from pathlib import Path
from typing import NamedTuple

from eyas.engine.core.cache.flat import restore
from eyas.engine.mesh.shipped import Block, Meshes, index_of, read_block
from eyas.engine.world.build.scene_builder import Levels

FILE = Path(__file__).with_name("parked_cars.eya")

SHA256 = "e7e9e974c38717cb68245b1008835486750a9fd818658fce53052c2ff935791c"
"""Of its index, which has the digest of its arrays: it stands for them in the keys of scenes."""

VARIANTS = 32  # Number of kinds of cars; each is as frequent as another

# order: bytes of plans depend on it, which draw an index of `CARS`
CARS = tuple(f"parked car {k}" for k in range(VARIANTS))  # Names of these kinds


class Index(NamedTuple):
    """The index of the file."""

    sizes: tuple[tuple[float, float, float], ...]  # Of the solid shapes of the kinds [m]
    meshes: Block  # Of the kinds, and then of a taxi


def parked_car(variant: int) -> Levels:
    """Return a car, the finest level of detail first.

    It stands on the origin and faces along x; lengths are in metres.

    Args:
        variant: Index in `CARS`.
    """
    return _levels()[variant]


def parked_taxi() -> Levels:
    """Return a yellow taxi, as `parked_car` does."""
    return _levels()[VARIANTS]


def solid_size(variant: int) -> tuple[float, float, float]:
    """Return length, width and height of the solid shape of a kind [m]."""
    return _index().sizes[variant]


@cache
def _index() -> Index:
    return restore(Index, index_of(FILE, SHA256), ())


@cache
def _levels() -> list[Levels]:
    return read_block(FILE, _index().meshes, Meshes).split()
