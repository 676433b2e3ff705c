"""Flown drones without a world: commands in, motion out."""

from functools import cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.flown import FlightMemory, advance, aim, start
from eyas.engine.trackers.kinds import tracker_of
from eyas.engine.trackers.steady import launch
from eyas.lanes import compiled, specialised

FLAT = Terrain.flat(0.0)
FLOWN = TrackerConfig(supervised=False)


class Log(NamedTuple):
    """Motion after each of K steps of 2 ms, of N drones."""

    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    attitude: NDArray[np.float64]
    euler: NDArray[np.float64]
    rate: NDArray[np.float64]
    gimbal: NDArray[np.float64]
    rotor: NDArray[np.float64]
    commanded: NDArray[np.float64]
    camera: NDArray[np.float64]
    """Camera to world, shape (K, N, 3, 3)."""

    @classmethod
    def create(cls, steps, count):
        sizes = (3, 3, 4, 3, 3, 3, 4, 3)
        return cls(
            *(np.zeros((steps, count, size)) for size in sizes), np.zeros((steps, count, 3, 3))
        )


def _begin(trackers, memory, poses):
    for n in range(poses.shape[0]):
        start(trackers, memory, n, poses[n, 0], poses[n, 1], poses[n, 2], poses[n, 3], poses[n, 4])


def _fly(trackers, memory, cameras, rotor, commands, log):
    for k in range(commands.shape[0]):
        for n in range(commands.shape[1]):
            advance(trackers, memory, n, commands[k, n])
            aim(trackers, memory, cameras, n)
            for axis in range(3):
                log.position[k, n, axis] = trackers.position[n, axis]
                log.velocity[k, n, axis] = trackers.velocity[n, axis]
                log.euler[k, n, axis] = trackers.euler[n, axis]
                log.rate[k, n, axis] = trackers.angular_velocity[n, axis]
                log.gimbal[k, n, axis] = trackers.gimbal[n, axis]
                log.commanded[k, n, axis] = trackers.commanded_position[n, axis]
                for column in range(3):
                    log.camera[k, n, axis, column] = cameras.rotation[n, axis, column]
            for part in range(4):
                log.attitude[k, n, part] = trackers.orientation[n, part]
                log.rotor[k, n, part] = rotor[n, part]


def _set_going(trackers, memory, velocities):
    for n in range(velocities.shape[0]):
        launch(trackers, memory, n, velocities[n, 0], velocities[n, 1])


@cache
def kernels_of(begins, moves, aims, launches):
    """Kernels that begin, fly and launch drones of a kind."""
    return (
        compiled(specialised(_begin, start=begins)),
        compiled(specialised(_fly, advance=moves, aim=aims)),
        compiled(specialised(_set_going, launch=launches)),
    )


class Drones:
    """N flown drones in the air."""

    def __init__(self, count=1, config=FLOWN, frame=None, terrain=FLAT, height=20.0, pitch=1.0):
        self.count = count
        self.tracker = tracker_of(config)
        memory = self.tracker.memory
        if frame is not None:
            memory = partial(FlightMemory.create, frame, config.wind.turbulence)
        self.trackers = TrackerState.create(count)
        self.memory = memory(count, terrain)
        self.cameras = CameraState.create(count)
        kind = self.tracker
        kernels = kernels_of(kind.start, kind.advance, kind.aim, kind.launch)
        self._begin, self._fly, self._launch = kernels
        flight = getattr(self.memory, "flight", self.memory)
        self.rotor = flight.rotor
        self.start(np.tile([0.0, 0.0, height, 0.0, pitch], (count, 1)))

    def start(self, poses):
        """Place them at x, y, z, yaw, pitch, shape (N, 5)."""
        self._begin(self.trackers, self.memory, poses)

    def launch(self, velocities):
        """Let them fly on at velocities towards east and north [m/s], shape (N, 2)."""
        self._launch(self.trackers, self.memory, np.asarray(velocities, np.float64))

    def fly(self, commands):
        """Fly commands, shape (K, 4) for all or (K, N, 4), one for each step of 2 ms."""
        commands = np.asarray(commands, np.float64)
        if commands.ndim == 2:
            commands = np.repeat(commands[:, None], self.count, axis=1)
        commands = np.ascontiguousarray(commands)
        log = Log.create(*commands.shape[:2])
        self._fly(self.trackers, self.memory, self.cameras, self.rotor, commands, log)
        return log


def held(forward=0.0, left=0.0, up=0.0, yaw_rate=0.0, steps=500):
    """The same command in each of some steps, shape (K, 4)."""
    return np.tile([forward, left, up, yaw_rate], (steps, 1))
