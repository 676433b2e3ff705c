"""Range Rover Sport SVR, with a black roof."""

from art.cars.finishes import BLACK_PAINT, TRIM
from art.cars.shape import CarShape
from art.vehicles.car import car

_SHAPE = CarShape(
    top=((-2.35, 1.00), (-2.28, 1.10), (-1.96, 1.58), (-1.7, 1.66), (-0.3, 1.70), (0.2, 1.68),
         (0.40, 1.64), (0.92, 1.20), (2.0, 1.10), (2.26, 1.00), (2.35, 0.84)),
    belt=((-2.35, 1.00), (-2.1, 1.10), (0.9, 1.05), (2.0, 1.00), (2.35, 0.78)),
    plan=((-2.35, 0.90), (-2.28, 0.97), (-2.0, 1.0), (1.7, 1.0), (2.18, 0.91), (2.35, 0.64)),
    windscreen=(0.40, 1.0),
    rear_window=(-2.28, -1.93),
    windows=((-1.90, -1.18), (-1.1, -0.22), (-0.14, 0.82)),
    clearance=0.25,
    lean=0.26,
    roof=BLACK_PAINT,
    rails=BLACK_PAINT,
    sill=TRIM,
    rack=True,
)  # fmt: skip

MODEL = car(
    "RangeRoverSportSVRSimple",
    size=(4.7, 1.95, 1.7),
    wheels=(2.71, 0.358, 1.45),
    mass=2335.0,
    words=("a {} car", "a {} SUV", "a {} SUV with a black roof", "a {} Range Rover Sport SUV"),
    shape=_SHAPE,
)
