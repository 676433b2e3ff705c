"""Toyota Prius, a wedge."""

from art.cars.shape import CarShape
from art.vehicles.car import car

_SHAPE = CarShape(
    top=((-2.25, 0.92), (-2.20, 1.02), (-2.05, 1.10), (-1.1, 1.38), (-0.4, 1.49), (0.0, 1.50),
         (0.25, 1.46), (1.32, 0.98), (1.8, 0.86), (2.12, 0.74), (2.25, 0.58)),
    belt=((-2.25, 0.90), (-2.0, 0.98), (0.9, 0.88), (1.5, 0.80), (2.25, 0.52)),
    plan=((-2.25, 0.82), (-2.16, 0.93), (-1.7, 0.99), (-0.8, 1.0), (1.2, 1.0), (1.75, 0.93),
          (2.1, 0.79), (2.25, 0.58)),
    windscreen=(0.22, 1.36),
    rear_window=(-2.05, -1.0),
    windows=((-1.55, -1.0), (-0.9, -0.1), (0.0, 0.98)),
    clearance=0.16,
    lean=0.30,
    tall_tail_lamps=True,
    head_lamps=0.45,
)  # fmt: skip

MODEL = car(
    "ToyotaPriusSimple",
    size=(4.5, 1.8, 1.5),
    wheels=(2.8, 0.317, 1.37),
    mass=1380.0,
    words=("a {} car", "a {} hatchback", "a {} Toyota Prius hatchback"),
    shape=_SHAPE,
)
