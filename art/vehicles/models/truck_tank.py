"""A truck with a tank trailer."""

import numpy as np
from numpy.typing import NDArray

from art.cars.finishes import BRIGHT, STEEL, TRIM
from art.vehicles.heavy import TRACTOR_BASE, trailer_frame, truck
from art.vehicles.vehicle import Trailer, VehicleModel
from eyas.engine.mesh.shell import Shell
from eyas.lanes import exact


def _tank_trailer(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    end, front = -vehicle.length / 2, vehicle.length / 2 - 3.15
    sides = (8, 12, 18)[detail]
    angle = (np.arange(sides) + 0.5) * (2 * np.pi / sides)

    def ring(x: float, size: float) -> NDArray[np.float64]:
        y, z = 1.24 * size * exact.sin(angle), 2.7 - 1.3 * size * exact.cos(angle)
        return np.column_stack([np.full(sides, x), y, z])

    trailer_frame(shell, vehicle, 1.5, detail)
    sections = [(0.05, 0.5), (0.18, 0.82), (0.45, 1.0)] if detail else [(0.05, 0.7), (0.45, 1.0)]
    rings = [ring(end + x, size) for x, size in sections]
    rings += [ring(front - x, size) for x, size in sections[::-1]]
    shell.rings(rings, BRIGHT)
    for x in np.linspace(end + 1.3, front - 1.3, 5) if detail else ():
        shell.rings([ring(x - 0.05, 1.012), ring(x + 0.05, 1.012)], STEEL, caps=False)
    walk = [(front - 0.9, 0.3), (end + 0.9, 0.3), (end + 0.9, -0.3), (front - 0.9, -0.3)]
    shell.quads([(x, y, 4.03) for x, y in walk], STEEL)
    for x in np.linspace(end + 2.0, front - 2.0, 4) if detail == 2 else ():
        shell.tube([(x, 0.0, 4.0), (x, 0.0, 4.2)], (0.24, 0.24), TRIM, sides=8)


MODEL = truck(
    "TruckTankSimple",
    mass=14500.0,
    words=("a {} truck", "a {} truck with a tank trailer"),
    wheelbase=TRACTOR_BASE,
    trailer=Trailer((11.1, 2.52, 4.22), _tank_trailer),
)
