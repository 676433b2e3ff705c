"""The simulation: N trackers, each with a target, in separate or shared worlds."""

from dataclasses import replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.bounds import FARTHEST, LARGEST, checked
from eyas.engine.core.clock import PHYSICS_STEP, physics_steps
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.episodes import Episodes
from eyas.engine.sim.evaders import Evaders, evader_assets
from eyas.engine.sim.light import LightChanges
from eyas.engine.sim.starts import starts_in
from eyas.engine.sim.stepper import Stepper
from eyas.engine.sim.views.view import View
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import Scene
from eyas.engine.state.snapshot import CameraState, Snapshot
from eyas.engine.targets.kind import Colour, Looks
from eyas.engine.targets.rig import Rigs
from eyas.engine.task.clearance import Clearance
from eyas.engine.task.quantities import Setting
from eyas.engine.task.rules import Rules, exact, lenient, make_rules
from eyas.engine.task.terms import RewardTerms
from eyas.engine.trackers.gimbal_command import WIDTH, WITH_GIMBAL
from eyas.engine.trackers.tracker import Tracker
from eyas.lanes import exact as elementary

Floats = NDArray[np.float64]


def is_judged(config: SimConfig, tracker: Tracker) -> bool:
    """Return whether views are rewarded and limits end episodes, see `TrackerConfig.judged`."""
    own = config.tracker.judged
    return tracker.judged if own is None else own


def rules_of(config: SimConfig, tracker: Tracker) -> Rules:
    """Return the rules for reward and end of episodes."""
    rules = make_rules(config.reward, config.done, config.camera)
    return exact(rules if is_judged(config, tracker) else lenient(rules))


class StepResult(NamedTuple):
    """The result of a step for N trackers, in arrays that later steps do not change."""

    reward: Floats
    """Weighted sum of the terms, shape (N,)."""
    terms: dict[str, Floats]
    """Each term of the reward by name, without its weight, shape (N,)."""
    reason: NDArray[np.int64]
    """`eyas.engine.task.done.DoneReason` of each tracker, shape (N,)."""
    done: NDArray[np.bool_]
    """Whether each episode has ended, shape (N,)."""


