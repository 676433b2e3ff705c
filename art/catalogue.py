"""All vehicles, people, robots and fliers that ship: their kinds, and the arrays that draw them."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from art.bird import bird_parts
from art.jointed.layout import JointedLayout
from art.jointed.model import JointedModel
from art.jointed.people.people import PEDESTRIANS
from art.jointed.riders.cyclist import CYCLISTS
from art.jointed.robots import ROBOTS
from art.packing import Packer, joined
from art.quadrotor import quadrotor_levels
from art.vehicles.layout import VehicleLayout
from art.vehicles.models import VEHICLES
from art.vehicles.vehicle import BODY_COLOURS, MOTORCYCLE_COLOURS
from eyas.engine.core.cache.flat import flatten
from eyas.engine.mesh.shipped import digest_of
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.kind import KindFacts
from eyas.engine.targets.shapes import FILE, ShapeArrays, ShapeEntry, ShapeIndex
from eyas.engine.targets.vehicles.pose import VEHICLE_AHEAD
from eyas.engine.traffic.config import VehicleType

CLASSES = {
    VehicleType.PASSENGER: ObjectClass.CAR,
    VehicleType.BUS: ObjectClass.BUS,
    VehicleType.TRUCK: ObjectClass.TRUCK,
    VehicleType.TRAILER: ObjectClass.TRUCK,
    VehicleType.MOTORCYCLE: ObjectClass.MOTORCYCLE,
}


def pack_models() -> tuple[dict[Path, bytes], str]:
    """Return the file that ships, and the digest of its index."""
    packer = Packer()
    kinds = tuple(entries(packer))
    fliers = {"quadrotor": [quadrotor_levels()], "bird": bird_parts()}
    blocks = {name: packer.add(joined(parts)) for name, parts in fliers.items()}
    index, _ = flatten(ShapeIndex(kinds, blocks))
    return {FILE: packer.file(index)}, digest_of(index)


def entries(packer: Packer) -> Iterator[ShapeEntry]:
    """Yield the kinds in their order, and pack their arrays.

    Raises:
        ConfigError: A model is not of the size that it says.
    """
    for vehicle_type in VehicleType:
        yield driven(vehicle_type, packer)
    # The pedestrian, the robots in the order of `TargetName`, and the cyclist, who is nobody's
    # target in the original and so no `TargetName`.
    yield jointed(PEDESTRIANS, ObjectClass.PERSON, packer)
    for robot in ROBOTS:
        yield jointed((robot,), ObjectClass.ROBOT, packer)
    yield jointed(CYCLISTS, ObjectClass.BICYCLE, packer)


def driven(vehicle_type: VehicleType, packer: Packer) -> ShapeEntry:
    """Return a kind of vehicle."""
    models = tuple(model for model in VEHICLES if model.kind == vehicle_type)
    layout = VehicleLayout(models)
    two_wheeled = vehicle_type is VehicleType.MOTORCYCLE
    facts = KindFacts(
        name=vehicle_type.value,
        models=tuple(model.plain() for model in models),
        colours=MOTORCYCLE_COLOURS if two_wheeled else BODY_COLOURS,
        object_class=CLASSES[vehicle_type],
        ahead=VEHICLE_AHEAD,
        slowest=0.5,  # as in the original
        lamps=True,
        trailers=layout.trailers,
        sections=tuple(model.sections for model in models) if layout.trailers else (),
        keeps_colours=two_wheeled,
    )
    shapes = ShapeArrays(packer.add(layout.arrays), packer.add(joined(layout.part_levels())))
    return ShapeEntry(facts, drives=True, shapes=shapes)


def jointed(
    models: Sequence[JointedModel], object_class: ObjectClass, packer: Packer
) -> ShapeEntry:
    """Return a kind of people or robots."""
    layout = JointedLayout(models)
    facts = KindFacts(
        name=models[0].kind,
        models=tuple(model.plain() for model in models),
        colours=models[0].colours,
        object_class=object_class,
        keeps_colours=True,
        habit=models[0].habit,
    )
    shapes = ShapeArrays(
        packer.add(layout.arrays),
        packer.add(joined(layout.part_levels())),
        packer.add(layout.extents()),
    )
    return ShapeEntry(facts, drives=False, shapes=shapes)
