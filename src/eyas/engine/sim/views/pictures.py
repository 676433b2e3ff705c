"""Pictures of the worlds of a simulation, from its trackers' cameras or from any others."""

from dataclasses import fields, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.lens import LensSet
from eyas.engine.camera.poses import Moving
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.optics.pinhole import field_along
from eyas.engine.overlay.marks import Marks
from eyas.engine.overlay.paint import paint_overlays, with_depth
from eyas.engine.render.outputs import picture_size
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.light import LightChanges
from eyas.engine.sim.views.additions import TrackerBodies
from eyas.engine.sim.views.delay import ShownState
from eyas.engine.sim.views.exposures import Exposures, Moment
from eyas.engine.sim.views.optics import Optics
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.draw import DrawList, DrawStage, MovingParts, Picture, Views
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import CameraState
from eyas.engine.task.rules import Rules

Chosen = NDArray[np.int32]
Floats = NDArray[np.float64]


def is_timed(config: SimConfig) -> bool:
    """Return whether pictures show the instant at which they are taken."""
    world = config.world
    return config.light.flakes or world.wind is not None or world.smoke > 0 or world.spray


class PictureDrawer:
    """Draws the worlds around N trackers.

    Attributes:
        aspect: Height of what their cameras show over its width.
    """

    def __init__(
        self,
        config: SimConfig,  # The settings
        assets: Assets,  # Scene and renderer
        worlds: Worlds,  # The worlds, with their moving objects
        light: LightChanges,  # The light around each tracker
        state: ShownState,  # State of the trackers
        optics: Optics | None = None,  # What is modelled of their cameras beyond pinholes
        *,
        visible: bool = True,  # Whether trackers see each other
    ) -> None:
        snapshot = state.shown
        self._worlds = worlds
        mates = [worlds.trackers_of(n) for n in range(len(worlds.of))]
        actors, part = worlds.actors, assets.body_part
        self._bodies = TrackerBodies(mates, actors, part, visible=visible)
        self._all_bodies = TrackerBodies(mates, actors, part, itself=True)
        self._light = light
        self._snapshot = snapshot
        self._optics, self._camera = optics, None if optics is None else optics.model
        self._thermal = None if optics is None else optics.thermal
        self._lenses = None if optics is None else optics.bent
        self._flakes = config.light.flakes
        self._timed = is_timed(config)
        self._samples, self._tent = config.camera.samples, config.camera.tent
        self._renderer = assets.renderer
        self._size = config.camera.height, config.camera.width
        self.aspect = config.camera.height / config.camera.width
        self._marks = Marks(snapshot, assets.scene.terrain, config.camera)
        self._exposures: Exposures | None = None
        if optics is not None and optics.shutter is not None:
            steady, vibration = state.steady, state.vibration
            self._exposures = Exposures(optics.shutter, steady, vibration, self.aspect, self)

    def prepare(self) -> None:
        """Make now what the first picture needs, so that it does not come late."""
        self._renderer.part_reach()

    def draw(
        self,
        chosen: Chosen,  # The trackers, shape (V,)
        picture: Picture,  # V pictures to draw into; the subject of each is its tracker's target
        until: DrawStage,  # The stage at which to stop; see `Renderer.draw`
        # Rules whose overlay is drawn over the colours; None: no overlay
        overlaid: Rules | None = None,
    ) -> None:
        """Draw the pictures of trackers' cameras.

        Cameras have the aspect ratio of the configured picture. Pictures with another
        one show the same view distorted, like the original's observations: 320x240 resized to
        84x84.
        """
        if self._optics is not None:
            self._optics.ready()
        cameras = CameraState(*(array[chosen] for array in self._snapshot.cameras))
        views, movers = self._own_views(chosen, cameras)
        deep = picture if overlaid is None else with_depth(picture)
        draw = partial(self.render, views, movers, until=until)
        if self._exposures is not None:
            draw = partial(self._exposures.draw, chosen, until)
        step = self._snapshot.episodes.step_count
        if self._thermal is not None and deep.rgb is not None:
            others = replace(deep, rgb=None)
            if any(getattr(others, one.name) is not None for one in fields(others)):
                draw(replace(others, depth=with_depth(deep).depth))
            self._thermal.draw(views, movers, chosen, step, deep.rgb)
            if self._camera is not None:
                self._camera.send(chosen, step, deep.rgb)
        elif self._camera is None or deep.rgb is None or until < DrawStage.SHADING:
            draw(deep)
        else:
            self._camera.draw(draw, chosen, step, deep)
        if overlaid is not None:
            paint_overlays(views, [self._marks.of(n, overlaid) for n in chosen.tolist()], deep)

    def draw_clean(self, chosen: Chosen, picture: Picture) -> None:
        """Draw the pictures of trackers' cameras as if nothing but their lenses were modelled."""
        cameras = CameraState(*(array[chosen] for array in self._snapshot.cameras))
        self.render(*self._own_views(chosen, cameras), picture, DrawStage.SHADING)

    def views_at(self, moment: Moment) -> tuple[Views, DrawList]:
        """Return views of trackers' cameras at moments of their exposures, and the moving things as
        these see them.
        """
        return self._own_views(moment.trackers, moment.cameras, moment.later)

    def moving(self, trackers: Chosen, cameras: CameraState) -> Moving:
        """Return the motion of the actors that trackers' cameras may show."""
        ticks, seeing = self._snapshot.episodes.tick, cameras
        if self._lenses is not None:
            seeing = self._lenses.seeing(trackers, cameras, self.aspect)
        return self._worlds.moving(trackers, ticks, seeing, self.aspect)

    def render(self, views: Views, movers: DrawList, picture: Picture, until: DrawStage) -> None:
        """Draw views of trackers' cameras."""
        self._renderer.draw(views, movers, picture, self._samples, until)

    def draw_from(
        self,
        # The tracker whose world each view shows, shape (V,); the subject is its target
        chosen: Chosen,
        cameras: CameraState,  # V cameras
        picture: Picture,  # V pictures with colours, of any size; pixels are square
        # Rules for the overlay of all trackers of that world; None: no overlay
        rules: Rules | None,
        *,
        bodies: bool = False,  # Whether the bodies of all trackers of that world are drawn
    ) -> None:
        """Draw the worlds of trackers from other cameras."""
        height, width = picture_size(picture)
        views, movers = self._views(chosen, cameras, height / width)
        if bodies:
            movers = self._all_bodies.added(chosen, views.world, movers, self._snapshot.trackers)
            views.world = np.arange(len(chosen), dtype=np.int32)
        deep = picture if rules is None else with_depth(picture)
        self._renderer.draw(views, movers, deep, self._samples)
        if rules is not None:
            worlds = [self._worlds.trackers_of(n).tolist() for n in chosen.tolist()]
            marks = [
                self._marks.of(n, rules, seen)
                for n, seen in zip(chosen.tolist(), worlds, strict=True)
            ]
            paint_overlays(views, marks, deep)

    def draw_parts(
        self,
        tracker: int,
        posed: DrawList,  # All actors of its world, each in the same slots in all pictures
    ) -> MovingParts:
        """Draw which moving part each pixel of a tracker's picture shows."""
        chosen = np.array([tracker], np.int32)
        cameras = CameraState(*(array[chosen] for array in self._snapshot.cameras))
        views, _ = self._views(chosen, cameras, self.aspect, self._lenses)
        views.world = np.zeros(1, np.int32)
        if self._bodies.any:
            posed = self._bodies.added(chosen, views.world, posed, self._snapshot.trackers)
        rows = np.arange(posed.part.shape[1], dtype=np.int32)
        numbered = replace(posed, object_id=ACTOR_OBJECT + rows[None])
        picture = Picture.create(1, *self._size, rgb=False, depth=True, object_id=True)
        self._renderer.draw(views, numbered, picture)
        assert picture.object_id is not None
        assert picture.depth is not None
        row = np.maximum(picture.object_id[0] - ACTOR_OBJECT, -1)
        return MovingParts(row, picture.depth[0], posed.part[0].copy(), posed.pose[0].copy())

    def _own_views(
        self, chosen: Chosen, cameras: CameraState, later: Floats | None = None
    ) -> tuple[Views, DrawList]:
        """Return views of trackers' own cameras, in pictures of any shape, see `_views`."""
        views, movers = self._views(chosen, cameras, self.aspect, self._lenses, later)
        if self._bodies.any:
            bodies = self._snapshot.trackers
            movers = self._bodies.added(chosen, views.world, movers, bodies, later)
            views.world = np.arange(len(chosen), dtype=np.int32)
        views.vertical_field_of_view = np.array(
            [field_along(field, self.aspect) for field in cameras.field_of_view.tolist()]
        )
        return views, movers

    def _views(
        self,
        chosen: Chosen,  # The trackers, shape (V,)
        cameras: CameraState,  # V cameras
        aspect: float,  # Height of what they show over its width
        lenses: LensSet | None = None,  # The lenses of all trackers, if the cameras are theirs
        # How long after what is seen each looks [s], shape (V,); None: then
        later: Floats | None = None,
    ) -> tuple[Views, DrawList]:
        """Return views of the worlds of trackers: cameras, with square pixels, and movers."""
        ticks, seeing = self._snapshot.episodes.tick, cameras
        if lenses is not None:
            seeing = lenses.seeing(chosen, cameras, aspect)
        world, movers = self._worlds.draw_list(chosen, ticks, seeing, aspect, later)
        instant = np.multiply(ticks[chosen], PHYSICS_STEP) if self._timed else None
        if instant is not None and later is not None:
            instant += later
        views = Views(
            position=cameras.position,
            rotation=cameras.rotation,
            world=world,
            subject=self._worlds.object_ids(self._snapshot.targets.actor[chosen]),
            field_of_view=cameras.field_of_view,
            light=self._light.of(chosen),
            instant=instant,
            falling=self._flakes,
            tent=self._tent,
            lens=None if lenses is None else lenses.numbers[chosen],
        )
        return views, movers
