"""The overlay of a tracker: its view, its reward and its target, placed in the world."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.frames import rotate
from eyas.engine.overlay.bodies import GEM_GIRDLE, GEM_RADIUS, drone, gem
from eyas.engine.overlay.items import GroundArea, Label, Overlay, ThinLine
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Plane, Terrain, plane_at
from eyas.engine.task.ground import ground_corners, on_plane
from eyas.engine.task.reward import axis_depth, view_centre
from eyas.engine.task.rules import BuiltinReward, Rules
from eyas.lanes import exact, interpreted

__all__ = ["Marks"]

_plane_at, _axis_depth = interpreted(plane_at), interpreted(axis_depth)
_view_centre, _rotated = interpreted(view_centre), interpreted(rotate)

VIEW_COLOUR = (0.25, 0.8, 1.0)
LABEL_COLOUR = (1.0, 1.0, 1.0)
REWARD_COLOURS = ((0.95, 0.26, 0.2), (1.0, 0.78, 0.12), (0.35, 0.9, 0.3))
"""Colours for a reward of 0, 0.5 and 1."""

FARTHEST = 400.0  # Depth at which a view that extends above the horizon is cut off [m]

GEM_HEIGHT, GEM_GAP, GEM_TURN = 1.3, 0.4, 1.5
"""Heights of the marker and of the gap below it [m]; turn rate of the marker [rad/s]."""

UP = np.array([0.0, 0.0, 1.0])

CIRCLE = 72  # Number of corners of the circle within which distances are rewarded


class Marks:
    """Makes the overlays of trackers in their current state.

    Args:
        snapshot: The trackers and their targets.
        terrain: The ground.
        camera: Shape of the pictures.
    """

    def __init__(self, snapshot: Snapshot, terrain: Terrain, camera: CameraConfig) -> None:
        self._snapshot = snapshot
        self._terrain = terrain
        self._aspect = camera.height / camera.width

    def of(self, main: int, rules: Rules, trackers: Sequence[int] | None = None) -> Overlay:
        """Return the overlay of trackers in one world.

        For each tracker it shows the ground that the camera sees, the ground on which a target is
        rewarded (the colour shows the reward), a gem over the target with the reward beside it, and
        the drone with the edges of its view.

        Args:
            main: The tracker whose reward is shown even if its target is outside the picture.
            rules: Rules of the reward.
            trackers: The trackers; None: `main` without its drone, for its own camera's picture.
        """
        parts = [self._marks(n, rules, always=n == main) for n in (trackers or (main,))]
        parts += [self._drone(n) for n in trackers or ()]
        return Overlay(
            areas=tuple(area for part in parts for area in part.areas),
            lines=tuple(line for part in parts for line in part.lines),
            solids=tuple(solid for part in parts for solid in part.solids),
            labels=tuple(label for part in parts for label in part.labels),
        )

    def _marks(self, n: int, rules: Rules, *, always: bool) -> Overlay:
        """Return view, rewarded area, target and reward of a tracker; the reward `always` shown."""
        episodes, targets = self._snapshot.episodes, self._snapshot.targets
        reward = float(episodes.reward[n])
        ground, tip = self._ground(n), self._top_of_target(n) + GEM_GAP * UP
        turn = GEM_TURN * float(episodes.tick[n]) * PHYSICS_STEP
        return Overlay(
            areas=(
                GroundArea(self._rewarded(n, rules), ground, _colour_of(reward), fill=0.14),
                GroundArea(self._seen(n), ground, VIEW_COLOUR),
            ),
            solids=() if targets.lost[n] else (gem(tip, GEM_HEIGHT, turn),),
            labels=(
                Label(
                    anchor=tip + GEM_GIRDLE * GEM_HEIGHT * UP,
                    text=f"reward {reward:.2f}",
                    colour=LABEL_COLOUR,
                    clear=GEM_RADIUS * GEM_HEIGHT,
                    always=always,
                ),
            ),
        )

    def _drone(self, n: int) -> Overlay:
        """Return a drone, and the edges of its view."""
        trackers, eye = self._snapshot.trackers, self._snapshot.cameras.position[n]
        return Overlay(
            lines=tuple(ThinLine(eye, end, VIEW_COLOUR) for end in self._seen(n)),
            solids=(drone(trackers.position[n], _rotation(trackers.orientation[n])),),
        )

    def _ground(self, n: int) -> Plane:
        """Return the plane tangent to the ground under a target."""
        x, y, _ = self._snapshot.targets.centre[n]
        return _plane_at(self._terrain, x, y)

    def _seen(self, n: int) -> NDArray[np.float64]:
        """Return the corners of the ground that a camera sees [m], shape (K, 3)."""
        return self._corners(n, 1.0)

    def _corners(self, n: int, share: float) -> NDArray[np.float64]:
        """Return the corners of the ground that a share of a picture's sides shows."""
        cameras = self._snapshot.cameras
        half_width = share * exact.tan(0.5 * float(cameras.field_of_view[n]))
        half_size = half_width, half_width * self._aspect
        return ground_corners(
            cameras.position[n], cameras.rotation[n], half_size, self._ground(n), FARTHEST
        )

    def _rewarded(self, n: int, rules: Rules) -> NDArray[np.float64]:
        """Return the corners of the ground on which a target is rewarded [m], shape (K, 3)."""
        eye, rotation = self._snapshot.cameras.position[n], self._snapshot.cameras.rotation[n]
        ground = self._ground(n)
        depth = _axis_depth(eye, rotation, ground)
        if depth <= 0.0:
            return np.zeros((0, 3))
        if rules.reward not in (BuiltinReward.DISTANCE_CONTINUOUS, BuiltinReward.DISTANCE_DISCRETE):
            return self._corners(n, rules.view_range)
        angles = np.arange(CIRCLE) * (2.0 * np.pi / CIRCLE)
        circle: NDArray[np.float64] = np.column_stack([exact.cos(angles), exact.sin(angles)])
        return on_plane(ground, rules.distance_range * circle + _view_centre(eye, rotation, depth))

    def _top_of_target(self, n: int) -> NDArray[np.float64]:
        """Return the point on top of the middle of a target, world frame [m], shape (3,)."""
        targets = self._snapshot.targets
        top: NDArray[np.float64] = targets.centre[n].copy()
        top[2] += targets.size[n, 2] - targets.rise[n]
        return top


def _colour_of(reward: float) -> tuple[float, float, float]:
    low, middle, high = np.array(REWARD_COLOURS)
    colour = np.interp(reward, (0.0, 0.5, 1.0), (0.0, 1.0, 2.0))
    mixed = low + (middle - low) * min(colour, 1.0) + (high - middle) * max(colour - 1.0, 0.0)
    return float(mixed[0]), float(mixed[1]), float(mixed[2])


def _rotation(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation body to world, shape (3, 3), of a quaternion w, x, y, z."""
    return np.stack([np.array(_rotated(quaternion, *axis)) for axis in np.eye(3)], axis=1)
