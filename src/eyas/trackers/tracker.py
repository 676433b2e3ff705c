"""A kind of tracker: the kernels that move it and its camera."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

__all__ = ["Tracker"]

Kernel = Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Tracker:
    """How trackers of a kind are moved. All kernels work on tracker `n` of N.

    `trackers` is a `TrackerState`, `memory` whatever record of arrays `memory` creates: filters,
    rotor speeds, anything that only this kind of tracker knows.
    """

    name: str
    memory: Callable[[int], tuple[Any, ...]]
    """`memory(N)` returns a `NamedTuple` of arrays with leading axis N."""
    start: Kernel
    """`start(trackers, memory, n, x, y, z, yaw, pitch)` puts it at rest at a point [m] with a
    heading [rad] and its camera at a commanded pitch, positive down [rad]."""
    advance: Kernel
    """`advance(trackers, memory, n, command)` moves it by one physics step of 2 ms; `command` is
    forward [m/s], left [m/s], up [m per 2 ms], yaw rate [rad/s], shape (4,)."""
    carry: Kernel
    """`carry(trackers, memory, n, x, y, z, yaw)` moves it to a pose within one physics step."""
    aim: Kernel
    """`aim(trackers, memory, cameras, n)` writes the pose of its camera into a `CameraState`."""