class Simulation:
    """N trackers at once. Made by `eyas.engine.sim.build.build_simulation`.

    Attributes:
        config: The settings.
        count: N.
        traffic: Everything that moves by itself; live traffic takes reactions.
        snapshot: The state of everything; its arrays are written in place by each step.
        view: What agents see of it, now or late.
        evaders: The targets, where agents or fixed drivers move them; None: they move as recorded.
        judged: Whether views are rewarded and limits end episodes, see `TrackerConfig.judged`.

    Args:
        config: The settings.
        assets: Map, traffic and renderer.
        tracker: The kind of the trackers.
        world_of: Number of the world of each tracker, shape (N,); see `Worlds`.
    """

    def __init__(
        self, config: SimConfig, assets: Assets, tracker: Tracker, world_of: NDArray[np.integer]
    ) -> None:
        evading = evader_assets(config, assets, len(world_of))
        if evading is not None:
            rigs = Rigs(evading.motion.kind)
            assets = replace(assets, traffic=evading, rigs=rigs)
        worlds = Worlds(config, assets, world_of)
        self.config = config
        self.count = len(worlds.of)
        self.traffic = assets.traffic
        self.snapshot = Snapshot.create(self.count)
        wind = config.world.wind
        light = LightChanges(config.light, assets.lighting, self.snapshot.light, wind)
        self._assets, self._worlds = assets, worlds
        self._stepper = Stepper(config, assets, tracker, worlds, self.snapshot)
        sensors, seen, samplers = self._stepper.sensors, self._stepper.seen, self._stepper.samplers
        if wind is not None:
            samplers = [*samplers, light.blow]
        starts = starts_in(assets, self.snapshot, worlds, shared_target=config.same_target)
        self._episodes = Episodes(
            config, assets.traffic, worlds, light, self.snapshot, samplers, starts
        )
        self.evaders: Evaders | None = None
        if evading is not None:
            follow = self._episodes.follow
            self.evaders = Evaders(config, assets, evading, worlds, self.snapshot, follow)
            self._stepper.decide = self.evaders.advance
        view = partial(View, config, assets, worlds, light, sensors, visible=tracker.visible)
        self._present = self.view = view(seen)
        if seen.is_late:
            self._present = view(seen.on_time())
        self.judged = is_judged(config, tracker)
        self.rules = rules_of(config, tracker)
        early = config.done.grace_steps + 2 * physics_steps(config.control.frequency)
        self._terms = RewardTerms(config.reward, Setting(self.rules.aspect, early))

    @property
    def rules(self) -> Rules:
        """Rules for reward and end of episodes; may be replaced between steps."""
        return self._rules

    @rules.setter
    def rules(self, rules: Rules) -> None:
        self._rules = exact(rules)
        self._stepper.obey(self._rules)

    def reseed(self, seed: int) -> None:
        """Begin the sequence of episodes of another seed; takes effect at the next reset."""
        self._episodes.reseed(seed)

    def reseed_alone(self, trackers: NDArray[np.integer], seeds: NDArray[np.integer]) -> None:
        """Begin the episodes that a simulation of one tracker has with each of these seeds.

        Args:
            trackers: Trackers with worlds of their own, shape (K,).
            seeds: The seed of each, shape (K,).
        """
        self._episodes.reseed_alone(trackers, seeds)

    def turn_starts(self, angles: Floats) -> None:
        """Add angles to the start directions of all trackers [rad], shape (N,), from the next reset
        on.
        """
        self._episodes.turn_starts(checked(angles, LARGEST, "direction of a start"))

    def continue_from(self, other: "Simulation") -> None:
        """Continue the sequences of episodes of another simulation with as many trackers, whose
        worlds are their own.
        """
        self._episodes.continue_from(other._episodes)

    @property
    def seeds(self) -> NDArray[np.int64]:
        """Seed of the sequence of episodes of each tracker, shape (N,)."""
        return self._episodes.seeds

    def episode_key(self, tracker: int) -> EpisodeKey:
        """Return what the random values of a tracker's episode depend on."""
        return self._episodes.key(tracker)

    @property
    def scene(self) -> Scene:
        """All that stands still around the trackers."""
        return self._assets.scene

    @property
    def steps_left(self) -> int:
        """Physics steps until the recorded traffic ends; afterwards all vehicles stand still.

        Only shared worlds, whose time goes on from episode to episode, get there.
        """
        return self._episodes.steps_left

    def rewind(self) -> None:
        """Begin the traffic anew; call `reset` for all trackers next."""
        self._episodes.rewind()

    def reset(self, trackers: NDArray[np.bool_] | None = None) -> None:
        """Begin a new episode.

        Args:
            trackers: Mask of the trackers to reset, shape (N,); None: all.

        Raises:
            SpawnError: A tracker has no possible target.
            ConfigError: The recording is too short for an episode.
        """
        chosen = np.arange(self.count) if trackers is None else np.flatnonzero(trackers)
        if self.evaders is not None:
            self.evaders.release(chosen)
        pitch = self._episodes.begin(chosen)
        if self.evaders is not None:
            self.evaders.begin(chosen, self._episodes.key)
        self._stepper.begin(chosen, pitch, self._episodes.key)

    def advance(
        self, commands: Floats, physics_steps: int = 1, active: NDArray[np.bool_] | None = None
    ) -> StepResult:
        """Hold commands for some physics steps of 2 ms, each with reward and end conditions.

        Args:
            commands: Forward [m/s], left [m/s], up [m per 2 ms], yaw rate [rad/s], shape (N, 4); or
                with four more that turn the cameras, shape (N, 8), see
                `eyas.engine.trackers.gimbal_command`. Larger numbers than `LARGEST` are limited to
                it, and NaN is 0 and ends the episode (`DoneReason.NOT_A_NUMBER`); nor does any
                tracker get farther than `FARTHEST`.
            physics_steps: Number of steps.
            active: The trackers that fly, shape (N,); for the others time stands still, so that
                these must have worlds of their own. None: all.
        """
        allowed = (self.count, WIDTH), (self.count, WITH_GIMBAL)
        assert commands.shape in allowed, f"commands: shape {commands.shape}, not (N, 4) or (N, 8)"
        self._stepper.fly(commands, physics_steps, active)
        return self._result()

    def carry(self, physics_steps: int = 1) -> StepResult:
        """Move all trackers with their targets, at their start offsets."""
        self._stepper.carry(physics_steps)
        return self._result()

    def place(self, poses: Floats) -> None:
        """Move all trackers to poses, within one physics step.

        Args:
            poses: East, north, up [m], heading [rad], shape (N, 4).

        Raises:
            EyasError: A number is not finite.
        """
        self._stepper.place(checked(poses, FARTHEST, "place of a tracker"))

    def start_at(self, trackers: NDArray[np.integer], poses: Floats, pitch: Floats) -> None:
        """Begin the episodes of trackers that have just been reset at other poses.

        Args:
            trackers: The trackers, shape (K,).
            poses: East, north, up [m], heading [rad], shape (K, 4).
            pitch: Pitch of their cameras, positive down [rad], shape (K,).

        Raises:
            EyasError: A number is not finite.
        """
        poses = checked(poses, FARTHEST, "start of a tracker")
        pitch = checked(pitch, LARGEST, "pitch of a camera")
        targets, chosen = self.snapshot.targets, np.asarray(trackers, np.int64)
        yaw = poses[:, 3]
        east, north, up = (poses[:, :3] - targets.position[chosen]).T
        cosine, sine = elementary.cos(yaw), elementary.sin(yaw)
        ahead, left = cosine * east + sine * north, cosine * north - sine * east
        offset = np.stack([ahead, left, up, yaw - targets.yaw[chosen]], axis=1)
        self.snapshot.episodes.start_offset[chosen] = offset
        self._stepper.begin(chosen, pitch, self._episodes.key)

    def sample_time(self, tracker: int, rng: np.random.Generator) -> None:
        """Sample the time at which the episode of a tracker with a world of its own begins, such
        that the traffic lasts as long as a whole episode; `start_at` comes next.
        """
        first = self.config.start.warm_up_steps
        last = round(self.traffic.duration / PHYSICS_STEP) - self.config.done.total_steps
        self.snapshot.episodes.tick[tracker] = rng.integers(first, last + 1)

    def set_fields_of_view(self, fields: Floats) -> None:
        """Zoom the cameras, until the next reset: horizontal fields of view [rad], shape (N,).

        Raises:
            EyasError: One is not finite.
        """
        self.snapshot.cameras.field_of_view[:] = _checked_fields(fields)

    @cached_property
    def clearance(self) -> Clearance:
        """Tells what stands in the way of flights and of looks; loaded when first asked for."""
        assets = self._assets
        return Clearance(assets.solids(), assets.scene.terrain, assets.traffic.motion)

    def follow(self, tracker: int, actor: int) -> None:
        """Make another actor of its world the target of a tracker, from the next step on."""
        self._episodes.follow(tracker, actor)

    def command_gimbal(self, angles: Floats) -> None:
        """Command the cameras' angles, from the next step on; the joints stop at their limits.

        Args:
            angles: Pitch, positive down, and yaw relative to the body [rad], shape (N, 2).

        Raises:
            EyasError: One is not finite.
        """
        angles = checked(angles, LARGEST, "angles of a gimbal")
        self.snapshot.trackers.commanded_gimbal[:] = angles

    def restart_count(self, tracker: int) -> None:
        """Count the steps of a tracker's episode, and those without reward, from 0 again."""
        self._episodes.restart_count(tracker)

    def make_alike(self) -> None:
        """Make the other actors of the target's kind look like it, until the next reset.

        In a world of several trackers, all look like the target of the last.
        """
        self._stepper.sensors.settle()
        for tracker, actor in enumerate(self.snapshot.targets.actor.tolist()):
            self._worlds.make_alike(tracker, actor)

    def dress(self, tracker: int, actor: int, model: int, colour: Colour) -> None:
        """Give an actor around a tracker a model of its kind and a colour, until the next reset.

        What is known of a target is not changed: `follow` it again.
        """
        self._stepper.sensors.settle()
        self._worlds.dress(tracker, actor, model, colour)

    def copy_world(self, tracker: int, source: int) -> None:
        """Give a tracker with a world of its own the time and the looks of another one's, and the
        actor that the other one follows as its target; `start_at` comes next.
        """
        self._worlds.copy_looks(tracker, source)
        self.snapshot.episodes.tick[tracker] = self.snapshot.episodes.tick[source]
        self.follow(tracker, int(self.snapshot.targets.actor[source]))

    @property
    def actors(self) -> int:
        """Number of actors in each world."""
        return self._worlds.actors

    def mates(self, tracker: int) -> NDArray[np.int64]:
        """Return all trackers in the world of a tracker, shape (K,)."""
        return self._worlds.trackers_of(tracker)

    def actors_around(self, tracker: int, ago: int = 0) -> tuple[ActorState, NDArray[np.int32]]:
        """Return all actors of a tracker's world, one world, and the model of each.

        The models are indices into `eyas.engine.targets.catalogue.MODELS`, shape (A,).

        Args:
            tracker: The tracker.
            ago: Physics steps before now.
        """
        tick = int(self.snapshot.episodes.tick[tracker])
        return self._worlds.actors_around(tracker, tick - ago)

    def looks_around(self, tracker: int) -> Looks:
        """Return the models and colours of all actors of a tracker's world, one world."""
        return self._worlds.looks_around(tracker)

    def told(self) -> dict[str, Floats]:
        """Return copies of what the trackers tell of themselves, by name, see `Tracker.told`."""
        return {name: values.copy() for name, values in self._stepper.told.items()}

    def packets(self) -> tuple[Floats, Floats]:
        """Return copies of the basic packets (N, 22) and the reward packets (N, 60).

        The sensors' columns of the basic packets are what the sensors read, with their errors.
        """
        return self._present.packets()

    def readings(self) -> dict[str, Floats]:
        """Return copies of what the further sensors read, see `View.further_readings`."""
        return self._present.further_readings()

    def classes_of(self, objects: NDArray[np.integer]) -> NDArray[np.int64]:
        """Return the `ObjectClass` of objects, or `DRONE_CLASS`; -1 for the id -1, shape (K,).

        Args:
            objects: Object ids as in `Picture.object_id`, shape (K,).
        """
        return self._worlds.classes_of(objects)

    def draw(
        self,
        trackers: NDArray[np.int32],
        picture: Picture,
        *,
        overlay: bool = False,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Draw the pictures of some trackers' cameras.

        Args:
            trackers: The trackers, shape (V,).
            picture: V pictures to draw into; the subject of each is its tracker's target.
            overlay: Whether to draw the overlay of each tracker over the colours; the other arrays
                of the picture do not change.
            until: The stage at which to stop; see `Renderer.draw`.
        """
        rules = self.rules if overlay else None
        self._present.draw(np.asarray(trackers, np.int32), picture, until, rules)

    def draw_from(
        self,
        trackers: NDArray[np.int32],
        cameras: CameraState,
        picture: Picture,
        *,
        overlay: bool = True,
        bodies: bool = False,
    ) -> None:
        """Draw the worlds of some trackers from any camera, for example from behind the drone.

        Args:
            trackers: The tracker whose world each view shows, shape (V,); the subject is its
                target.
            cameras: V cameras.
            picture: V pictures with colours, of any size; pixels are square.
            overlay: Whether to draw all trackers of that world and their overlays over the colours.
            bodies: Whether the bodies of all trackers of that world are there, where they have some
                to be seen: in shared worlds, and where the target sees pictures (`evader.sees`).

        Raises:
            EyasError: A number of a camera is not finite.
        """
        cameras = cameras._replace(
            position=checked(cameras.position, FARTHEST, "position of a camera"),
            rotation=checked(cameras.rotation, 1e3, "rotation of a camera"),
            field_of_view=_checked_fields(cameras.field_of_view),
        )
        chosen, rules = np.asarray(trackers, np.int32), self.rules if overlay else None
        self._present.pictures.draw_from(chosen, cameras, picture, rules, bodies=bodies)

    def close(self) -> None:
        """End live traffic, if that is what drives; may be called twice."""
        self.traffic.close()

    def _result(self) -> StepResult:
        episodes = self.snapshot.episodes
        reward, terms = self._terms.of(self.snapshot)
        return StepResult(reward, terms, episodes.reason.copy(), episodes.done)


def _checked_fields(fields: Floats) -> Floats:
    """Return horizontal fields of view from a thousandth to 3.1 [rad].

    Raises:
        EyasError: One is not finite.
    """
    return np.maximum(checked(fields, 3.1, "field of view of a camera"), 1e-3)
