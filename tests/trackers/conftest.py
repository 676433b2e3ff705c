from types import SimpleNamespace

import numpy as np
import pytest

from eyas.state.tracker import TrackerState
from eyas.trackers.columns import MEMORY_COLUMNS
from eyas.trackers.drone import advance_drone, reset_drone


class Drone:
    """One drone: the rows of a state, and the kernels called on them."""

    def __init__(self):
        state = TrackerState.create(1)
        self.memory = np.zeros(MEMORY_COLUMNS)
        self.rows = SimpleNamespace(**{name: getattr(state, name)[0] for name in state.__slots__})

    def _body(self):
        r = self.rows
        return (
            self.memory, r.position, r.velocity, r.acceleration,
            r.orientation, r.euler, r.angular_velocity, r.commanded_position,
        )  # fmt: skip

    def reset(self, x=0.0, y=0.0, z=20.0, yaw=0.0):
        reset_drone(x, y, z, yaw, *self._body())
        return self.rows

    def advance(self, forward=0.0, left=0.0, up=0.0, yaw_rate=0.0, steps=1):
        for _ in range(steps):
            advance_drone(np.array([forward, left, up, yaw_rate]), *self._body())
        return self.rows


@pytest.fixture
def drone():
    return Drone()
