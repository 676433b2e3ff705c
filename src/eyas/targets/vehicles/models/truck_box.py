"""A truck with a box trailer."""

import numpy as np

from eyas.mesh.shell import Shell
from eyas.targets.vehicles.finishes import SKIN_WHITE, plain
from eyas.targets.vehicles.heavy import HALF, TRACTOR_BASE, facing, trailer_frame, truck
from eyas.targets.vehicles.vehicle import Trailer, VehicleModel

__all__ = ["MODEL"]

_ROOF_WHITE = plain(0.74, 0.75, 0.76)
_STRIPE = plain(0.62, 0.08, 0.08)
_SEAM = plain(0.52, 0.53, 0.54)


def _box_trailer(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    end, front = -vehicle.length / 2, vehicle.length / 2 - 3.15
    floor, roof = 1.22, 4.2
    trailer_frame(shell, vehicle, floor, detail)
    shell.box((end, -HALF, floor), (front, HALF, roof), SKIN_WHITE)
    lid = [(end + 0.06, -1.19), (front - 0.06, -1.19), (front - 0.06, 1.19), (end + 0.06, 1.19)]
    shell.quads([(x, y, roof + 0.006) for x, y in lid], _ROOF_WHITE)
    side = HALF + 0.008
    band = [(front, side, 1.7), (end, side, 1.7), (end, side, 2.2), (front, side, 2.2)]
    shell.quads(band, _STRIPE, both_sides=True)
    if detail == 0:
        return
    door = facing(end - 0.01, (-0.03, 0.03), (floor + 0.1, roof - 0.1))
    shell.quads(door[::-1], _SEAM)
    for x in np.arange(end + 1.6, front - 0.5, 1.6) if detail == 2 else ():
        rib = [(x - 0.03, 1.19), (x - 0.03, -1.19), (x + 0.03, -1.19), (x + 0.03, 1.19)]
        shell.quads([(u, v, roof + 0.012) for u, v in rib], _SEAM)
        seam = [
            (x + 0.02, side, 2.2),
            (x - 0.02, side, 2.2),
            (x - 0.02, side, roof),
            (x + 0.02, side, roof),
        ]
        shell.quads(seam, _SEAM, both_sides=True)
    shell.box((front, -0.85, 2.9), (front + 0.32, 0.85, 4.0), SKIN_WHITE, taper=0.03)


MODEL = truck(
    "TruckTrailerSimple",
    mass=14500.0,
    words=("a {} truck", "a {} truck with a box trailer"),
    wheelbase=TRACTOR_BASE,
    trailer=Trailer((11.47, 2.52, 4.22), _box_trailer),
)
