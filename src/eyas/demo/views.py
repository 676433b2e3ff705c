"""The pictures of the demo: the drone's camera, from behind the drone, and from above."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.demo.flight import DemoFlight
from eyas.engine.core.optics.pinhole import field_along, project
from eyas.engine.overlay.marks import Marks
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import CameraState

CHASE = (9.0, 4.0)  # Distance of the camera behind the drone, and above it [m]
ABOVE = 60.0  # Height above the drone of the camera that looks down [m]
OUTSIDE_FIELD = 1.0  # Horizontal field of view of cameras outside [rad]
NEAR = 0.2  # What is nearer to the camera is cut off marks [m]
CLOSE = 0.03  # Largest distance of an actor from a click, as a share of the width


ROUND = np.linspace(0.0, 2.0 * math.pi, 12, endpoint=False)


def _disc(x: float, y: float, radius: tuple[float, float], z: float) -> NDArray[np.float64]:
    """Return the rim of a flat disc in the body's frame [m], shape (K, 3)."""
    east, north = x + radius[0] * np.cos(ROUND), y + radius[1] * np.sin(ROUND)
    return np.column_stack([east, north, np.full(len(ROUND), z)])


_BODY = (
    _disc(0.0, 0.0, (0.22, 0.13), 0.0),
    _disc(0.17, 0.0, (0.06, 0.06), 0.0),
    *(_disc(x, y, (0.2, 0.2), 0.06) for x in (-0.3, 0.3) for y in (-0.3, 0.3)),
)
"""Outlines of the drone [m], a little larger than it is, to be visible from far."""
FROM_ABOVE = 2.5  # Factor on that in the view from above


class Screen:
    """Draws what viewers see of a flight, in any size: `drone`, `chase` or `top`."""

    def __init__(self, flight: DemoFlight) -> None:
        self._flight = flight
        self.view = "drone"
        self._picture = Picture.create(1, 8, 8)
        assets, config = flight.world.assets, flight.config
        self._marks = Marks(flight.simulation.snapshot, assets.scene.terrain, config.camera)

    def draw(self, width: int, height: int) -> NDArray[np.uint8]:
        """Return the picture, shape (height, width, 3); the next call overwrites it."""
        if self._picture.rgb is None or self._picture.rgb.shape[1:3] != (height, width):
            self._picture = Picture.create(1, height, width)
        picture, chosen = self._picture, np.zeros(1, np.int32)
        cameras = self.cameras(width, height)
        self._flight.simulation.draw_from(chosen, cameras, picture, overlay=False)
        assert picture.rgb is not None
        rgb: NDArray[np.uint8] = picture.rgb[0]
        return rgb

    def cameras(self, width: int, height: int) -> CameraState:
        """Return the camera of the view; the drone's shows at least what its own picture has."""
        _, own, _, _, _ = self._flight.simulation.snapshot
        if self.view == "drone":
            config = self._flight.config.camera
            wider = max(1.0, (width / height) * (config.height / config.width))
            field = field_along(float(own.field_of_view[0]), wider)
            return own._replace(field_of_view=np.array([field]))
        position, rotation = self._outside()
        return CameraState(position[None], rotation[None], np.array([OUTSIDE_FIELD]))

    def _outside(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        trackers = self._flight.simulation.snapshot.trackers
        place, yaw = trackers.position[0], float(trackers.euler[0, 2])
        ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
        if self.view == "top":
            forward, up = np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])
            axes = np.column_stack([forward, np.cross(up, forward), up])
            return place + np.array([0.0, 0.0, ABOVE]), axes
        eye = place - CHASE[0] * ahead + np.array([0.0, 0.0, CHASE[1]])
        forward = place + 6.0 * ahead - np.array([0.0, 0.0, 5.0]) - eye
        forward /= np.linalg.norm(forward)
        left = np.cross([0.0, 0.0, 1.0], ahead)
        return eye, np.column_stack([forward, left, np.cross(forward, left)])

    def marks(self, width: int, height: int) -> dict[str, Any]:
        """Return the overlay as lines in shares of the picture's sides, for the page to draw."""
        cameras = self.cameras(width, height)
        snapshot, rules = self._flight.simulation.snapshot, self._flight.simulation.rules
        overlay = self._marks.of(0, rules)
        target = snapshot.targets.centre[0]
        top = target + np.array([0.0, 0.0, snapshot.targets.size[0, 2] - snapshot.targets.rise[0]])
        reward, seen = (_outline(area.corners, cameras, width, height) for area in overlay.areas)
        points = np.stack([snapshot.episodes.view_centre[0], target, top])
        centre, middle, tip = _points(points, cameras, width, height)
        eye = snapshot.cameras.position[0]
        edges = overlay.areas[1].corners if self.view != "drone" else ()
        lines = [
            _outline(np.stack([eye, end]), cameras, width, height, closed=False) for end in edges
        ]
        return {
            "reward": reward,
            "seen": seen,
            "centre": centre,
            "target": middle,
            "tip": tip,
            "lines": lines,
        }

    def body(self, width: int, height: int) -> list[list[list[float]]] | None:
        """Return outlines of the drone in shares of the picture's sides: body, nose, rotors.

        None from its own camera. The page draws them: painting its faces takes five times as long
        as the whole picture.
        """
        if self.view == "drone":
            return None
        trackers = self._flight.simulation.snapshot.trackers
        yaw = float(trackers.euler[0, 2])
        turn = np.array(
            [[math.cos(yaw), math.sin(yaw), 0], [-math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]]
        )
        if self.view == "top":
            turn *= FROM_ABOVE
        cameras = self.cameras(width, height)
        return [
            _outline(trackers.position[0] + part @ turn, cameras, width, height) for part in _BODY
        ]

    def actor_at(
        self,
        x: float,  # From the left edge, in shares of the width
        y: float,  # From the upper edge, in shares of the height
        width: int,  # Of the picture [pixels]
        height: int,  # Of the picture [pixels]
    ) -> int | None:
        """Return the actor nearest to a place in the picture, if one is close."""
        picture = Picture.create(1, height, width, object_id=True)
        cameras = self.cameras(width, height)
        self._flight.simulation.draw_from(np.zeros(1, np.int32), cameras, picture, overlay=False)
        assert picture.object_id is not None
        rows, columns = np.nonzero(picture.object_id[0] >= ACTOR_OBJECT)
        if not len(rows):
            return None
        away = np.hypot(columns + 0.5 - x * width, rows + 0.5 - y * height)
        nearest = int(away.argmin())
        if away[nearest] > CLOSE * width:
            return None
        actor = int(picture.object_id[0][rows[nearest], columns[nearest]]) - ACTOR_OBJECT
        return actor if actor < self._flight.simulation.actors else None


