"""The shapes of the models that ship: one file, which `art/catalogue.py` makes.

Its index has all that is known of kinds and models. The blocks have
their arrays; each is read when something of its kind is drawn, or its box is asked for.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.flat import restore
from eyas.engine.mesh.shipped import Block, Meshes, index_of, read_block
from eyas.engine.state.mesh import Mesh
from eyas.engine.targets.kind import KindFacts
from eyas.engine.targets.posing import PoseCall

FILE = Path(__file__).with_name("models.eya")

SHA256 = "e171f3a118de600e677a5a6fa1ea9e0ea68ed977ce8f570cde967bcfb95a87be"
"""Of its index, which has the digests of all arrays: it stands for them in the keys of what is made
of models."""

Columns = dict[str, NDArray[Any]]
"""An array of records, field by field."""


class ShapeArrays(NamedTuple):
    """Where the arrays of a kind are."""

    table: Block  # What poses its parts
    meshes: Block
    extents: Block | None = None  # Boxes of models whose limbs leave that of their size


class ShapeEntry(NamedTuple):
    """A kind in the index."""

    facts: KindFacts
    drives: bool  # Whether it is a vehicle; else it has joints
    shapes: ShapeArrays


class ShapeIndex(NamedTuple):
    """The index."""

    kinds: tuple[
        ShapeEntry, ...
    ]  # Vehicles in the order of `VehicleType`, people, robots, the cyclist
    fliers: dict[str, Block]  # Meshes of the quadrotor and of the bird, whose rigs are their own


@cache
def read_index() -> ShapeIndex:
    """Return the index."""
    return restore(ShapeIndex, index_of(FILE, SHA256), ())


def flier_levels(name: str) -> list[tuple[Mesh, ...]]:
    """Return the meshes of the parts of `quadrotor` or `bird`, the finest first."""
    return read_block(FILE, read_index().fliers[name], Meshes).split()


class ShippedRig:
    """A rig of models that ship.

    Attributes:
        slots: As in `Rig`.
        part_count: As in `Rig`.
        pose: As in `Rig`.

    Args:
        shapes: Where the meshes are.
        table: What the kernel knows of the models, its `slot` of parts first.
        pose: The kernel for one actor, see `PoseCall`.
    """

    def __init__(self, shapes: ShapeArrays, table: Any, pose: Callable[..., None]) -> None:  # noqa: ANN401  # of the kind
        self._meshes = shapes.meshes
        self.slots = table.slot.shape[-1]
        self.part_count = int(table.slot["part"].max()) + 1
        self.pose = PoseCall(table, pose)

    def part_levels(self) -> list[tuple[Mesh, ...]]:
        """Return the meshes of each part, the finest first."""
        return read_block(FILE, self._meshes, Meshes).split()


def records(columns: Columns, dtype: np.dtype[np.void]) -> NDArray[np.void]:
    """Return an array of records of its fields."""
    array = np.zeros(next(iter(columns.values())).shape, dtype)
    for name, column in columns.items():
        array[name] = column
    return array
