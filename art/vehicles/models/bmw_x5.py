"""BMW X5."""

from art.cars.finishes import TRIM
from art.cars.shape import CarShape
from art.vehicles.car import car

_SHAPE = CarShape(
    top=((-2.425, 0.98), (-2.36, 1.06), (-2.02, 1.66), (-1.75, 1.74), (-0.6, 1.80), (0.2, 1.78),
         (0.45, 1.72), (1.05, 1.18), (1.9, 1.08), (2.3, 0.96), (2.425, 0.80)),
    belt=((-2.425, 0.98), (-2.2, 1.06), (0.9, 1.04), (2.0, 0.96), (2.425, 0.72)),
    plan=((-2.425, 0.86), (-2.33, 0.95), (-1.9, 1.0), (1.7, 1.0), (2.2, 0.91), (2.425, 0.60)),
    windscreen=(0.45, 1.15),
    rear_window=(-2.36, -2.02),
    windows=((-1.95, -1.28), (-1.16, -0.22), (-0.12, 0.95)),
    clearance=0.27,
    sill=TRIM,
    lean=0.30,
    rack=True,
)  # fmt: skip

MODEL = car(
    "BmwX5Simple",
    size=(4.85, 1.9, 1.8),
    wheels=(3.0, 0.374, 1.53),
    mass=2145.0,
    words=("a {} car", "a {} SUV", "a {} BMW X5 SUV"),
    shape=_SHAPE,
)
