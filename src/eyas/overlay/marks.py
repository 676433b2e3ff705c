"""What an overlay shows of a tracker: its view, its reward and its target, in the world."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.frames import rotate
from eyas.overlay.bodies import GEM_GIRDLE, GEM_RADIUS, drone, gem
from eyas.overlay.items import GroundArea, Label, Line, Overlay
from eyas.sensors.config import CameraConfig
from eyas.sim.fleet import Fleet
from eyas.sim.worlds import Worlds
from eyas.state.tracker import CameraPose
from eyas.targets.catalogue import VEHICLES
from eyas.task.columns import REWARD
from eyas.task.ground import ground_corners
from eyas.task.reward import axis_depth, view_centre
from eyas.task.rules import Rules

__all__ = ["Projection", "chase_pose"]

VIEW_COLOUR = (0.25, 0.8, 1.0)
LABEL_COLOUR = (1.0, 1.0, 1.0)
REWARD_COLOURS = ((0.95, 0.26, 0.2), (1.0, 0.78, 0.12), (0.35, 0.9, 0.3))
"""For a reward of 0, 0.5 and 1."""

FARTHEST = 400.0
"""Depth at which a view that reaches above the horizon is cut off [m]."""

GEM_HEIGHT, GEM_GAP, GEM_TURN = 1.3, 0.4, 1.5
"""Of the marker and of the gap below it [m]; how fast it turns [rad/s]."""

UP = np.array([0.0, 0.0, 1.0])

CIRCLE = 72
"""Corners of the circle within which distances are rewarded."""


class Projection:
    """Tells what to draw for trackers as they are now.

    Args:
        fleet: The trackers.
        rules: Of the reward.
        camera: Of each tracker.
        worlds: Knows what the targets are.
    """

    def __init__(self, fleet: Fleet, rules: Rules, camera: CameraConfig, worlds: Worlds) -> None:
        half_width = math.tan(0.5 * camera.field_of_view)
        half_height = half_width * camera.height / camera.width
        self._fleet = fleet
        self._rules = rules
        self._whole = rules._replace(half_width=half_width, half_height=half_height)
        self._worlds = worlds

    def of(self, main: int, trackers: Sequence[int] | None = None) -> Overlay:
        """Return what to draw for trackers in one world.

        For each the ground that its camera sees, the ground on which a target is rewarded (its
        colour tells the reward), a gem over its target with the reward beside it, and the drone
        itself with the edges of its view.

        Args:
            main: Whose reward is told even where its target is outside the picture.
            trackers: Which; None: `main`, without the drone, for the picture of its own camera.
        """
        parts = [self._marks(n, always=n == main) for n in (trackers or (main,))]
        parts += [self._drone(n) for n in trackers or ()]
        return Overlay(
            areas=tuple(area for part in parts for area in part.areas),
            lines=tuple(line for part in parts for line in part.lines),
            solids=tuple(solid for part in parts for solid in part.solids),
            labels=tuple(label for part in parts for label in part.labels),
        )

    def _marks(self, n: int, *, always: bool) -> Overlay:
        """Return view, range and target of a tracker, and its reward, seen `always`."""
        reward = float(self._fleet.task_memory[n, REWARD])
        ground, tip = self._rules.ground, self._top_of_target(n) + GEM_GAP * UP
        turn = GEM_TURN * float(self._fleet.tick[n]) * PHYSICS_STEP
        return Overlay(
            areas=(
                GroundArea(self._rewarded(n), ground, _colour_of(reward), fill=0.14),
                GroundArea(self._seen(n), ground, VIEW_COLOUR),
            ),
            solids=() if self._fleet.target_lost[n] else (gem(tip, GEM_HEIGHT, turn),),
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
        fleet, seen = self._fleet, self._seen(n)
        ends = np.column_stack([seen, np.full(len(seen), self._rules.ground)])
        return Overlay(
            lines=tuple(Line(fleet.camera_position[n], end, VIEW_COLOUR) for end in ends),
            solids=(drone(fleet.position[n], _rotation(fleet.orientation[n])),),
        )

    def _seen(self, n: int) -> NDArray[np.float64]:
        """Return the corners of the ground that a camera sees [m], shape (K, 2)."""
        eye, rotation = self._fleet.camera_position[n], self._fleet.camera_rotation[n]
        return ground_corners(eye, rotation, self._whole, FARTHEST)

    def _rewarded(self, n: int) -> NDArray[np.float64]:
        """Return the corners of the ground on which a target is rewarded [m], shape (K, 2)."""
        eye, rotation = self._fleet.camera_position[n], self._fleet.camera_rotation[n]
        depth = axis_depth(eye, rotation, self._rules.ground)
        if depth <= 0.0:
            return np.zeros((0, 2))
        if not self._rules.distance:
            return ground_corners(eye, rotation, self._rules, FARTHEST)
        angles = np.arange(CIRCLE) * (2.0 * np.pi / CIRCLE)
        circle: NDArray[np.float64] = np.column_stack([np.cos(angles), np.sin(angles)])
        return self._rules.distance_range * circle + view_centre(eye, rotation, depth)

    def _top_of_target(self, n: int) -> NDArray[np.float64]:
        """Return the point on top of the middle of a target, world frame [m], shape (3,)."""
        model = VEHICLES[self._worlds.model_of(n, int(self._fleet.target_actor[n]))]
        top: NDArray[np.float64] = self._fleet.target_centre[n].copy()
        top[2] += model.size[2] - model.wheel_radius
        return top


def chase_pose(
    trackers: CameraPose, back: float = 6.0, up: float = 2.5, pitch: float = 0.78
) -> CameraPose:
    """Return viewpoints behind and above cameras, from which they and their ground are seen.

    Walls between are not avoided.

    Args:
        trackers: The cameras that are followed, N of them.
        back: How far behind, against their heading [m].
        up: How far above [m].
        pitch: Of the viewpoint, positive down [rad].
    """
    level = trackers.rotation[:, :2, 0] + 1e-9 * trackers.rotation[:, :2, 2]
    level = level / np.linalg.norm(level, axis=1, keepdims=True)
    ahead = np.pad(level, ((0, 0), (0, 1)))
    left = np.cross(UP, ahead)
    forward = math.cos(pitch) * ahead - math.sin(pitch) * UP
    return CameraPose(
        position=trackers.position - back * ahead + up * UP,
        rotation=np.stack([forward, left, np.cross(forward, left)], axis=2),
    )


def _colour_of(reward: float) -> tuple[float, float, float]:
    low, middle, high = np.array(REWARD_COLOURS)
    colour = np.interp(reward, (0.0, 0.5, 1.0), (0.0, 1.0, 2.0))
    mixed = low + (middle - low) * min(colour, 1.0) + (high - middle) * max(colour - 1.0, 0.0)
    return float(mixed[0]), float(mixed[1]), float(mixed[2])


def _rotation(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return body to world, shape (3, 3), of a quaternion w, x, y, z."""
    return np.stack([np.array(rotate(quaternion, *axis)) for axis in np.eye(3)], axis=1)
