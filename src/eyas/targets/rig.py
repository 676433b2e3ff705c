"""Rigs: where the parts of every vehicle are, from where it is and how far it has driven."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.state.draw import DrawList, PartLibrary
from eyas.state.mesh import Mesh
from eyas.state.motion import ActorState
from eyas.targets.catalogue import VEHICLES, Axle, VehicleModel, models_of
from eyas.targets.pose import CENTRE_OFFSET, LEAN_LIMIT, STEER_LIMIT, RigTable, pose_worlds
from eyas.targets.vehicles.bodies import body_levels
from eyas.targets.vehicles.wheels import wheel_levels
from eyas.traffic.config import VehicleType

__all__ = ["CENTRE_OFFSET", "LEAN_LIMIT", "STEER_LIMIT", "VehicleRigs", "build_rigs"]


@dataclass(frozen=True, slots=True)
class VehicleRigs:
    """The parts of all models of a SUMO class, and where they are."""

    library: PartLibrary
    """The parts."""
    slots_per_actor: int
    """Slots of the draw list that each actor takes, S."""
    table: RigTable
    """Where the parts are."""

    def pose(
        self,
        actors: ActorState,
        model: NDArray[np.int32],
        colour: NDArray[np.float32],
        out: DrawList,
    ) -> None:
        """Fill a draw list in place; actor a takes the slots from `a * slots_per_actor` on.

        Args:
            actors: A actors in each of W worlds.
            model: Index into `VEHICLES`, of this class, shape (W, A).
            colour: Body colours, sRGB 0 to 1, shape (W, A, 3).
            out: Draw list of W worlds and at least A * `slots_per_actor` slots; the rest of the
                slots is left alone.
        """
        assert out.part.shape[1] >= model.shape[1] * self.slots_per_actor
        moving = (actors.position, actors.yaw, actors.speed, actors.yaw_rate, actors.travelled)
        drawn = (out.part, out.pose, out.colour, out.object_id)
        pose_worlds(self.table, moving, actors.present, model, colour, drawn)


def build_rigs(vehicle_type: VehicleType) -> VehicleRigs:
    """Return the rigs of a SUMO class."""
    parts: dict[tuple[object, ...], tuple[Mesh, ...]] = {}
    layouts = {m: _layout(VEHICLES[m], parts) for m in models_of(vehicle_type)}
    slots = max(len(layout) for layout in layouts.values())
    return VehicleRigs(PartLibrary(tuple(parts.values())), slots, _tabulate(layouts, slots))


class _Slot(NamedTuple):
    part: int
    offset: tuple[float, float, float]
    steered: bool


def _layout(
    vehicle: VehicleModel, parts: dict[tuple[object, ...], tuple[Mesh, ...]]
) -> list[_Slot]:
    """Return the slots of a model: its body, then its wheels; add what is new to `parts`."""

    def part(key: tuple[object, ...], levels: tuple[Mesh, ...]) -> int:
        parts.setdefault(key, levels)
        return list(parts).index(key)

    slots = [_Slot(part((vehicle.name,), body_levels(vehicle)), (0.0, 0.0, 0.0), steered=False)]
    for axle in vehicle.axles:
        # Wheels that steer turn about their own middles; the others share a part with their axle.
        pair = 0.0 if axle.steered else axle.track
        levels = wheel_levels(vehicle.wheel_radius, axle.width, pair)
        index = part((vehicle.wheel_radius, axle.width, pair), levels)
        slots += [
            _Slot(index, (axle.x, y, vehicle.wheel_radius), axle.steered) for y in _places(axle)
        ]
    return slots


def _places(axle: Axle) -> tuple[float, ...]:
    """Return the sideways places of an axle's parts [m]."""
    return (axle.track / 2, -axle.track / 2) if axle.steered and axle.track else (0.0,)


def _tabulate(layouts: dict[int, list[_Slot]], slots: int) -> RigTable:
    count = len(VEHICLES)
    table = RigTable(
        part=np.full((count, slots), -1, np.int32),
        offset=np.zeros((count, slots, 3)),
        steered=np.zeros((count, slots), np.bool_),
        radius=np.array([vehicle.wheel_radius for vehicle in VEHICLES]),
        wheelbase=np.array([vehicle.wheelbase for vehicle in VEHICLES]),
        lean=np.array([LEAN_LIMIT * (v.vehicle_type == VehicleType.MOTORCYCLE) for v in VEHICLES]),
    )
    for model, layout in layouts.items():
        for s, slot in enumerate(layout):
            table.part[model, s] = slot.part
            table.offset[model, s] = slot.offset
            table.steered[model, s] = slot.steered
    return table
