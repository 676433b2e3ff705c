"""Mercedes-Benz Sprinter, a long van."""

from art.cars.finishes import TRIM
from art.cars.shape import CarShape
from art.vehicles.car import car

_SHAPE = CarShape(
    top=((-3.45, 2.50), (-3.38, 2.64), (-3.1, 2.70), (1.4, 2.70), (1.75, 2.62), (2.05, 2.40),
         (2.66, 1.52), (3.15, 1.28), (3.36, 1.12), (3.45, 0.90)),
    belt=((-3.45, 1.46), (1.6, 1.46), (2.2, 1.38), (3.0, 1.18), (3.45, 0.80)),
    plan=((-3.45, 0.96), (-3.35, 1.0), (2.4, 1.0), (3.0, 0.93), (3.3, 0.77), (3.45, 0.56)),
    windscreen=(1.86, 2.76),
    rear_window=(-3.449, -3.449),
    windows=((1.15, 2.34),),
    clearance=0.28,
    lean=0.07,
    tail_window=True,
    tail_lamps=0.07,
    head_lamps=0.42,
    sill=TRIM,
    bodywork="van",
    dark_bumpers=True,
)  # fmt: skip

MODEL = car(
    "MercedesBenzSprinterSimple",
    size=(6.9, 2.0, 2.7),
    wheels=(4.33, 0.40, 2.45),
    mass=2500.0,
    words=("a {} van", "a {} Mercedes Sprinter van"),
    shape=_SHAPE,
)
