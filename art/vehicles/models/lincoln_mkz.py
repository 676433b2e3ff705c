"""Lincoln MKZ."""

from art.cars.shape import CarShape
from art.vehicles.car import car

_SHAPE = CarShape(
    top=((-2.5, 0.92), (-2.45, 1.02), (-1.85, 1.09), (-1.05, 1.40), (-0.5, 1.49), (0.0, 1.50),
         (0.25, 1.46), (0.98, 1.04), (1.9, 0.94), (2.35, 0.82), (2.5, 0.66)),
    belt=((-2.5, 0.90), (-2.0, 0.98), (0.8, 0.94), (1.8, 0.86), (2.5, 0.60)),
    plan=((-2.5, 0.84), (-2.40, 0.93), (-1.9, 0.99), (-1.2, 1.0), (1.5, 1.0), (2.0, 0.94),
          (2.35, 0.80), (2.5, 0.58)),
    windscreen=(0.25, 1.04),
    rear_window=(-1.80, -1.0),
    windows=((-1.40, -0.55), (-0.45, 0.80)),
    clearance=0.17,
    lean=0.34,
    tail_lamps=0.3,
    head_lamps=0.40,
    bodywork="saloon",
)  # fmt: skip

MODEL = car(
    "LincolnMKZSimple",
    size=(5.0, 1.85, 1.5),
    wheels=(2.94, 0.358, 1.52),
    mass=1690.0,
    words=("a {} car", "a {} sedan", "a {} Lincoln MKZ sedan"),
    shape=_SHAPE,
)
