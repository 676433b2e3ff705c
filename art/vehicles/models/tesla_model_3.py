"""Tesla Model 3, with a roof of glass."""

from art.cars.finishes import ROOF_GLASS
from art.cars.shape import CarShape
from art.vehicles.car import car

_SHAPE = CarShape(
    top=((-2.4, 0.94), (-2.36, 1.05), (-2.0, 1.10), (-1.0, 1.40), (-0.4, 1.49), (0.0, 1.50),
         (0.3, 1.45), (1.28, 0.98), (1.9, 0.84), (2.25, 0.70), (2.4, 0.54)),
    belt=((-2.4, 0.92), (-2.0, 0.99), (0.9, 0.90), (1.8, 0.76), (2.4, 0.48)),
    plan=((-2.4, 0.84), (-2.30, 0.94), (-1.8, 1.0), (-1.2, 1.0), (1.4, 1.0), (1.95, 0.93),
          (2.25, 0.78), (2.4, 0.56)),
    windscreen=(0.30, 1.30),
    rear_window=(-1.95, -1.0),
    windows=((-1.45, -0.42), (-0.32, 0.95)),
    clearance=0.16,
    lean=0.36,
    roof=ROOF_GLASS,
    head_lamps=0.40,
    bodywork="saloon",
)  # fmt: skip

MODEL = car(
    "TeslaModel3Simple",
    size=(4.8, 1.85, 1.5),
    wheels=(2.94, 0.36, 1.53),
    mass=1730.0,
    words=("a {} car", "a {} sedan", "a {} sedan with a glass roof", "a {} Tesla Model 3 sedan"),
    shape=_SHAPE,
)
