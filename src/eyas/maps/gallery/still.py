"""Viewpoints of the gallery, and their pictures."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.optics.pinhole import field_along
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ACTOR_OBJECT, Colliders, ObjectClass


def solids(colliders: Colliders) -> Iterator[tuple[shapely.Polygon, float, float]]:
    """Yield outline, bottom and top of each solid prism [m]."""
    first = colliders.prism_first
    for index, bottom in enumerate(colliders.prism_bottom):
        corners = colliders.prism_points[first[index] : first[index + 1]]
        yield shapely.Polygon(corners), float(bottom), float(colliders.prism_top[index])


def is_inside(colliders: Colliders, position: tuple[float, float, float]) -> bool:
    """Return whether a position is inside a solid."""
    x, y, z = position
    return any(
        bottom <= z <= top and bool(shapely.contains_xy(outline, x, y))
        for outline, bottom, top in solids(colliders)
    )


_SIGHTS = (ObjectClass.ROAD, ObjectClass.TREE, ObjectClass.WATER, ObjectClass.BUILDING,
           ObjectClass.STRUCTURE)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """A camera and the time of the traffic that it shows."""

    name: str  # Name of the picture file, without its extension
    title: str  # Short title
    caption: str  # Description of the picture
    time: float  # Time of the traffic [s]
    position: tuple[float, float, float]  # Optical centre, world frame [m]
    yaw: float  # Counter-clockwise from east [rad]
    pitch: float  # Positive down [rad]
    field_of_view: float  # Horizontal [rad]; the view is 4:3 whatever shape the picture has
    actor: int = -1  # The car that the picture is meant to show, or -1
    size: tuple[int, int] = (480, 640)  # Height and width of the picture [pixels]
    samples: int = 4  # Samples for each pixel
    enlarged: int = 1  # Factor by which the finished picture is enlarged, without smoothing


class StillScene:
    """Draws viewpoints."""

    def __init__(
        self,
        assets: Assets,  # Map, traffic and renderer
    ) -> None:
        self.scene = assets.scene
        self.duration = assets.traffic.duration
        self._world = StillWorld(assets)

    def actors(self, time: float) -> ActorState:
        """Return all actors at a time [s], one world."""
        return self._world.actors(time)

    def rgb(self, view: Viewpoint) -> NDArray[np.uint8]:
        """Return the picture of a viewpoint, sRGB, shape (H, W, 3) times `enlarged`."""
        picture = Picture.create(1, *view.size)
        self._draw(view, picture, view.samples)
        assert picture.rgb is not None  # set above
        return np.repeat(np.repeat(picture.rgb[0], view.enlarged, 0), view.enlarged, 1)

    def probe(self, view: Viewpoint) -> tuple[NDArray[np.float32], float]:
        """Return depths and the visibility of the car, from a small picture.

        Returns:
            Depths [m], infinity for sky, shape (48, 64), and the visible share of the
            viewpoint's car, 0 to 1; 0 if it is outside the picture.
        """
        picture = Picture.create(1, 48, 64, rgb=False, depth=True, subject=True)
        self._draw(view, picture, 1)
        assert picture.depth is not None  # set above
        assert picture.subject_pixels is not None
        seen, covered = picture.subject_pixels[0]
        return picture.depth[0], seen / covered if covered else 0.0

    def sights(self, view: Viewpoint) -> float:
        """Return how much is in a view: shares of what is not ground, an eighth each at most."""
        picture = Picture.create(1, 48, 64, rgb=False, class_id=True)
        self._draw(view, picture, 1)
        assert picture.class_id is not None  # set above
        count = np.bincount(picture.class_id.ravel(), minlength=len(ObjectClass))
        shares = count[list(_SIGHTS)] / picture.class_id.size
        return float(np.minimum(shares, 0.125).sum())

    def contrast(self, view: Viewpoint) -> float:
        """Return how much the lower half of a view differs within its rows, in sRGB levels."""
        picture = Picture.create(1, 48, 64)
        self._draw(view, picture, 4)
        assert picture.rgb is not None  # set above
        low = picture.rgb[0, 24:].astype(np.float64)
        return float((low - low.mean(axis=1, keepdims=True)).std())

    def _draw(self, view: Viewpoint, picture: Picture, samples: int) -> None:
        subject = ACTOR_OBJECT + view.actor if view.actor >= 0 else -1
        views = Views(
            position=np.array([view.position]),
            rotation=_look(view.yaw, view.pitch)[None],
            world=np.zeros(1, np.int32),
            subject=np.array([subject], np.int32),
            field_of_view=view.field_of_view,
            vertical_field_of_view=field_along(view.field_of_view, 0.75),
            instant=np.array([view.time]),
        )
        self._world.draw(views, view.time, picture, samples)


def _look(yaw: float, pitch: float) -> NDArray[np.float64]:
    """Return the rotation camera to world; columns are forward, left, up."""
    level = math.cos(pitch)
    forward = np.array([math.cos(yaw) * level, math.sin(yaw) * level, -math.sin(pitch)])
    left = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
    return np.stack([forward, left, np.cross(forward, left)], axis=1)
