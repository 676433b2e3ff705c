"""The car: an ideal robot that keeps its height over the ground, with a camera at its origin.

It has no physics and no body that others see, and follows its commands as the supervised drone
does. On hills it follows the ground below it. A command upwards changes its height, down to the
ground.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.engine.state.terrain import Terrain, ground_at
from eyas.engine.trackers.commands import CommandFilters, follow_command
from eyas.engine.trackers.drone import move_level, obey, place
from eyas.engine.trackers.gimbal import CAR_LIMITS, advance_gimbal, camera_axes, reset_gimbal
from eyas.engine.trackers.tracker import Tracker
from eyas.lanes import kernel


class CarMemory(NamedTuple):
    """What N cars remember: their filters, and the ground below them."""

    filters: CommandFilters
    terrain: Terrain

    @classmethod
    def create(cls, count: int, terrain: Terrain) -> "CarMemory":
        """Return the memory of cars at rest."""
        return cls(CommandFilters.create(count), terrain)


@kernel(inline=True)
def start(
    trackers: TrackerState,
    memory: CarMemory,
    n: int,
    x: float,
    y: float,
    z: float,
    yaw: float,
    pitch: float,
) -> None:
    """Place car `n` at rest, see `Tracker.start`; not below the ground."""
    z = max(z, ground_at(memory.terrain, x, y))
    place(trackers, memory.filters, n, x, y, z, yaw)
    reset_gimbal(trackers, memory.filters.gimbal, n, pitch, 0.0, CAR_LIMITS)


@kernel(inline=True)
def advance(
    trackers: TrackerState, memory: CarMemory, n: int, command: NDArray[np.float64]
) -> None:
    """Move car `n` by one physics step of 2 ms, see `Tracker.advance`."""
    commanded, terrain = trackers.commanded_position[n], memory.terrain
    before = ground_at(terrain, commanded[0], commanded[1])
    _, _, yaw_rate = follow_command(trackers, memory.filters, n, command)
    ground = ground_at(terrain, commanded[0], commanded[1])
    commanded[2] = max(commanded[2] + (ground - before), ground)
    obey(trackers, n, yaw_rate)
    advance_gimbal(trackers, memory.filters.gimbal, n, CAR_LIMITS)


@kernel(inline=True)
def carry(
    trackers: TrackerState, memory: CarMemory, n: int, x: float, y: float, z: float, yaw: float
) -> None:
    """Move car `n` to a pose within one physics step of 2 ms; not below the ground."""
    z = max(z, ground_at(memory.terrain, x, y))
    move_level(trackers, n, x, y, z, yaw)
    advance_gimbal(trackers, memory.filters.gimbal, n, CAR_LIMITS)


@kernel(inline=True)
def aim(trackers: TrackerState, memory: CarMemory, cameras: CameraState, n: int) -> None:
    """Write the pose of the camera: at the origin of the body, turned by its gimbal."""
    for axis in range(3):
        cameras.position[n, axis] = trackers.position[n, axis]
    camera_axes(trackers.orientation[n], trackers.gimbal[n], cameras.rotation[n])


CAR = Tracker("car", CarMemory.create, start, advance, carry, aim, visible=False, judged=False)
"""The ideal car."""
