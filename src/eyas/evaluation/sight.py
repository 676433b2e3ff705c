"""What cameras see of their targets: boxes, and pixels that are visible or hidden."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.sim.simulation import Simulation
from eyas.state.draw import DrawStage, Picture

__all__ = ["SIZE", "subjects", "visible_shares"]

SIZE = 63, 84
"""Height and width of the pictures in which pixels are counted."""


def subjects(
    simulation: Simulation, trackers: NDArray[np.int32], size: tuple[int, int] = SIZE
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the pixels of each target, visible and all, shape (K, 2), and its box, (K, 4).

    Args:
        simulation: The trackers are in it.
        trackers: K of them.
        size: Height and width of the pictures.
    """
    picture = Picture.create(len(trackers), *size, rgb=False, class_id=True, subject=True)
    simulation.draw(trackers, picture, until=DrawStage.RASTERISING)
    assert picture.subject_pixels is not None
    assert picture.subject_box is not None
    return picture.subject_pixels, picture.subject_box


def visible_shares(pixels: NDArray[Any]) -> NDArray[np.float64]:
    """Return the share of each target that is visible, shape (K,); see `subjects`."""
    shares: NDArray[np.float64] = pixels[:, 0] / np.maximum(pixels[:, 1], 1)
    return shares
