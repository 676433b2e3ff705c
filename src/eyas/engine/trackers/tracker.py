"""A kind of tracker: the kernels that move it and its camera."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from eyas.engine.core.rng import EpisodeKey
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.lanes import kernel

ROTORS = "rotor_command"
"""Name under which trackers tell what they ask of their rotors, see `Tracker.told`."""

Kernel = Callable[..., Any]


@kernel(inline=True)
def stand(
    trackers: TrackerState,
    memory: Any,  # noqa: ANN401  # of any kind of tracker
    n: int,
    east: float,
    north: float,
) -> None:
    """Leave tracker `n` as it has been started: a `Tracker.launch`."""


@dataclass(frozen=True, slots=True)
class Tracker:
    """Kernels of one kind of tracker. Each works on tracker `n` of N.

    `trackers` is a `TrackerState`; `memory` is the record of arrays that the field `memory`
    creates: filters, rotor speeds, and other state of this kind only.
    """

    name: str
    memory: Callable[[int, Terrain], tuple[Any, ...]]
    """`memory(N, terrain)` returns a `NamedTuple` of arrays with leading axis N, of numbers and of
    other such tuples; it may hold the ground, too."""
    start: Kernel
    """`start(trackers, memory, n, x, y, z, yaw, pitch)` puts it at rest at a point [m] with a
    heading [rad] and its camera at a commanded pitch, positive down [rad]."""
    advance: Kernel
    """`advance(trackers, memory, n, command)` moves it by one physics step of 2 ms; `command` is
    forward [m/s], left [m/s], up [m per 2 ms], yaw rate [rad/s], shape (4,). With actions that turn
    the camera it has four more numbers (`eyas.engine.trackers.gimbal_command`), which have already
    changed `trackers.commanded_gimbal`."""
    carry: Kernel
    """`carry(trackers, memory, n, x, y, z, yaw)` moves it to a pose within one physics step."""
    aim: Kernel
    """`aim(trackers, memory, cameras, n)` writes the pose of its camera into a `CameraState`."""
    launch: Kernel = stand
    """`launch(trackers, memory, n, east, north)` lets it, just started, fly on at a horizontal
    velocity [m/s], that of its target, where `start.velocity` says so; without a `launch` it begins
    as `start` leaves it, which suits what has no inertia."""
    sample: Callable[[Any, int, EpisodeKey], None] | None = None
    """`sample(memory, n, key)`, a function of Python, samples what is random in an episode, before
    `start`; None: nothing is."""
    sampled: str | None = None
    """The field of the memory that `sample` writes, or a field of a record in it (`record.field`):
    the whole row `n` of each of its arrays; it reads nothing of them. None: it is not known, so
    that this tracker cannot be on a device."""
    told: Mapping[str, str] = field(default_factory=dict)
    """What environments tell of it besides: for each name in their `info` the field of the memory,
    an array with N rows."""
    jumps: bool = True
    """Whether its velocity may jump, so that its inertial sensors read a smoothed motion."""
    visible: bool = True
    """Whether others in its world see it, as a quadrotor."""
    judged: bool = True
    """Whether it is rewarded for its view and its limits end episodes; False: the reward is 1."""
