"""What a vehicle's camera tracks: choosing it in the picture, and where it is seen."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.state.scene import ACTOR_OBJECT

_REACH = 0.03  # Largest distance of a clicked point from its object, as a share of the width


class Sighting(NamedTuple):
    """The target in a picture; shares of its sides, from the left and the top."""

    left: float
    top: float
    right: float
    bottom: float
    share: float  # Share of the object's pixels that are visible


class Sights:
    """Looks through the cameras of a simulation's trackers."""

    def __init__(self, simulation: Simulation) -> None:
        camera = simulation.config.camera
        self._simulation = simulation
        self._size = camera.height, camera.width
        self._measured = Picture.create(1, *self._size, rgb=False, class_id=True, subject=True)
        self._objects = Picture.create(1, *self._size, rgb=False, object_id=True)

    def seen(self, vehicle: int) -> Sighting | None:
        """Return where the target of a vehicle is in its picture; None if no part is visible."""
        one = np.array([vehicle], np.int32)
        self._simulation.view.draw(one, self._measured, DrawStage.RASTERISING)
        return seen_in(self._measured, 0)

    def chosen(self, vehicle: int, box: tuple[float, float, float, float]) -> int | None:
        """Return the actor that covers most of a box, or is nearest to it; None if there is none.

        Args:
            vehicle: Whose picture it is.
            box: Left, top, right, bottom as shares of the sides.
        """
        one = np.array([vehicle], np.int32)
        self._simulation.view.draw(one, self._objects, DrawStage.RASTERISING)
        assert self._objects.object_id is not None
        actors = self._objects.object_id[0] - ACTOR_OBJECT
        rows, columns = np.nonzero((actors >= 0) & (actors < self._simulation.actors))
        if not len(rows):
            return None
        height, width = self._size
        across, down = columns + 0.5, rows + 0.5
        right, left = across - box[2] * width, box[0] * width - across
        low, high = down - box[3] * height, box[1] * height - down
        aside = np.maximum(np.maximum(right, left), 0.0)
        along = np.maximum(np.maximum(low, high), 0.0)
        away = np.sqrt(aside * aside + along * along)
        near = away <= max(float(away.min()), 0.5)
        if float(away.min()) > _REACH * width:
            return None
        found, count = np.unique(actors[rows[near], columns[near]], return_counts=True)
        return int(found[int(count.argmax())])


def seen_in(picture: Picture, view: int) -> Sighting | None:
    """Return where the subject of a view is in its picture; None if no part of it is visible."""
    assert picture.subject_visible_box is not None
    assert picture.subject_pixels is not None
    visible, whole = picture.subject_pixels[view].tolist()
    if not visible:
        return None
    height, width = _size_of(picture)
    left, top, right, bottom = picture.subject_visible_box[view].tolist()
    box = left / width, top / height, right / width, bottom / height
    return Sighting(*box, visible / max(whole, 1))


def _size_of(picture: Picture) -> tuple[int, int]:
    planes: list[NDArray[np.generic] | None] = [picture.rgb, picture.class_id]
    height, width = next(plane for plane in planes if plane is not None).shape[1:3]
    return height, width
