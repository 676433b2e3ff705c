"""What is seen of a simulation at an instant: pictures and packets."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.event_sensor import EventSensors
from eyas.engine.camera.events import EventsConfig
from eyas.engine.camera.exposure import ExposureState
from eyas.engine.camera.paths import Ways, poses_between, speeds_between
from eyas.engine.camera.poses import Exposure, Moments
from eyas.engine.camera.vibration import Vibration
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.optics.lens import Lens
from eyas.engine.sensors.lidar import Lidar
from eyas.engine.sensors.original import ORIGINAL
from eyas.engine.sensors.table import Fitted
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.light import LightChanges
from eyas.engine.sim.views.delay import SeenState
from eyas.engine.sim.views.exposures import Chosen, Moment, PictureStage, exposure_of, ways_of
from eyas.engine.sim.views.further_camera import FurtherCamera
from eyas.engine.sim.views.outlines import Outlines
from eyas.engine.sim.views.parked import ParkedObjects, SeenParked
from eyas.engine.sim.views.pictures import PictureDrawer
from eyas.engine.sim.views.sensor_suite import SensorSuite
from eyas.engine.sim.views.words import in_view, target_in_words
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.draw import DrawStage, MovingParts, Picture
from eyas.engine.state.motion import ActorView
from eyas.engine.state.snapshot import CameraState, Snapshot
from eyas.engine.targets.grammar.in_view import InView
from eyas.engine.task.packet_rows import SENSOR_COLUMNS, SENSOR_COUNT, PacketRows
from eyas.engine.task.rules import Rules

# What event cameras see between two looks: pictures at instants that follow the motion.

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_LIGHT = 8 << 20  # Bytes of light that are drawn before they are seen


class EventViews:
    """Lets the event sensors of N trackers see.

    As in ESIM (Rebecq et al., CoRL 2018, section 4), the light is computed at least as often as
    anything moves by a pixel.

    Attributes:
        sensors: The sensors.
    """

    def __init__(
        self,
        config: EventsConfig,  # The settings
        sensors: EventSensors,
        steady: Snapshot,  # The state that pictures show, without vibration
        vibration: Vibration | None,  # That of the cameras; None: there is none
        aspect: float,  # Height of what the cameras show over its width
        stage: PictureStage,  # Who draws what they see
    ) -> None:
        self.sensors = sensors
        self._config, self._steady, self._vibration = config, steady, vibration
        self._aspect, self._stage = aspect, stage
        count = len(steady.episodes.tick)
        self._before = CameraState.create(count)
        self._origin, self._tick = np.zeros(count, np.int64), np.full(count, -1, np.int64)

    def look(self, chosen: Chosen) -> None:
        """Let the sensors of some trackers see what has changed since their last look, up to the
        instant that pictures show; at the same instant again, their events are the same.
        """
        tick, fresh = self._steady.episodes.tick[chosen], self.sensors.pixels.seen[chosen] == 0
        again = fresh | (tick != self._tick[chosen])
        chosen, tick, fresh = chosen[again], tick[again], fresh[again]
        if not len(chosen):
            return
        self._origin[chosen[fresh]] = tick[fresh]
        self._tick[chosen[fresh]] = tick[fresh]
        exposure = exposure_of(chosen, self._steady, self._vibration)
        for before, now in zip(self._before, exposure.cameras, strict=True):
            before[chosen[fresh]] = now[fresh]
        ways = self._ways(chosen, exposure)
        origin = self._origin[chosen] * PHYSICS_STEP
        self.sensors.forget(chosen.astype(np.int64), ways.begin - origin)
        self._see(chosen, ways, self._samples(chosen, exposure, ways))
        for before, now in zip(self._before, exposure.cameras, strict=True):
            before[chosen] = now
        self._tick[chosen] = tick

    def _ways(self, chosen: Chosen, exposure: Exposure) -> Ways:
        first = CameraState(*(array[chosen] for array in self._before))
        begin = np.multiply(self._tick[chosen], PHYSICS_STEP)
        return Ways(first, exposure.cameras, exposure.shake, begin, exposure.instant)

    def _samples(self, chosen: Chosen, exposure: Exposure, ways: Ways) -> Integers:
        """Return how many pictures each needs: one for each pixel that anything moves."""
        height, width = self.sensors.size
        cameras = exposure.cameras._replace(
            velocity=np.empty((len(chosen), 3)), angular_velocity=np.empty((len(chosen), 3))
        )
        speeds_between(ways, cameras.velocity, cameras.angular_velocity)
        targets, most = self._steady.targets, self._config.most_samples
        way = ways_of(
            exposure._replace(cameras=cameras),
            ways.end - ways.begin,
            (targets.position[:, 2] - targets.rise)[chosen],
            np.array([width, self._aspect, height / width / self._aspect]),
            self._stage.moving(chosen, cameras),
        )
        return np.clip(np.ceil(np.minimum(way, most)), 1, most).astype(np.int64)

    def _see(self, chosen: Chosen, ways: Ways, samples: Integers) -> None:
        """Draw pictures at equal distances of time up to the end of each way, and see them."""
        of = np.repeat(np.arange(len(chosen)), samples)
        number = np.arange(len(of)) - np.repeat(np.cumsum(samples) - samples, samples)
        length = (ways.end - ways.begin)[of]
        later = length * ((number + 1.0) / samples[of] - 1.0)
        time = ways.end[of] + later - self._origin[chosen[of]] * PHYSICS_STEP
        some = max(_LIGHT // (12 * self.sensors.size[0] * self.sensors.size[1]), 1)
        for begin in range(0, len(of), some):
            part = slice(begin, begin + some)
            light = self._light(chosen, ways, of[part], later[part])
            seen, which = np.unique(of[part], return_inverse=True)
            self.sensors.see(chosen[seen].astype(np.int64), which, time[part], light)

    def _light(
        self, chosen: Chosen, ways: Ways, of: Integers, later: Floats
    ) -> NDArray[np.float32]:
        """Return the light at moments, shape (K, 3, H, W)."""
        moments = Moments(of, later, np.empty((len(of), 3)), np.empty((len(of), 3, 3)))
        poses_between(ways, moments)
        fields = ways.last.field_of_view[of]
        cameras = CameraState(moments.position, moments.rotation, fields)
        views, movers = self._stage.views_at(Moment(chosen[of], cameras, later))
        picture = Picture.create(len(of), *self.sensors.size, rgb=False, radiance=True)
        self._stage.render(views, movers, picture, DrawStage.SHADING)
        assert picture.radiance is not None
        return picture.radiance


class View:
    """What N trackers, or those who record them, get to see: pictures, packets, the lidar.

    Attributes:
        state: The state that is seen, read at each call.
        pictures: Draws it.
        lenses: The lenses of the trackers' cameras; None: they bend nothing.
        further: The cameras that trackers have beside their own, by name.
    """

    def __init__(
        self,
        config: SimConfig,  # The settings
        assets: Assets,  # Scene and renderer
        worlds: Worlds,  # The worlds, with their moving objects
        light: LightChanges,  # The light around each tracker
        sensors: SensorSuite,  # What is sensed
        state: SeenState,
        *,
        visible: bool,  # Whether trackers see each other
    ) -> None:
        self.state = state
        self.lenses = sensors.optics.bent
        self.pictures = PictureDrawer(
            config, assets, worlds, light, state, sensors.optics, visible=visible
        )
        self.further = {
            optics.config.name: FurtherCamera(
                optics, config, assets, worlds, light, state, visible=visible
            )
            for optics in sensors.further
        }
        self._events: EventViews | None = None
        if sensors.events is not None:
            events, seen, aspect = config.camera.events, sensors.events, self.pictures.aspect
            shown = state.steady, state.vibration, aspect, self.pictures
            self._events = EventViews(events, seen, *shown)
        self._packets = PacketRows(state.snapshot, config.camera, assets.scene.terrain)
        self._sensors = sensors
        self._worlds = worlds
        self._kind, self._camera = assets.traffic.motion.kind, config.camera
        self._assets = assets

    def draw(
        self,
        trackers: NDArray[np.int32],  # The trackers, shape (V,)
        picture: Picture,  # V pictures to draw into
        until: DrawStage = DrawStage.SHADING,  # Last stage to run, see `Renderer.draw`
        # Rules whose overlay is drawn over the colours; None: no overlay
        overlaid: Rules | None = None,
    ) -> None:
        """Draw what the cameras of some trackers see."""
        self.pictures.draw(trackers, picture, until, overlaid)
        grain = self._sensors.grain
        if grain is not None and picture.rgb is not None:
            grain.add(picture.rgb, trackers, self.state.shown.episodes.step_count)

    def clean(self, tracker: int, height: int, width: int) -> NDArray[np.uint8]:
        """Return a tracker's picture as it would be without noise, blur, dirt and the like: the
        same instant, pose and lens, shape (height, width, 3).
        """
        picture = Picture.create(1, height, width)
        self.pictures.draw_clean(np.array([tracker], np.int32), picture)
        assert picture.rgb is not None
        clean: NDArray[np.uint8] = picture.rgb[0]
        return clean

    def events(self, trackers: NDArray[np.int32]) -> EventSensors | None:
        """Return the event cameras; the events of those of these trackers are what has changed
        between the last two instants at which this was called. None: there are none.
        """
        if self._events is None:
            return None
        self._events.look(trackers)
        return self._events.sensors

    def packets(self) -> tuple[Floats, Floats]:
        """Return copies of the basic packets (N, 22) and the reward packets (N, 60)."""
        basic, reward = self._packets.now()
        if self.state.told is not None:
            basic[:, SENSOR_COLUMNS] = self.state.told[:, :SENSOR_COUNT]
        return basic, reward

    def readings(self, fitted: Fitted) -> Floats:
        """Return a copy of what a sensor of each tracker reads, shape (N, width)."""
        if self.state.told is not None:
            return self.state.told[:, fitted.columns].copy()
        return self._packets.now()[0][:, SENSOR_COLUMNS][:, fitted.columns]

    def further_readings(self) -> dict[str, Floats]:
        """Return copies of what the further sensors read by the names of their parts, each of shape
        (N, width).
        """
        told = self.state.told
        return {
            name: told[:, columns].copy()
            for fitted in self._sensors.fitted[len(ORIGINAL) :]
            for name, columns in fitted.sensor.slices(fitted.first).items()
            if told is not None  # it is where there are such sensors
        }

    def actors(
        self,
        tracker: int,
        later: int = 0,  # Physics steps after that
    ) -> ActorView:
        """Return the actors around a tracker at the instant that its pictures show."""
        tick = int(self.state.shown.episodes.tick[tracker]) + later
        state, model = self._worlds.actors_around(tracker, tick)
        before, _ = self._worlds.actors_around(tracker, tick - 1)
        return ActorView(state, before, model, self._worlds.looks_around(tracker).colour[0])

    def around(self, trackers: Sequence[int]) -> list[ActorView]:
        """Return `actors` of some trackers: one and the same for all that see a world at a time."""
        ticks, found = self.state.shown.episodes.tick, dict[tuple[int, int], ActorView]()
        keys = [(int(self._worlds.of[n]), int(ticks[n])) for n in trackers]
        for key, tracker in zip(keys, trackers, strict=True):
            found[key] = found.get(key) or self.actors(tracker)
        return [found[key] for key in keys]

    def lamps(self, tracker: int) -> NDArray[np.uint8] | None:
        """Return what the actors around a tracker signal at the instant that its pictures show, a
        `Lamp` each, shape (A,); None: nobody does.
        """
        return self._worlds.lamps_around(int(self.state.shown.episodes.tick[tracker]))

    @cached_property
    def _outlines(self) -> Outlines:
        return Outlines(self._kind, self._camera.width, self._camera.height)

    def whole_boxes(
        self,
        tracker: int,
        actors: ActorView,  # The actors around it
        wanted: NDArray[np.integer],  # Which of them, shape (B,)
    ) -> Floats:
        """Return what some actors would cover of a tracker's picture, see `Outlines.of`."""
        cameras, lens = self.state.shown.cameras, self.lens_of(tracker)
        return self._outlines.of(actors, wanted, cameras, tracker, lens)

    @cached_property
    def _parked(self) -> ParkedObjects:
        return ParkedObjects(self._assets.scene)

    def parked(
        self,
        tracker: int,
        shown: NDArray[np.int32],  # Object of each pixel of its picture, shape (H, W)
        # Distance of each pixel along the optical axis [m], shape (H, W)
        depth: NDArray[np.float32],
    ) -> list[SeenParked]:
        """Return the parked objects that a tracker's picture shows, see `ParkedObjects.seen`."""
        cameras, lens = self.state.shown.cameras, self.lens_of(tracker)
        return self._parked.seen(shown, depth, cameras, tracker, lens)

    def lens_of(self, tracker: int) -> Lens | None:
        """Return the lens of a tracker's camera; None: it is a pinhole."""
        return None if self.lenses is None else self.lenses.of_tracker(tracker)

    def parts(
        self,
        tracker: int,
        actors: ActorView,  # The actors around it
    ) -> MovingParts:
        """Return which moving part each pixel of a tracker's picture shows."""
        return self.pictures.draw_parts(tracker, self._outlines.posed(actors))

    def words(
        self,
        tracker: int,
        aspect: float,  # Height of its camera's picture over its width
        actors: ActorView | None = None,  # The actors around it; None: not known yet
    ) -> str:
        """Return the target of a tracker in words, see `eyas.engine.sim.views.words`."""
        around, lens = actors or self.actors(tracker), self.lens_of(tracker)
        return target_in_words(self.state.shown, around, tracker, aspect, lens)

    def in_view(
        self,
        tracker: int,
        later: int = 0,  # Physics steps after the instant that its pictures show; the camera stays
    ) -> InView:
        """Return the moving objects in a tracker's view, for phrases about them."""
        aspect = self._camera.height / self._camera.width
        actors = self.actors(tracker, later)
        return in_view(self.state.shown, actors, tracker, aspect, self.lens_of(tracker))

    @property
    def exposure(self) -> ExposureState | None:
        """Exposure times and speeds of the last pictures; None: cameras have no modelled sensor."""
        self._sensors.optics.ready()
        camera = self._sensors.optics.model
        return None if camera is None or camera.development is None else camera.development.exposure

    @property
    def lidar(self) -> Lidar | None:
        """The lidars; what they tell is late by `state.late`. None: there are none."""
        return self._sensors.lidar
