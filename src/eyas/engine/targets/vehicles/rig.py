"""The rig of vehicles: a body, wheels that roll and steer, and a trailer that swings."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.shipped import read_block
from eyas.engine.targets.shapes import FILE, Columns, ShapeArrays, ShippedRig, records
from eyas.engine.targets.vehicles.pose import AXLES, SLOT, VEHICLE_AHEAD, RigTable, pose_vehicle


class VehicleArrays(NamedTuple):
    """A `RigTable` as it ships."""

    slot: Columns
    axles: Columns


class VehicleRig(ShippedRig):
    """The rig of the models of one kind of vehicle."""

    def __init__(self, shapes: ShapeArrays) -> None:
        arrays = read_block(FILE, shapes.table, VehicleArrays)
        table = RigTable(records(arrays.slot, SLOT), records(arrays.axles, AXLES))
        super().__init__(shapes, table, pose_vehicle)
        self._slots = table.slot

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point of a vehicle may be from its reference point, see `Rig` [m]."""
        slot = self._slots[self._slots["part"] >= 0]
        offset = np.sqrt(np.square(slot["x"]) + np.square(slot["y"]) + np.square(slot["z"]))
        return abs(VEHICLE_AHEAD) + float((offset + parts[slot["part"]]).max())
