"""The flown drone without its flight controller: its commands are what each rotor is to do."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.trackers.airframe import ORIGINAL
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.flown import FlightMemory, air_around, arrive, body_of, flown_drone
from eyas.engine.trackers.rigid_body import moved, spun_up
from eyas.engine.trackers.tracker import Tracker, stand
from eyas.lanes import kernel

WEIGHT = ORIGINAL.mass * ORIGINAL.gravity  # Of a driven drone [N]


@kernel(inline=True)
def advance(
    trackers: TrackerState, memory: FlightMemory, n: int, command: NDArray[np.float64]
) -> None:
    """Move drone `n` by one physics step of 2 ms: a `Tracker.advance`.

    Args:
        trackers: The state; where it is commanded to be is where it is.
        memory: Its rotors' rates, its gimbal and the wind.
        n: Index of the tracker.
        command: Thrusts asked of the rotors front right, front left, rear left, rear right [N],
            shape (4,). The first and the third turn counter-clockwise, seen from above.
    """
    frame, before = memory.frame, body_of(trackers, n)
    air = air_around(memory, n, before)
    wanted = (command[0], command[1], command[2], command[3])
    pushed = spun_up(frame, memory.rotor[n], wanted)
    after = moved(frame, before, pushed, air, memory.terrain, PHYSICS_STEP)
    arrive(trackers, memory, n, before, after)
    for axis in range(3):
        trackers.commanded_position[n, axis] = trackers.position[n, axis]
    trackers.commanded_yaw[n] = trackers.euler[n, 2]


def driven_drone(config: TrackerConfig) -> Tracker:
    """Return the body of `flown_drone`, whose rotors someone else commands."""
    return replace(flown_drone(config), name="driven drone", advance=advance, launch=stand)
