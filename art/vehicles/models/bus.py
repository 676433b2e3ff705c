"""A city bus."""

from art.cars.finishes import TAIL_LAMP, TRIM, plain
from art.cars.frame import Axle
from art.cars.shape import CarShape
from art.vehicles.car import car
from eyas.engine.traffic.config import VehicleType

_SHAPE = CarShape(
    top=((-4.865, 2.90), (-4.80, 3.02), (-4.55, 3.10), (-3.9, 3.12), (4.1, 3.12), (4.6, 3.06),
         (4.79, 2.94), (4.865, 2.76)),
    belt=((-4.865, 1.62), (4.0, 1.62), (4.3, 1.42), (4.865, 1.34)),
    plan=((-4.865, 0.95), (-4.76, 1.0), (4.55, 1.0), (4.76, 0.97), (4.865, 0.90)),
    windscreen=(4.60, 4.865),
    rear_window=(-4.864, -4.864),
    windows=((-4.55, -3.2), (-3.1, -1.75), (-1.65, -0.3), (-0.2, 1.15), (1.25, 2.6), (2.7, 3.4),
             (3.5, 4.82)),
    clearance=0.34,
    lean=0.03,
    tail_window=True,
    nose_window=True,
    tail_lamps=0.06,
    head_lamps=0.09,
    sill=TRIM,
    fittings=(
        (TAIL_LAMP, -4.88, (0.88, 1.2), (0.87, 1.28)),
        (TAIL_LAMP, -4.88, (0.84, 1.06), (2.64, 2.76)),
        (plain(0.05, 0.05, 0.05), -4.88, (0.0, 0.52), (2.46, 2.74)),  # the route
        (plain(0.85, 0.52, 0.10), -4.893, (0.1, 0.32), (2.52, 2.68)),
    ),
    pods=((-4.2, -2.6, 3.36), (1.4, 3.0, 3.30)),
    bodywork="bus",
)  # fmt: skip

MODEL = car(
    "BusSimple",
    VehicleType.BUS,
    size=(9.73, 2.64, 3.36),
    wheels=(4.5, 0.56, 2.3),
    axles=(Axle(2.3, 2.2, 0.3, steered=True), Axle(-2.2, 1.96, 0.54)),
    mass=11000.0,
    words=("a {} bus",),
    shape=_SHAPE,
)
