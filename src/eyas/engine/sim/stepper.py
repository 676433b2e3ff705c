"""Takes the steps of a simulation, with what happens between physics steps."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import MountConfig
from eyas.engine.camera.vibration import Vibration
from eyas.engine.core.bounds import FARTHEST, LARGEST, checked, limited
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.sensors.inertial import smoothing_share
from eyas.engine.sensors.mount import CARRIED, mount_of
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.episodes import Sampler
from eyas.engine.sim.latency import LateCommands
from eyas.engine.sim.step import Orders, StepKernels, StepState, StepSurroundings, step_of
from eyas.engine.sim.views.delay import SeenState
from eyas.engine.sim.views.sensor_suite import SensorSuite
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.config import StartVelocity
from eyas.engine.task.done import DoneReason
from eyas.engine.task.rules import Rules
from eyas.engine.trackers.config import TrackerKind
from eyas.engine.trackers.gimbal_command import WITH_GIMBAL, with_gimbal
from eyas.engine.trackers.tracker import Tracker
from eyas.lanes import BoundCall, PackedBundle

Floats = NDArray[np.float64]

_FAST = 1e3  # Length of all commands together beyond which each is looked at [m/s]

_JUMP, _SPIN = 1e3, 1e2
"""Most speed [m/s] and turn rate [rad/s] that a place far away gives: a flown body could not be
integrated with more."""

_SELDOM = 16
"""Calls of the step between two looks at where trackers are, unless commands are fast: a look takes
a fifth of the time of one tracker's step."""


def step_kernels(config: SimConfig, tracker: Tracker) -> StepKernels:
    """Return the kernels of the step of a kind of tracker."""
    carried = CARRIED[config.camera.mount is not None]
    return step_of(tracker, carried, velocities=config.needs_velocities)


def step_state(
    config: SimConfig,
    tracker: Tracker,
    snapshot: Snapshot,
    memory: Any,  # noqa: ANN401  # the record that the tracker's kernels use
    around: StepSurroundings,
    rules: Rules,
) -> StepState:
    """Return what the step of a kind of tracker reads and writes."""
    smoothing = config.tracker.inertial_time_constant if tracker.jumps else 0.0
    mount = mount_of(config.camera.mount or MountConfig())
    launched = int(config.start.velocity is StartVelocity.TARGET)
    share = smoothing_share(smoothing)
    return StepState(snapshot, memory, around, rules, share, mount, launched)


