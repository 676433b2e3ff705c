"""Citroen C-Zero, egg-shaped."""

from art.cars.shape import CarShape
from art.vehicles.car import car

_SHAPE = CarShape(
    top=((-1.75, 0.84), (-1.70, 0.98), (-1.48, 1.36), (-1.1, 1.54), (-0.4, 1.60), (0.1, 1.58),
         (0.45, 1.48), (1.22, 0.98), (1.5, 0.86), (1.68, 0.74), (1.75, 0.60)),
    belt=((-1.75, 0.82), (-1.5, 0.92), (0.6, 0.86), (1.3, 0.80), (1.75, 0.54)),
    plan=((-1.75, 0.88), (-1.66, 0.97), (-1.4, 1.0), (1.2, 1.0), (1.5, 0.91), (1.66, 0.76),
          (1.75, 0.58)),
    windscreen=(0.40, 1.26),
    rear_window=(-1.70, -1.36),
    windows=((-1.25, -0.58), (-0.48, 0.42), (0.52, 0.92)),
    clearance=0.18,
    lean=0.16,
    tail_lamps=0.1,
    tall_tail_lamps=True,
    head_lamps=0.36,
)  # fmt: skip

MODEL = car(
    "CitroenCZeroSimple",
    size=(3.5, 1.5, 1.6),
    wheels=(2.55, 0.285, 1.26),
    mass=1120.0,
    words=("a {} car", "a small {} car", "a small {} Citroen C-Zero"),
    shape=_SHAPE,
)
