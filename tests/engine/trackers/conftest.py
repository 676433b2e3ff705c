from types import SimpleNamespace

import numpy as np
import pytest

from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.engine.trackers.drone import DRONE

COUNT, N = 3, 1


class Drone:
    """Drone 1 of 3: all their states, and views of its own row in `rows`."""

    def __init__(self):
        self.trackers = TrackerState.create(COUNT)
        self.memory = DRONE.memory(COUNT, Terrain.flat(0.0))
        self.cameras = CameraState.create(COUNT)
        named = self.trackers._asdict().items()
        self.rows = SimpleNamespace(**{name: rows[N] for name, rows in named if rows.ndim > 1})

    def start(self, x=0.0, y=0.0, z=20.0, yaw=0.0, pitch=1.0):
        DRONE.start(self.trackers, self.memory, N, x, y, z, yaw, pitch)
        return self.rows

    def advance(self, forward=0.0, left=0.0, up=0.0, yaw_rate=0.0, steps=1):
        for _ in range(steps):
            command = np.array([forward, left, up, yaw_rate])
            DRONE.advance(self.trackers, self.memory, N, command)
        return self.rows

    def carry(self, x, y, z, yaw):
        DRONE.carry(self.trackers, self.memory, N, x, y, z, yaw)
        return self.rows

    def aim(self):
        DRONE.aim(self.trackers, self.memory, self.cameras, N)
        return self.cameras.position[N], self.cameras.rotation[N]

    def arrays(self):
        """All arrays of its trackers, leading axis 3."""
        return [*self.trackers, *self.memory, *self.cameras]


@pytest.fixture
def drone():
    return Drone()
