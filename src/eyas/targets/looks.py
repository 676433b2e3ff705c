"""Which model and which colour each actor has."""

import numpy as np
from numpy.typing import NDArray

from eyas.targets.catalogue import BODY_COLOURS, MOTORCYCLE_COLOURS, VEHICLES, models_of
from eyas.traffic.config import VehicleType

__all__ = ["DIMENSIONS", "draw_looks"]

DIMENSIONS: NDArray[np.float64] = np.array([vehicle.size for vehicle in VEHICLES])
"""Length, width and height of each model [m], shape (M, 3)."""
DIMENSIONS.setflags(write=False)


def draw_looks(
    rng: np.random.Generator,
    vehicle_type: VehicleType,
    count: int,
    colour: tuple[float, float, float] | None,
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Draw the looks of `count` actors.

    The model is uniform among those of the class, the colour uniform among the original's. The
    same draws are made whether or not the colour is fixed, so fixing it changes no model.

    Args:
        rng: Stream of this room.
        vehicle_type: SUMO class of all of them.
        count: How many, A.
        colour: Colour of all, sRGB 0 to 1. As in the original it does not hold for motorcycles.

    Returns:
        Index into `VEHICLES`, shape (A,), and sRGB colour, shape (A, 3).
    """
    models = np.array(models_of(vehicle_type), np.int32)
    two_wheeled = vehicle_type == VehicleType.MOTORCYCLE
    palette = np.array(MOTORCYCLE_COLOURS if two_wheeled else BODY_COLOURS, np.float32)
    model = models[rng.integers(len(models), size=count)]
    drawn = palette[rng.integers(len(palette), size=count)]
    if colour is not None and not two_wheeled:
        drawn[:] = colour
    return model, drawn
