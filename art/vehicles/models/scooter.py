"""A scooter, whose rider sits upright."""

from art.cars.finishes import BRIGHT, GLASS, PAINT, PLATE, STEEL, TRIM
from art.vehicles.two_wheelers import SEAT, Posture, lamp, two_wheeler
from art.vehicles.vehicle import VehicleModel
from eyas.engine.mesh.shell import Shell

_POSTURE = Posture(
    hip=(-0.34, 0.0, 0.86),
    chest=(-0.22, 0.0, 1.24),
    head=(-0.15, 0.0, 1.545),
    hand=(0.36, 0.27, 1.02),
    elbow=(0.02, 0.265, 1.06),
    knee=(0.16, 0.17, 0.80),
    foot=(0.22, 0.176, 0.34),
    head_radius=0.155,
)


def _scooter(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    shield = [(0.34, 0.34), (0.46, 0.32), (0.60, 0.62), (0.44, 1.0), (0.33, 0.96)]
    shell.prism(shield, (-0.2, 0.2), PAINT)
    shell.box((-0.25, -0.17, 0.22), (0.44, 0.17, 0.31), TRIM)
    body = [(-0.7, 0.46), (-0.6, 0.36), (-0.2, 0.26), (-0.12, 0.66), (-0.7, 0.7)]
    shell.prism(body, (-0.19, 0.19), PAINT)
    tail = [(-0.88, 0.6), (-0.68, 0.46), (-0.68, 0.7), (-0.86, 0.74)]
    shell.prism(tail, (-0.13, 0.13), PAINT)
    seat = [(-0.84, 0.73), (-0.12, 0.66), (-0.08, 0.76), (-0.6, 0.78), (-0.82, 0.82)]
    shell.prism(seat, (-0.14, 0.14), SEAT)
    fender = [(0.5, 0.38), (0.975, 0.36), (0.9, 0.48), (0.7, 0.54)]
    shell.prism(fender, (-0.085, 0.085), PAINT)
    lamp(shell, (0.54, 0.0, 0.86), (0.1, 0.2, 0.14), front=True)
    lamp(shell, (-0.88, 0.0, 0.66), (0.05, 0.22, 0.08), front=False)
    if detail == 0:
        return
    shell.tube(
        [(0.38, 0.0, 1.0), (0.36, 0.31, 1.04)], (0.035, 0.03), TRIM, sides=4, both_sides=True
    )
    shell.box((0.38, 0.27, 1.12), (0.42, 0.33, 1.22), TRIM, both_sides=True)
    glass = [(0.47, 0.96), (0.50, 0.96), (0.36, 1.3), (0.33, 1.3)]
    shell.prism(glass, (-0.17, 0.17), GLASS)
    front, rear = vehicle.axles[0].x, vehicle.axles[1].x
    radius = vehicle.wheel_radius
    shell.tube(
        [(front, 0.09, radius), (0.45, 0.06, 0.8)], (0.03, 0.03), STEEL, sides=4, both_sides=True
    )
    shell.box((rear, 0.08, radius - 0.05), (-0.3, 0.16, radius + 0.12), STEEL)
    if detail == 2:
        exhaust = [(-0.3, -0.17, 0.22), (-0.62, -0.18, 0.25), (-0.9, -0.18, 0.32)]
        shell.tube(exhaust, (0.03, 0.06, 0.055), BRIGHT)
        shell.box((-0.965, -0.09, 0.46), (-0.93, 0.09, 0.6), PLATE)
        rail = [(-0.6, 0.15, 0.8), (-0.88, 0.12, 0.85), (-0.88, -0.12, 0.85), (-0.6, -0.15, 0.8)]
        shell.tube(rail, (0.014,) * 4, STEEL, sides=3)


MODEL = two_wheeler(
    "ScooterSimple",
    size=(1.95, 0.66, 1.7),
    wheels=(1.48, 0.23, 0.745),
    mass=110.0,
    words=("a {} motorcycle", "a {} scooter"),
    shape=_scooter,
    posture=_POSTURE,
)
