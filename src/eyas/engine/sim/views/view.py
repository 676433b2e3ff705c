"""What is seen of a simulation at an instant: pictures and packets."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.event_sensor import EventSensors
from eyas.engine.camera.exposure import ExposureState
from eyas.engine.core.optics.lens import Lens
from eyas.engine.sensors.lidar import Lidar
from eyas.engine.sensors.original import ORIGINAL
from eyas.engine.sensors.table import Fitted
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.light import LightChanges
from eyas.engine.sim.views.delay import SeenState
from eyas.engine.sim.views.event_views import EventViews
from eyas.engine.sim.views.further_camera import FurtherCamera
from eyas.engine.sim.views.outlines import Outlines
from eyas.engine.sim.views.parked import ParkedObjects, SeenParked
from eyas.engine.sim.views.pictures import PictureDrawer
from eyas.engine.sim.views.sensor_suite import SensorSuite
from eyas.engine.sim.views.words import in_view, target_in_words
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.draw import DrawStage, MovingParts, Picture
from eyas.engine.state.motion import ActorView
from eyas.engine.targets.grammar.in_view import InView
from eyas.engine.task.packet_rows import SENSOR_COLUMNS, SENSOR_COUNT, PacketRows
from eyas.engine.task.rules import Rules

Floats = NDArray[np.float64]


class View:
    """What N trackers, or those who record them, get to see: pictures, packets, the lidar.

    Attributes:
        state: The state that is seen, read at each call.
        pictures: Draws it.
        lenses: The lenses of the trackers' cameras; None: they bend nothing.
        further: The cameras that trackers have beside their own, by name.

    Args:
        config: The settings.
        assets: Scene and renderer.
        worlds: The worlds, with their moving objects.
        light: The light around each tracker.
        sensors: What is sensed.
        state: The state that is seen.
        visible: Whether trackers see each other.
    """

    def __init__(
        self,
        config: SimConfig,
        assets: Assets,
        worlds: Worlds,
        light: LightChanges,
        sensors: SensorSuite,
        state: SeenState,
        *,
        visible: bool,
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

    def actors(self, tracker: int, later: int = 0) -> ActorView:
        """Return the actors around a tracker at the instant that its pictures show.

        Args:
            tracker: The tracker.
            later: Physics steps after that.
        """
        tick = int(self.state.shown.episodes.tick[tracker]) + later
        state, model = self._worlds.actors_around(tracker, tick)
        before, _ = self._worlds.actors_around(tracker, tick - 1)
        return ActorView(state, before, model, self._worlds.looks_around(tracker).colour[0])

    def lamps(self, tracker: int) -> NDArray[np.uint8] | None:
        """Return what the actors around a tracker signal at the instant that its pictures show, a
        `Lamp` each, shape (A,); None: nobody does.
        """
        return self._worlds.lamps_around(int(self.state.shown.episodes.tick[tracker]))

    @cached_property
    def _outlines(self) -> Outlines:
        return Outlines(self._kind, self._camera.width, self._camera.height)

    def whole_boxes(self, tracker: int, actors: ActorView, wanted: NDArray[np.integer]) -> Floats:
        """Return what some actors would cover of a tracker's picture, see `Outlines.of`.

        Args:
            tracker: The tracker.
            actors: The actors around it.
            wanted: Which of them, shape (B,).
        """
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

    def parts(self, tracker: int, actors: ActorView) -> MovingParts:
        """Return which moving part each pixel of a tracker's picture shows.

        Args:
            tracker: The tracker.
            actors: The actors around it.
        """
        return self.pictures.draw_parts(tracker, self._outlines.posed(actors))

    def words(self, tracker: int, aspect: float, actors: ActorView | None = None) -> str:
        """Return the target of a tracker in words, see `eyas.engine.sim.views.words`.

        Args:
            tracker: The tracker.
            aspect: Height of its camera's picture over its width.
            actors: The actors around it; None: not known yet.
        """
        around, lens = actors or self.actors(tracker), self.lens_of(tracker)
        return target_in_words(self.state.shown, around, tracker, aspect, lens)

    def in_view(self, tracker: int, later: int = 0) -> InView:
        """Return the moving objects in a tracker's view, for phrases about them.

        Args:
            tracker: The tracker.
            later: Physics steps after the instant that its pictures show; the camera stays.
        """
        aspect = self._camera.height / self._camera.width
        actors = self.actors(tracker, later)
        return in_view(self.state.shown, actors, tracker, aspect, self.lens_of(tracker))

    @property
    def exposure(self) -> ExposureState | None:
        """Exposure times and speeds of the last pictures; None: cameras have no modelled sensor."""
        camera = self._sensors.optics.model
        return None if camera is None or camera.development is None else camera.development.exposure

    @property
    def lidar(self) -> Lidar | None:
        """The lidars; what they tell is late by `state.late`. None: there are none."""
        return self._sensors.lidar
