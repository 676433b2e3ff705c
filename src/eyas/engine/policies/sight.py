"""Targets in pictures: boxes, and pixels that are visible or hidden."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.state.motion import ActorState
from eyas.lanes import exact

SIZE = 63, 84  # Height and width of the pictures in which pixels are counted


def subjects(
    simulation: Simulation, trackers: NDArray[np.int32], size: tuple[int, int] = SIZE
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the pixels of each target, visible and all, shape (K, 2), and its box, (K, 4)."""
    picture = Picture.create(len(trackers), *size, rgb=False, class_id=True, subject=True)
    simulation.draw(trackers, picture, until=DrawStage.RASTERISING)
    assert picture.subject_pixels is not None
    assert picture.subject_box is not None
    return picture.subject_pixels, picture.subject_box


def visible_shares(pixels: NDArray[Any]) -> NDArray[np.float64]:
    """Return the share of each target that is visible, shape (K,); see `subjects`."""
    shares: NDArray[np.float64] = pixels[:, 0] / np.maximum(pixels[:, 1], 1)
    return shares


def nearest_to_middle(
    simulation: Simulation,  # K trackers, each with a world of its own
) -> NDArray[np.int64]:
    """Return which actor is nearest to the middle of each picture, hidden or not, shape (K,); -1 if
    there is none in it.
    """
    cameras, camera = simulation.snapshot.cameras, simulation.config.camera
    actors = ActorState.create(simulation.count, simulation.actors)
    time = simulation.snapshot.episodes.tick.astype(np.float64) * PHYSICS_STEP
    simulation.traffic.at(time, actors)
    away = actors.position - cameras.position[:, None]
    forward, left, up = np.moveaxis(exact.product(away, cameras.rotation), -1, 0)
    reach = np.maximum(forward, 1e-6) * exact.tan(0.5 * cameras.field_of_view)[:, None]
    across, down = left / reach, up / reach
    inside = (forward > 0.0) & (np.abs(across) < 1.0) & actors.present
    inside &= np.abs(down) < camera.height / camera.width
    distance = np.where(inside, exact.hypot(across, down), np.inf)
    nearest: NDArray[np.int64] = np.where(inside.any(axis=1), distance.argmin(axis=1), -1)
    return nearest
