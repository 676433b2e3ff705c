"""The parts of vehicles, and where each is: a body, wheels and a trailer."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from art.cars.frame import Axle
from art.cars.wheels import DESIGNS, wheel_levels
from art.packing import columns_of
from art.parts import levels_of
from art.vehicles.vehicle import Trailer, VehicleModel
from eyas.engine.state.mesh import Mesh
from eyas.engine.targets.vehicles.pose import AXLES, SLOT, RigTable
from eyas.engine.targets.vehicles.rig import VehicleArrays


class VehicleLayout:
    """The parts of the models of one kind of vehicle.

    Attributes:
        parts: Bodies of models, wheels, which several models may share, and trailers.
        trailers: Which of them are trailers, without their wheels.

    Args:
        models: All models of a kind.
    """

    def __init__(self, models: Sequence[VehicleModel]) -> None:
        self.parts: list[_Part] = []
        self._models = models
        self._layouts = [_layouts(model, self.parts) for model in models]
        self.trailers = tuple(k for k, part in enumerate(self.parts) if isinstance(part, _Towed))

    @property
    def arrays(self) -> VehicleArrays:
        """What poses the parts."""
        table = _tabulate(self._models, self._layouts)
        return VehicleArrays(columns_of(table.slot), columns_of(table.axles))

    def part_levels(self) -> list[tuple[Mesh, ...]]:
        """Return the meshes of each part, the finest first.

        Raises:
            ConfigError: A model is not of the size that it says.
        """
        levels = [_levels(part) for part in self.parts]
        for model, variants in zip(self._models, self._layouts, strict=True):
            for slots in variants:
                placed = [levels[slot.part][0].positions + slot.offset for slot in slots]
                model.check_meshes(np.concatenate(placed), 0.05)
        return levels


class _Wheels(NamedTuple):
    radius: float
    width: float
    track: float  # Distance between the two wheels of an axle [m]; 0 for a single wheel
    design: int  # Of the discs


class _Body(NamedTuple):
    vehicle: VehicleModel
    variant: int  # 0 for `VehicleModel.body`, from 1 on for one of `VehicleModel.variants`.


class _Towed(NamedTuple):
    trailer: Trailer
    vehicle: VehicleModel


_Part = _Body | _Wheels | _Towed
"""A body of a model, or wheels, which several models may share, or its trailer."""


def _levels(part: _Part) -> tuple[Mesh, ...]:
    if isinstance(part, _Wheels):
        return wheel_levels(*part)
    if isinstance(part, _Body):
        vehicle, variant = part
        return (vehicle.body, *vehicle.variants)[variant](vehicle)
    shape, vehicle = part.trailer.shape, part.vehicle
    return levels_of(lambda shell, detail: shape(shell, vehicle, detail))


class _Slot(NamedTuple):
    part: int
    offset: tuple[float, float, float]
    steered: bool = False
    towed: bool = False


def _layouts(vehicle: VehicleModel, parts: list[_Part]) -> list[list[_Slot]]:
    """Return the slots of each variant of a model; add new parts to `parts`."""
    return [_layout(vehicle, variant, parts) for variant in range(1 + len(vehicle.variants))]


def _layout(vehicle: VehicleModel, variant: int, parts: list[_Part]) -> list[_Slot]:
    """Return the slots of a variant of a model: its body and wheels, then its trailer and the
    wheels of that; add new parts to `parts`.
    """
    slots = [_Slot(_index(_Body(vehicle, variant), parts), (0.0, 0.0, 0.0))]
    design = variant % DESIGNS
    for axle in sorted(vehicle.axles, key=lambda axle: axle.towed):
        if axle.towed and not slots[-1].towed:
            assert vehicle.trailer is not None
            behind = _index(_Towed(vehicle.trailer, vehicle), parts)
            slots.append(_Slot(behind, (0.0, 0.0, 0.0), towed=True))
        # Steered wheels turn about their own middles, so each is a part; others are one per axle.
        pair = 0.0 if axle.steered else axle.track
        part = _index(_Wheels(vehicle.wheel_radius, axle.width, pair, design), parts)
        slots += [
            _Slot(part, (axle.x, y, vehicle.wheel_radius), axle.steered, axle.towed)
            for y in _places(axle)
        ]
    return slots


def _index(part: _Part, parts: list[_Part]) -> int:
    if part not in parts:
        parts.append(part)
    return parts.index(part)


def _places(axle: Axle) -> tuple[float, ...]:
    """Return y of an axle's parts [m]."""
    return (axle.track / 2, -axle.track / 2) if axle.steered and axle.track else (0.0,)


def _tabulate(models: Sequence[VehicleModel], layouts: Sequence[list[list[_Slot]]]) -> RigTable:
    most = max(len(variants) for variants in layouts)
    slots = max(len(layout) for variants in layouts for layout in variants)
    table = RigTable(
        slot=np.zeros((len(models), most, slots), SLOT),
        axles=np.array([(m.wheel_radius, m.wheelbase, m.lean) for m in models], AXLES),
    )
    table.slot["part"] = -1
    for model, variants in enumerate(layouts):
        for variant in range(most):
            for s, slot in enumerate(variants[variant % len(variants)]):
                row = (slot.part, *slot.offset, slot.steered, slot.towed)
                table.slot[model, variant, s] = row
    return table
