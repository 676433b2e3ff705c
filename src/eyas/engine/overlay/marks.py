"""The overlay of a tracker: its view, its reward and its target, placed in the world, with the
bodies that only an overlay shows (the marker over the target, the drone).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.frames import rotate
from eyas.engine.mesh.panels import cells, closed, fan, halves
from eyas.engine.overlay.items import GroundArea, Label, Overlay, Solid, ThinLine
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Plane, Terrain
from eyas.engine.task.ground import ground_corners, on_plane
from eyas.engine.task.observe import target_plane
from eyas.engine.task.reward import axis_depth, view_centre
from eyas.engine.task.rules import BuiltinReward, Rules
from eyas.lanes import exact, interpreted

DRONE_SIZE = 0.5
"""Distance between neighbouring motors [m]; larger than the real one, to be visible from far."""

GEM_SIDES = 6
GEM_RADIUS, GEM_GIRDLE = 0.42, 0.7  # Radius and height of its widest ring, as shares of its height
GEM_COLOUR = (1.0, 0.27, 0.5)
TABLE_COLOUR = (1.0, 0.5, 0.66)
BODY_COLOUR = (0.93, 0.94, 0.96)
ARM_COLOUR = (0.25, 0.27, 0.3)
ROTOR_COLOUR = (0.5, 0.54, 0.58)
NOSE_COLOUR = (1.0, 0.6, 0.1)

Triangles = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Corners [m], shape (T, 3, 3), and colours, shape (T, 3)."""


def gem(
    tip: NDArray[np.float64],  # Its lowest point, world frame [m], shape (3,)
    height: float,  # Height of the gem [m]
    turn: float,  # Rotation about its axis [rad]
) -> Solid:
    """Return a cut gem, standing on its tip."""
    angles = turn + np.arange(GEM_SIDES) * (2.0 * np.pi / GEM_SIDES)
    girdle = np.column_stack([exact.cos(angles), exact.sin(angles), np.ones(GEM_SIDES)])
    girdle *= GEM_RADIUS, GEM_RADIUS, GEM_GIRDLE
    table = girdle * (0.55, 0.55, 1.0 / GEM_GIRDLE)
    parts = [
        _coloured(fan(girdle[::-1], (0.0, 0.0, 0.0)), GEM_COLOUR),
        _coloured(_skin(girdle, table), GEM_COLOUR),
        _coloured(fan(table, (0.0, 0.0, 1.0)), TABLE_COLOUR),
    ]
    return _solid(parts, np.eye(3) * height, tip)


def drone(
    position: NDArray[np.float64],  # Its middle, world frame [m], shape (3,)
    rotation: NDArray[np.float64],  # Body to world, shape (3, 3)
) -> Solid:
    """Return a quadrotor."""
    parts = [
        _prism(8, (0.0, 0.0), (0.3, 0.17), (-0.09, 0.07), BODY_COLOUR),
        _prism(8, (0.24, 0.0), (0.07, 0.08), (-0.05, 0.03), NOSE_COLOUR),
        _prism(6, (0.16, 0.0), (0.06, 0.06), (-0.2, -0.09), ARM_COLOUR),
    ]
    for x in (-1.0, 1.0):
        for y in (-1.0, 1.0):
            motor = 0.5 * np.array([x, y])
            parts.append(_arm(motor, ARM_COLOUR))
            parts.append(_prism(8, tuple(motor), (0.05, 0.05), (-0.03, 0.1), ARM_COLOUR))
            parts.append(_prism(14, tuple(motor), (0.27, 0.27), (0.1, 0.115), ROTOR_COLOUR))
    return _solid(parts, rotation * DRONE_SIZE, position)


def _solid(
    parts: list[Triangles], axes: NDArray[np.float64], position: NDArray[np.float64]
) -> Solid:
    corners = np.concatenate([part[0] for part in parts]).reshape(-1, 3)
    return Solid(
        positions=exact.product(corners, axes.T) + position,
        triangles=np.arange(len(corners), dtype=np.int32).reshape(-1, 3),
        colours=np.concatenate([part[1] for part in parts]),
    )


def _coloured(corners: NDArray[np.float64], colour: tuple[float, float, float]) -> Triangles:
    return corners, np.tile(colour, (len(corners), 1))


def _prism(
    sides: int,
    middle: tuple[float, ...],
    radius: tuple[float, float],
    span: tuple[float, float],
    colour: tuple[float, float, float],
) -> Triangles:
    """Return an upright prism, given middle and radii along x and y, lowest and highest z."""
    angles = (np.arange(sides) + 0.5) * (2.0 * np.pi / sides)
    ring = np.column_stack(
        [
            middle[0] + radius[0] * exact.cos(angles),
            middle[1] + radius[1] * exact.sin(angles),
            np.full(sides, span[0]),
        ]
    )
    return _closed(ring, span[1] - span[0], colour)


def _arm(motor: NDArray[np.float64], colour: tuple[float, float, float]) -> Triangles:
    """Return a bar from the middle to a motor."""
    along = motor / exact.hypot(*motor)
    side = 0.035 * np.array([-along[1], along[0]])
    ring = np.zeros((4, 3))
    ring[:, :2] = -side, motor - side, motor + side, side
    ring[:, 2] = -0.03
    return _closed(ring, 0.05, colour)


def _closed(
    ring: NDArray[np.float64], height: float, colour: tuple[float, float, float]
) -> Triangles:
    """Return the closed body on a convex ring, with lid and floor."""
    lid = ring.copy()
    lid[:, 2] += height
    low, high = ring.mean(axis=0), lid.mean(axis=0)
    faces = [_skin(ring, lid), fan(lid, tuple(high)), fan(ring[::-1], tuple(low))]
    return _coloured(np.concatenate(faces), colour)


def _skin(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the wall between two rings that run counter-clockwise seen from above."""
    return halves(cells(closed([low, high])))


_target_plane, _axis_depth = interpreted(target_plane), interpreted(axis_depth)
_view_centre, _rotated = interpreted(view_centre), interpreted(rotate)

VIEW_COLOUR = (0.25, 0.8, 1.0)  # sRGB, as all colours here
LABEL_COLOUR = (1.0, 1.0, 1.0)
REWARD_COLOURS = ((0.95, 0.26, 0.2), (1.0, 0.78, 0.12), (0.35, 0.9, 0.3))
"""Colours for a reward of 0, 0.5 and 1."""

FARTHEST = 400.0  # Depth at which a view that extends above the horizon is cut off [m]
GEM_HEIGHT, GEM_GAP, GEM_TURN = 1.3, 0.4, 1.5
"""Heights of the marker and of the gap below it [m]; turn rate of the marker [rad/s]."""

UP = np.array([0.0, 0.0, 1.0])
CIRCLE = 72  # Number of corners of the circle within which distances are rewarded


class Marks:
    """Makes the overlays of trackers in their current state."""

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
        """Return the plane of a target, see `target_plane`."""
        return _target_plane(self._snapshot.targets, n, self._terrain)

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
