"""The simulation: N trackers, each with a target, in worlds of their own or in one."""

from math import atan, tan

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.overlay.marks import Projection
from eyas.overlay.paint import paint_overlays, with_depth
from eyas.render.jobs import picture_size
from eyas.render.kernels.bundles import Stage
from eyas.sensors.camera import Camera
from eyas.sim.config import SimConfig
from eyas.sim.episodes import Episodes
from eyas.sim.fleet import Traffic, camera_view, create_fleet, target_view, tracker_view
from eyas.sim.light import LightChanges
from eyas.sim.place import Place
from eyas.sim.step import begin_episodes, fill_packets, fly, follow
from eyas.sim.worlds import Worlds
from eyas.state.draw import Picture, Views
from eyas.state.tracker import CameraPose
from eyas.targets.catalogue import VEHICLES
from eyas.task.columns import DIRECTION, REASON, REWARD, STEP_COUNT
from eyas.task.packets import RewardPacket
from eyas.task.rules import make_rules

__all__ = ["Simulation"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class Simulation:
    """N trackers at once. Made by `eyas.sim.build.build_simulation`.

    Attributes:
        config: The settings.
        count: N.
        trackers: Their state; arrays are written in place by each step.
        cameras: Poses of their cameras; likewise.
        targets: What they follow; likewise.

    Args:
        config: The settings.
        place: Map and traffic.
        count: N.
        shared_world: One world and one time for all, or one for each.
    """

    def __init__(self, config: SimConfig, place: Place, count: int, *, shared_world: bool) -> None:
        self.config = config
        self.count = count
        self._place = place
        self._fleet = create_fleet(count, config.camera)
        self._rules = make_rules(
            config.reward, config.done, config.camera, place.scene.ground_height
        )
        self._traffic = Traffic(place.replay.table, float(place.replay.rate))
        self._worlds = Worlds(config, place, count, shared=shared_world)
        foggy = config.world.weather == "foggy"
        self._light = LightChanges(
            config.light, place.lighting, count, foggy=foggy, shared=shared_world
        )
        self._episodes = Episodes(config, place.replay, self._worlds, self._light, count)
        self._camera = Camera(config.camera, place.renderer)
        self._projection = Projection(self._fleet, self._rules, config.camera, self._worlds)
        self.trackers = tracker_view(self._fleet)
        self.cameras = camera_view(self._fleet)
        self.targets = target_view(self._fleet)

    def reseed(self, seed: int) -> None:
        """Begin the sequence of episodes of another seed; takes effect at the next reset."""
        self._episodes.reseed(seed)

    def reset(self, trackers: NDArray[np.bool_] | None = None) -> None:
        """Begin a new episode.

        Args:
            trackers: Which, shape (N,); None for all.

        Raises:
            SpawnError: There is no target for one of them.
            ConfigError: The recording is too short for an episode.
        """
        chosen = np.arange(self.count) if trackers is None else np.flatnonzero(trackers)
        pitch = self._episodes.draw(chosen, self._fleet)
        begin_episodes(chosen, pitch, self._fleet, self._traffic, self._rules)

    def advance(self, actions: Floats, physics_steps: int = 1) -> None:
        """Hold actions for some physics steps of 2 ms, each of which is judged.

        Args:
            actions: Forward [m/s], left [m/s], up [m per 2 ms], yaw rate [rad/s], shape (N, 4).
            physics_steps: How many.
        """
        held = np.ascontiguousarray(actions, np.float64)
        assert held.shape == (self.count, 4), f"actions: shape {held.shape}, not {(self.count, 4)}"
        fly(physics_steps, held, self._fleet, self._traffic, self._rules)

    def follow(self, physics_steps: int = 1) -> None:
        """Carry all trackers along at their start's offset from the target."""
        follow(physics_steps, self._fleet, self._traffic, self._rules)

    def draw(
        self, trackers: NDArray[np.int32], picture: Picture, until: Stage = Stage.SHADING
    ) -> None:
        """Draw what the cameras of some trackers see.

        Args:
            trackers: Which, shape (V,).
            picture: V pictures; the subject is each tracker's target.
            until: Where to stop, see `Renderer.draw`.
        """
        self._see(np.asarray(trackers), picture, until)

    def draw_overlaid(self, trackers: NDArray[np.int32], picture: Picture) -> None:
        """Draw like `draw`, and what each camera sees, rewards and looks for over its colours.

        Args:
            trackers: Which, shape (V,).
            picture: V pictures with colours; whatever else is wanted stays without the overlay.
        """
        chosen = np.asarray(trackers)
        deep = with_depth(picture)
        views = self._see(chosen, deep, Stage.SHADING)
        paint_overlays(views, [self._projection.of(n) for n in chosen.tolist()], deep)

    def draw_from(
        self,
        trackers: NDArray[np.int32],
        viewpoint: CameraPose,
        picture: Picture,
        *,
        vertical_field_of_view: float = 0.95,
        overlay: bool = True,
    ) -> None:
        """Draw the worlds of some trackers from anywhere, such as from behind the drone.

        Args:
            trackers: Whose world each view shows, shape (V,); the subject is its target.
            viewpoint: V cameras.
            picture: V pictures with colours, of any size; pixels are square.
            vertical_field_of_view: [rad].
            overlay: Whether all trackers of that world, and what their cameras see, reward and
                look for, are drawn over the colours.
        """
        chosen = np.asarray(trackers)
        world, movers = self._worlds.draw_list(chosen, self._fleet.tick)
        height, width = picture_size(picture)
        views = Views(
            position=viewpoint.position,
            rotation=viewpoint.rotation,
            world=world,
            subject=self._worlds.object_ids(self.targets.actor[chosen]),
            field_of_view=2 * atan(tan(0.5 * vertical_field_of_view) * width / height),
            light=self._light.of(chosen),
            instant=self._times(chosen),
        )
        deep = with_depth(picture) if overlay else picture
        self._place.renderer.draw(views, movers, deep, self.config.camera.samples)
        if overlay:
            together = range(self.count) if self._worlds.shared else None
            paint_overlays(
                views, [self._projection.of(n, together or (n,)) for n in chosen.tolist()], deep
            )

    def _see(self, chosen: NDArray[np.int32], picture: Picture, until: Stage) -> Views:
        pose = CameraPose(self.cameras.position[chosen], self.cameras.rotation[chosen])
        world, movers = self._worlds.draw_list(chosen, self._fleet.tick)
        subject = self._worlds.object_ids(self.targets.actor[chosen])
        light = self._light.of(chosen)
        instant = self._times(chosen)
        return self._camera.read(pose, world, subject, light, instant, movers, picture, until)

    def _times(self, chosen: NDArray[np.int32]) -> Floats | None:
        """Return times in the recording for what falls through the air [s], None for nothing."""
        if not self.config.light.flakes:
            return None
        return np.asarray(self._fleet.tick[chosen] * PHYSICS_STEP, np.float64)

    @property
    def light(self) -> NDArray[np.float32]:
        """Factor on the sky and its light, factor on the sun, fog density [1/m], shape (N, 3)."""
        return self._light.factors.copy()

    def packets(self) -> tuple[Floats, Floats]:
        """Return copies of the basic (N, 22) and the reward packets (N, 60)."""
        fill_packets(self._fleet, self._rules)
        return self._fleet.basic.copy(), self._fleet.reward.copy()

    def reward_packet(self, tracker: int) -> RewardPacket:
        """Return the reward packet of one tracker by name."""
        fill_packets(self._fleet, self._rules)
        return RewardPacket.from_row(self._fleet.reward[tracker], self.target_type(tracker))

    @property
    def time(self) -> float:
        """Time in the recording of tracker 0's world [s]."""
        return float(self._fleet.tick[0]) * PHYSICS_STEP

    @property
    def step_count(self) -> Integers:
        """2 ms steps since each reset, shape (N,)."""
        return self._fleet.task_memory[:, STEP_COUNT].astype(np.int64)

    @property
    def episode(self) -> Integers:
        """Number of each tracker's episode, from 0, shape (N,)."""
        return self._episodes.number.copy()

    @property
    def reward(self) -> Floats:
        """Built-in rewards, shape (N,)."""
        return self._fleet.task_memory[:, REWARD].copy()

    @property
    def reason(self) -> Integers:
        """`DoneReason` of each tracker, shape (N,)."""
        return self._fleet.task_memory[:, REASON].astype(np.int64)

    @property
    def done(self) -> NDArray[np.bool_]:
        """Whether each episode has ended, shape (N,)."""
        return self._fleet.task_memory[:, REASON] > 0

    @property
    def direction(self) -> Integers:
        """`TargetDirection` of each target, shape (N,)."""
        return self._fleet.task_memory[:, DIRECTION].astype(np.int64)

    def target_type(self, tracker: int) -> str:
        """Return the name of a target's model."""
        return VEHICLES[self._worlds.model_of(tracker, int(self.targets.actor[tracker]))].name

    def target_size(self, tracker: int) -> tuple[float, float, float]:
        """Return length, width and height of a target [m]."""
        return VEHICLES[self._worlds.model_of(tracker, int(self.targets.actor[tracker]))].size