def _outline(
    corners: NDArray[np.float64],
    cameras: CameraState,
    width: int,
    height: int,
    *,
    closed: bool = True,
) -> list[list[float]]:
    """Return a polygon or a line in the picture, without what is behind the camera."""
    kept = _in_front(corners, cameras, closed=closed)
    found = _points(kept, cameras, width, height)
    return [point for point in found if point is not None]


def _in_front(
    corners: NDArray[np.float64], cameras: CameraState, *, closed: bool
) -> NDArray[np.float64]:
    """Return the part of a polygon or a line that is before the camera, shape (K, 3)."""
    depth = (corners - cameras.position[0]) @ cameras.rotation[0, :, 0] - NEAR
    kept: list[NDArray[np.float64]] = []
    for i, corner in enumerate(corners):
        if depth[i] >= 0.0:
            kept.append(corner)
        j = (i + 1) % len(corners)
        if (depth[i] >= 0.0) != (depth[j] >= 0.0) and (closed or j > i):
            kept.append(corner + depth[i] / (depth[i] - depth[j]) * (corners[j] - corner))
    return np.array(kept).reshape(-1, 3)


def _points(
    points: NDArray[np.float64], cameras: CameraState, width: int, height: int
) -> list[list[float] | None]:
    """Return places in shares of the picture's sides; None for points behind the camera."""
    field = float(cameras.field_of_view[0])
    position, rotation = cameras.position[0], cameras.rotation[0]
    columns, rows, depths = project(points, position, rotation, width, height, field)
    return [
        [round(float(column) / width, 4), round(float(row) / height, 4)] if depth > 0.0 else None
        for column, row, depth in zip(columns, rows, depths, strict=True)
    ]
