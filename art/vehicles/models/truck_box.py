"""A truck with a box trailer."""

from dataclasses import replace

import numpy as np

from art.cars.finishes import FREIGHT, SKIN_WHITE, TRIM
from art.cars.regions import BOX_DOORS, BOX_ROOF, BOX_SIDE, PLAIN
from art.vehicles.heavy import HALF, TRACTOR_BASE, facing, trailer_frame, truck
from art.vehicles.vehicle import Trailer, VehicleModel
from eyas.engine.mesh.shell import Shell

_STRIPE = replace(FREIGHT, tint=(0.68, 0.09, 0.09))


def _box_trailer(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    end, front = -vehicle.length / 2, vehicle.length / 2 - 3.15
    floor, roof = 1.22, 4.2
    trailer_frame(shell, vehicle, floor, detail)
    rows = ((floor, 1.7, FREIGHT), (1.7, 2.2, _STRIPE), (2.2, roof, FREIGHT))
    for low, high, material in rows:
        side = [(front, HALF, low), (end, HALF, low), (end, HALF, high), (front, HALF, high)]
        up = (np.array([low, low, high, high]) - floor) / (roof - floor)
        shell.quads(side, material, uvs=BOX_SIDE.at([1.0, 0.0, 0.0, 1.0], up), both_sides=True)
    lid = [(end, 0.0, roof), (front, 0.0, roof), (front, HALF, roof), (end, HALF, roof)]
    over = BOX_ROOF.at([0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0])
    shell.quads(lid, FREIGHT, uvs=over, both_sides=True)
    doors = facing(end, (-HALF, HALF), (floor, roof))
    shell.quads(doors[::-1], FREIGHT, uvs=BOX_DOORS.at([0.0, 1.0, 1.0, 0.0], [1.0, 1.0, 0.0, 0.0]))
    shell.quads(facing(front, (-HALF, HALF), (floor, roof)), FREIGHT, uvs=PLAIN)
    below = [(end, HALF, floor), (front, HALF, floor), (front, -HALF, floor), (end, -HALF, floor)]
    shell.quads(below, TRIM)
    if detail == 0:
        return
    shell.box((front, -0.85, 2.9), (front + 0.32, 0.85, 4.0), SKIN_WHITE, taper=0.03)


MODEL = truck(
    "TruckTrailerSimple",
    mass=14500.0,
    words=("a {} truck", "a {} truck with a box trailer"),
    wheelbase=TRACTOR_BASE,
    trailer=Trailer((11.47, 2.52, 4.22), _box_trailer),
)
