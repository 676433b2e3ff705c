"""A truck with a box trailer."""

from dataclasses import replace

from art.cars.finishes import FREIGHT, SKIN_WHITE
from art.vehicles.heavy import TRACTOR_BASE, freight_box, trailer_frame, truck
from art.vehicles.vehicle import Trailer, VehicleModel
from eyas.engine.mesh.shell import Shell

_STRIPE = replace(FREIGHT, tint=(0.68, 0.09, 0.09))


def _box_trailer(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    end, front = -vehicle.length / 2, vehicle.length / 2 - 3.15
    floor, roof = 1.22, 4.2
    trailer_frame(shell, vehicle, floor, detail)
    freight_box(shell, (end, front), (floor, roof), _STRIPE, detail)
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
