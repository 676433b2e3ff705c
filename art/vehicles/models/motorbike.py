"""A motorbike, whose rider crouches."""

from art.cars.finishes import (
    BRIGHT,
    GLASS,
    INDICATOR_LEFT,
    INDICATOR_RIGHT,
    PAINT,
    PLATE,
    STEEL,
    TRIM,
)
from art.vehicles.two_wheelers import SEAT, Posture, lamp, two_wheeler
from art.vehicles.vehicle import VehicleModel
from eyas.engine.mesh.shell import Shell

_POSTURE = Posture(
    hip=(-0.42, 0.0, 0.90),
    chest=(0.0, 0.0, 1.16),
    head=(0.20, 0.0, 1.405),
    hand=(0.50, 0.33, 0.97),
    elbow=(0.24, 0.36, 0.98),
    knee=(0.08, 0.24, 0.74),
    foot=(-0.30, 0.22, 0.34),
    head_radius=0.145,
    helmet=PAINT,
)


def _motorbike(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    front, rear, radius = vehicle.axles[0].x, vehicle.axles[1].x, vehicle.wheel_radius
    tank = [(-0.12, 0.66), (0.42, 0.64), (0.46, 0.86), (0.22, 0.97), (-0.12, 0.82)]
    shell.prism(tank, (-0.16, 0.16), PAINT)
    fairing = [(0.40, 0.62), (0.62, 0.60), (0.86, 0.80), (0.74, 0.98), (0.46, 1.0)]
    shell.prism(fairing, (-0.2, 0.2), PAINT)
    cowl = [(0.0, 0.30), (0.52, 0.32), (0.60, 0.60), (-0.1, 0.66)]
    shell.prism(cowl, (-0.17, 0.17), TRIM)
    tail = [(-1.1, 0.84), (-0.6, 0.66), (-0.12, 0.66), (-0.12, 0.74), (-0.7, 0.84), (-1.14, 0.94)]
    shell.prism(tail, (-0.13, 0.13), PAINT)
    seat = [(-0.85, 0.85), (-0.12, 0.72), (-0.1, 0.82), (-0.5, 0.86), (-0.85, 0.92)]
    shell.prism(seat, (-0.158, 0.158), SEAT)
    lamp(shell, (0.82, 0.0, 0.82), (0.12, 0.26, 0.12), front=True)
    lamp(shell, (-1.13, 0.0, 0.89), (0.06, 0.22, 0.08), front=False)
    fender = [(front - 0.2, 0.46), (front + 0.3, 0.42), (front + 0.16, 0.52), (front - 0.02, 0.55)]
    shell.prism(fender, (-0.08, 0.08), PAINT)
    if detail == 0:
        return
    shell.tube(
        [(0.50, 0.0, 0.98), (0.48, 0.38, 0.97)], (0.03, 0.03), TRIM, sides=4, both_sides=True
    )
    shell.box((0.52, 0.43, 1.04), (0.56, 0.55, 1.13), TRIM, both_sides=True)
    glass = [(0.60, 0.97), (0.76, 0.95), (0.5, 1.2), (0.44, 1.2)]
    shell.prism(glass, (-0.15, 0.15), GLASS)
    shell.tube(
        [(front, 0.1, radius), (0.56, 0.08, 0.95)], (0.035, 0.04), BRIGHT, sides=5, both_sides=True
    )
    shell.box((rear, 0.09, radius - 0.05), (-0.05, 0.14, radius + 0.12), STEEL, both_sides=True)
    shell.box((-0.86, 0.2, 0.5), (-0.42, 0.36, 0.78), TRIM, taper=0.02, both_sides=True)
    for indicator, y in ((INDICATOR_LEFT, 0.15), (INDICATOR_RIGHT, -0.25)):
        shell.box((-1.12, y, 0.78), (-1.06, y + 0.1, 0.84), indicator)
    shell.box((-1.24, -0.1, 0.55), (-1.2, 0.1, 0.75), PLATE)
    shell.prism([(-1.24, 0.55), (-1.08, 0.84), (-1.12, 0.88), (-1.26, 0.62)], (-0.06, 0.06), TRIM)
    if detail == 2:
        exhaust = [(0.1, -0.185, 0.26), (-0.5, -0.205, 0.3), (-0.95, -0.21, 0.5)]
        shell.tube(exhaust, (0.04, 0.06, 0.075), BRIGHT)
        shell.tube(
            [(0.48, 0.36, 0.98), (0.54, 0.47, 1.08)], (0.012, 0.012), TRIM, sides=3, both_sides=True
        )


MODEL = two_wheeler(
    "MotorbikeSimple",
    size=(2.48, 1.1, 1.55),
    wheels=(1.78, 0.25, 0.94),
    mass=230.0,
    words=("a {} motorcycle", "a {} motorbike"),
    shape=_motorbike,
    posture=_POSTURE,
)
