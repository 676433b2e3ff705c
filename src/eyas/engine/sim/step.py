"""The step: one kernel call moves all trackers and computes their rewards and ends, for all
physics steps of a command.

Its kernels get the address of their arguments (`eyas.lanes.calls`): unpacking about fifty arrays
at each call would take four times as long as a step of one tracker.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.velocity import begin_at_rest, left_unknown, moved_from, pose_before
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.frames import wrap_angle
from eyas.engine.sensors.inertial import feel, rest
from eyas.engine.sensors.mount import Mount
from eyas.engine.sensors.mount import left_on_gimbal as carried
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.motion import Motion
from eyas.engine.state.snapshot import CameraState, Snapshot, TargetState, TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.direction import target_centre
from eyas.engine.task.done import judge
from eyas.engine.task.observe import clear_episode, observe
from eyas.engine.task.reward import rewarded_size
from eyas.engine.task.rules import Rules
from eyas.engine.trackers.drone import advance, aim, carry, start
from eyas.engine.trackers.tracker import Tracker
from eyas.engine.trackers.tracker import stand as launch
from eyas.engine.traffic.interpolation import interpolate_actor
from eyas.lanes import BoundCall, CompiledCall, Held, compiled, kernel, specialised
from eyas.lanes.elementary import sin_cos


@kernel(inline=True)
def offset_pose(
    target: NDArray[np.float64], target_yaw: float, offset: NDArray[np.float64]
) -> tuple[float, float, float, float]:
    """Return x, y, z [m] and yaw [rad] of a body at an offset from a target.

    Args:
        target: Reference point of the target, world frame [m], shape (3,).
        target_yaw: Heading of the target [rad].
        offset: Forward, left, up in the body's heading frame [m], and its heading relative to the
            target's [rad], shape (4,).
    """
    yaw = target_yaw + offset[3]
    sine, cosine = sin_cos(yaw)
    x = target[0] + cosine * offset[0] - sine * offset[1]
    y = target[1] + sine * offset[0] + cosine * offset[1]
    return x, y, target[2] + offset[2], wrap_angle(yaw)


class StepSurroundings(NamedTuple):
    """Everything outside the trackers that a step reads."""

    motion: Motion  # Motion of all actors
    terrain: Terrain  # The ground


class StepState(NamedTuple):
    """Everything that a step reads and writes."""

    snapshot: Snapshot
    memory: Any  # Memory of the trackers: the record that their kernels use
    around: StepSurroundings
    rules: Rules
    inertial_share: float  # See `eyas.engine.sensors.inertial.smoothing_share`.
    mount: Mount  # Where cameras are that no gimbal carries
    launched: int  # 1: episodes begin at the velocity of the target; 0: at rest


class Orders(NamedTuple):
    """The input of one call of the step."""

    steps: NDArray[np.int64]
    """Physics steps to take, shape (1,)."""
    commands: NDArray[np.float64]
    """Command of each tracker, see `Tracker.advance`, shape (N, 4) or (N, 8)."""
    active: NDArray[np.bool_]
    """Whether each tracker flies, shape (N,); for the others, time stands still."""
    placed: NDArray[np.int64]
    """1: trackers are carried to `poses`; 0: along with their targets, shape (1,)."""
    poses: NDArray[np.float64]
    """Where they are carried: x, y, z [m], heading [rad], shape (N, 4)."""
    starts: NDArray[np.int64]
    """Number of trackers that begin an episode, K, shape (1,)."""
    chosen: NDArray[np.int64]
    """Those trackers, in the first K of N elements."""
    pitch: NDArray[np.float64]
    """Commanded pitch of their cameras, positive down [rad], in the first K of N elements."""

    @classmethod
    def create(cls, trackers: int) -> "Orders":
        """Return an input that does nothing."""
        return cls(
            steps=np.zeros(1, np.int64),
            commands=np.zeros((trackers, 4)),
            active=np.ones(trackers, np.bool_),
            placed=np.zeros(1, np.int64),
            poses=np.zeros((trackers, 4)),
            starts=np.zeros(1, np.int64),
            chosen=np.zeros(trackers, np.int64),
            pitch=np.zeros(trackers),
        )


Kernel = Callable[..., Any]


class Step(NamedTuple):
    """The calls of the step, bound to the state of a simulation."""

    fly: BoundCall  # Moves all trackers by their commands
    carry: BoundCall  # Moves all trackers with their targets
    begin: BoundCall  # Puts the chosen trackers at their start poses


class StepKernels(NamedTuple):
    """The kernels of a step, for one kind of tracker."""

    fly: CompiledCall
    carry: CompiledCall
    begin: CompiledCall
    fly_one: Kernel  # `fly_one(state, orders, n)`: what `fly` does for tracker `n`
    begin_one: Kernel  # `begin_one(state, n, pitch)`: what `begin` does for tracker `n`

    def bind(self, state: Held[StepState], orders: Held[Orders]) -> Step:
        """Return the calls, bound to a state."""
        return Step(*(kernel.bind(state, orders) for kernel in self[:3]))


def step_of(
    tracker: Tracker,  # The kind
    carried: Kernel = carried,  # One of `eyas.engine.sensors.mount.CARRIED`
    *,
    velocities: bool = False,  # Whether the velocities of cameras are kept up
) -> StepKernels:
    """Return the step of a kind of tracker."""
    start, launch, advance, carry = tracker.start, tracker.launch, tracker.advance, tracker.carry
    return _step_of(start, launch, advance, carry, tracker.aim, carried, velocities)


@lru_cache(maxsize=16)
def _step_of(
    start: Kernel,
    launch: Kernel,
    advance: Kernel,
    carry: Kernel,
    aim: Kernel,
    carried: Kernel,
    velocities: bool,  # a key of the cache
) -> StepKernels:
    seen: dict[str, Kernel] = {"aim": aim, "carried": carried}
    pointing = point_in_motion if velocities else point
    if velocities or seen != _USUAL:
        pointing = kernel(inline=True)(specialised(pointing, **seen))
    seen["stand"] = begin_at_rest if velocities else left_unknown
    flies = kernel(inline=True)(specialised(fly_one, advance=advance, point=pointing))
    begins = kernel(inline=True)(specialised(begin_one, start=start, launch=launch, **seen))
    return StepKernels(
        fly=compiled(specialised(_fly, fly_one=flies)),
        carry=compiled(specialised(_carry, carry=carry, point=pointing)),
        begin=compiled(specialised(_begin, begin_one=begins)),
        fly_one=flies,
        begin_one=begins,
    )


@kernel(inline=True)
def point(
    trackers: TrackerState,
    memory: Any,  # noqa: ANN401  # the record that the tracker's kernels use
    cameras: CameraState,
    n: int,
    mount: Mount,
) -> None:
    """Write the pose of the camera of tracker `n`."""
    aim(trackers, memory, cameras, n)
    carried(trackers, cameras, n, mount)


@kernel(inline=True)
def point_in_motion(
    trackers: TrackerState,
    memory: Any,  # noqa: ANN401  # as above
    cameras: CameraState,
    n: int,
    mount: Mount,
) -> None:
    """Write the pose and the velocities of the camera of tracker `n`, after a physics step."""
    before = pose_before(cameras, n)
    aim(trackers, memory, cameras, n)
    carried(trackers, cameras, n, mount)
    moved_from(before, cameras, n)


stand = left_unknown
_USUAL: dict[str, Kernel] = {"aim": aim, "carried": carried}


@kernel(inline=True)
def fly_one(state: StepState, orders: Orders, n: int) -> None:
    """Move tracker `n` by its command."""
    trackers, cameras, targets, episodes, _ = state.snapshot
    memory, around, rules, mount = state.memory, state.around, state.rules, state.mount
    share = state.inertial_share
    half_size = rewarded_size(cameras.field_of_view[n], rules)
    for _step in range(orders.steps[0]):
        advance(trackers, memory, n, orders.commands[n])
        feel(trackers, n, share)
        episodes.tick[n] += 1
        _move_target(targets, episodes, n, around)
        point(trackers, memory, cameras, n, mount)
        observe(trackers, cameras, targets, episodes, n, around.terrain, rules, half_size)
        judge(trackers, targets, episodes, n, around.terrain, rules)


@kernel(inline=True)
def begin_one(state: StepState, n: int, pitch: float) -> None:
    """Put tracker `n` at its start pose and aim its camera; target, tick and offset are set."""
    trackers, cameras, targets, episodes, _ = state.snapshot
    memory, around, rules, mount = state.memory, state.around, state.rules, state.mount
    share = state.inertial_share
    clear_episode(episodes, n)
    targets.lost[n] = False
    _move_target(targets, episodes, n, around)
    x, y, z, yaw = offset_pose(targets.position[n], targets.yaw[n], episodes.start_offset[n])
    start(trackers, memory, n, x, y, z, yaw, pitch)
    if state.launched == 1:
        speed, (north, east) = targets.speed[n], sin_cos(targets.yaw[n])
        launch(trackers, memory, n, speed * east, speed * north)
    rest(trackers, n, share)
    aim(trackers, memory, cameras, n)
    carried(trackers, cameras, n, mount)
    stand(trackers, cameras, n)
    half_size = rewarded_size(cameras.field_of_view[n], rules)
    observe(trackers, cameras, targets, episodes, n, around.terrain, rules, half_size)


def _fly(state: StepState, orders: Orders) -> None:
    for n in range(orders.commands.shape[0]):
        if orders.active[n]:
            fly_one(state, orders, n)


def _carry(state: StepState, orders: Orders) -> None:
    trackers, cameras, targets, episodes, _ = state.snapshot
    memory, around, rules, mount = state.memory, state.around, state.rules, state.mount
    share = state.inertial_share
    steps = orders.steps
    for n in range(episodes.tick.shape[0]):
        half_size = rewarded_size(cameras.field_of_view[n], rules)
        for _step in range(steps[0]):
            episodes.tick[n] += 1
            _move_target(targets, episodes, n, around)
            x, y, z, yaw = offset_pose(
                targets.position[n], targets.yaw[n], episodes.start_offset[n]
            )
            if orders.placed[0] == 1:
                pose = orders.poses[n]
                x, y, z, yaw = pose[0], pose[1], pose[2], wrap_angle(pose[3])
            carry(trackers, memory, n, x, y, z, yaw)
            feel(trackers, n, share)
            point(trackers, memory, cameras, n, mount)
            observe(trackers, cameras, targets, episodes, n, around.terrain, rules, half_size)
            judge(trackers, targets, episodes, n, around.terrain, rules)


def _begin(state: StepState, orders: Orders) -> None:
    for k in range(orders.starts[0]):
        begin_one(state, orders.chosen[k], orders.pitch[k])


@kernel(inline=True)
def _move_target(
    targets: TargetState, episodes: EpisodeState, n: int, around: StepSurroundings
) -> None:
    """Read the pose of tracker n's target; a target that has left keeps its last pose."""
    time = episodes.tick[n] * PHYSICS_STEP
    pose = interpolate_actor(around.motion, targets.actor[n], time)
    velocity, acceleration = targets.velocity[n], targets.acceleration[n]
    if targets.lost[n] or not pose.present:
        targets.lost[n] = True
        targets.speed[n] = targets.yaw_rate[n] = 0.0
        for axis in range(3):
            velocity[axis] = acceleration[axis] = 0.0
        return
    position, centre = targets.position[n], targets.centre[n]
    now = (pose.velocity_x, pose.velocity_y, pose.velocity_z)
    if episodes.observations[n] > 0:
        for axis in range(3):
            acceleration[axis] = (now[axis] - velocity[axis]) / PHYSICS_STEP
    else:  # nothing is known of the step before but how it turned
        acceleration[0] = -pose.yaw_rate * pose.velocity_y
        acceleration[1] = pose.yaw_rate * pose.velocity_x
        acceleration[2] = 0.0
    for axis in range(3):
        velocity[axis] = now[axis]
    targets.yaw_rate[n], targets.slope[n] = pose.yaw_rate, pose.slope
    targets.hitch[n], targets.travelled[n] = pose.hitch, pose.travelled
    position[0], position[1], position[2] = pose.x, pose.y, pose.z + targets.rise[n]
    targets.yaw[n] = pose.yaw
    targets.speed[n] = pose.speed
    centre[0], centre[1] = target_centre(pose.x, pose.y, pose.yaw, targets.ahead[n])
    centre[2] = position[2]