class Stepper:
    """Moves N trackers: all physics steps of a command in one call, unless something is sensed, or
    kept to be seen later, after each.

    Attributes:
        sensors: What is sensed after each physics step.
        seen: The state that agents see.
        told: What the trackers tell of themselves, see `Tracker.told`.
        decide: Called before physics steps, with their number and who flies; None: nothing is to
            be decided.
        samplers: Called with each tracker and the key of its episode that begins.
    """

    def __init__(
        self,
        config: SimConfig,  # The settings
        assets: Assets,  # Map and traffic
        tracker: Tracker,  # The kind of the trackers
        worlds: Worlds,  # The worlds of the trackers
        snapshot: Snapshot,  # Their state
    ) -> None:
        count, terrain = len(worlds.of), assets.scene.terrain
        self._traffic, self._snapshot = assets.traffic, snapshot
        own = not isinstance(config.tracker.kind, TrackerKind)  # whose kernels may do anything
        self.decide: Callable[[int, NDArray[np.bool_]], None] | None = None
        self._calls, self._seldom = 0, 1 if own else _SELDOM
        self._memory = tracker.memory(count, terrain)
        around = StepSurroundings(assets.traffic.motion, terrain)
        self._state_by = partial(step_state, config, tracker, snapshot, self._memory, around)
        self._kernels = step_kernels(config, tracker)
        self._turning_kernels = partial(step_kernels, config, with_gimbal(tracker))
        self._orders = Orders.create(count)
        self._held_orders = PackedBundle(self._orders)
        self._turning_orders = self._orders._replace(commands=np.zeros((count, WITH_GIMBAL)))
        active, bodies = self._orders.active, tracker.visible
        self.sensors = SensorSuite(config, assets, worlds, snapshot, active, bodies=bodies)
        control = config.control
        self._late = LateCommands.of(control.action_latency_steps, count)
        camera, latency = config.sensors.camera, control.observation_latency_steps
        vibration = Vibration.of(config.camera.vibration, count)
        self.seen = SeenState(latency, camera, snapshot, self.sensors.told, vibration)
        self.samplers: list[Sampler] = [late.sample for late in (self._late, self.seen) if late]
        self.told = {name: getattr(self._memory, at) for name, at in tracker.told.items()}
        if tracker.sample:
            self.samplers.insert(0, partial(tracker.sample, self._memory))

    def obey(self, rules: Rules) -> None:
        """Judge by these rules from the next step on."""
        self._held_state = PackedBundle(self._state_by(rules))
        self._step = self._kernels.bind(self._held_state, self._held_orders)
        self._turning: BoundCall | None = None

    def begin(
        self,
        chosen: NDArray[np.int64],  # The trackers, shape (K,)
        pitch: Floats,  # Commanded pitch of their cameras [rad], shape (K,)
        # Returns what the random numbers of a tracker's episode depend on
        key_of: Callable[[int], EpisodeKey],
    ) -> None:
        """Put trackers at their start poses."""
        count = len(chosen)
        self._orders.pitch[:count] = pitch
        self._orders.chosen[:count] = chosen
        self._orders.starts[0] = count
        self._step.begin()
        self.sensors.begin(chosen.tolist(), key_of)
        self.seen.begin(chosen)

    def fly(self, commands: Floats, steps: int, active: NDArray[np.bool_] | None) -> None:
        """Hold commands for some physics steps; see `Simulation.advance`."""
        self._orders.active[:] = True if active is None else active
        self.sensors.renew()
        pieces = [(commands, steps)]
        if self._late:
            clock = self._snapshot.episodes.step_count
            pieces = list(self._late.pieces(commands, steps, clock))
        for piece, some in pieces:
            turns = piece.shape[1] == WITH_GIMBAL
            commands = (self._turning_orders if turns else self._orders).commands
            commands[:] = piece
            fast = not np.vdot(commands, commands) <= _FAST * _FAST
            if fast:
                unknown = np.isnan(commands).any(axis=1)
                commands[:] = limited(commands, LARGEST)
                self._calls = -1
            self._take(self._fly_and_turn() if turns else self._step.fly, some)
            if fast:
                self._snapshot.episodes.reason[unknown] = DoneReason.NOT_A_NUMBER

    def _fly_and_turn(self) -> BoundCall:
        """Return the step that also turns cameras; it is compiled when it is first needed."""
        if self._turning is None:
            kernels = self._turning_kernels()
            self._turning = kernels.fly.bind(self._held_state, PackedBundle(self._turning_orders))
        return self._turning

    def carry(self, steps: int) -> None:
        """Move all trackers with their targets."""
        self._orders.active[:] = True
        self.sensors.renew()
        self._take(self._step.carry, steps)

    def place(self, poses: Floats) -> None:
        """Move all trackers to poses, within one physics step; see `Simulation.place`."""
        self._orders.poses[:] = poses
        self._orders.placed[0] = 1
        self.carry(1)
        self._orders.placed[0] = 0
        state = self._snapshot.trackers
        state.velocity[:] = limited(state.velocity, _JUMP)
        state.angular_velocity[:] = limited(state.angular_velocity, _SPIN)

    def _take(self, step: BoundCall, steps: int) -> None:
        if self._traffic.live:
            last = int(self._snapshot.episodes.tick.max()) + steps
            self._traffic.prepare(last * PHYSICS_STEP)
        if self.decide is not None:
            self.decide(steps, self._orders.active)
        if not self.sensors.follow and not self.seen.is_late:
            self._orders.steps[0] = steps
            step()
            self._stay_near()
            if self.seen.vibration is not None:
                self.seen.see()
            return
        self._orders.steps[0] = 1
        for _ in range(steps):
            step()
            self._stay_near()
            self.sensors.advance()
            self.seen.record()
        self.seen.see()

    def _stay_near(self) -> None:
        """Stop trackers that have come farther than `FARTHEST` there.

        Raises:
            EyasError: A tracker of a user's own is nowhere.
        """
        self._calls += 1
        if self._calls % self._seldom == 0:
            trackers = self._snapshot.trackers
            for places in (trackers.position, trackers.commanded_position):
                near = checked(places, FARTHEST, "place of a tracker")
                if near is not places:
                    trackers.velocity[(near != places).any(axis=1)] = 0.0
                    places[:] = near
