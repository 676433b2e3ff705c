"""Pictures of the worlds of a simulation, from its trackers' cameras or from any others."""

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.pinhole import field_along
from eyas.overlay.marks import Marks
from eyas.overlay.paint import paint_overlays, with_depth
from eyas.render.outputs import picture_size
from eyas.sim.assets import Assets
from eyas.sim.config import SimConfig
from eyas.sim.light import LightChanges
from eyas.sim.views.additions import TrackerBodies
from eyas.sim.views.camera_model import CameraModel
from eyas.sim.worlds import Worlds
from eyas.state.draw import DrawList, DrawStage, MovingParts, Picture, Views
from eyas.state.scene import ACTOR_OBJECT
from eyas.state.snapshot import CameraState, Snapshot
from eyas.task.rules import Rules

__all__ = ["PictureDrawer"]

Chosen = NDArray[np.int32]


class PictureDrawer:
    """Draws the worlds around N trackers.

    Args:
        config: The settings.
        assets: Scene and renderer.
        worlds: The worlds, with their moving objects.
        light: The light around each tracker.
        snapshot: State of the trackers.
        camera: What else is modelled of their cameras; None: nothing.
        visible: Whether trackers see each other.
    """

    def __init__(
        self,
        config: SimConfig,
        assets: Assets,
        worlds: Worlds,
        light: LightChanges,
        snapshot: Snapshot,
        camera: CameraModel | None = None,
        *,
        visible: bool = True,
    ) -> None:
        self._worlds = worlds
        mates = [worlds.trackers_of(n) for n in range(len(worlds.of))]
        actors, part = worlds.actors, assets.body_part
        self._bodies = TrackerBodies(mates, actors, part, visible=visible)
        self._light = light
        self._snapshot, self._camera = snapshot, camera
        self._flakes = config.light.flakes
        self._samples = config.camera.samples
        self._renderer = assets.renderer
        self._size = config.camera.height, config.camera.width
        self._aspect = config.camera.height / config.camera.width
        self._marks = Marks(snapshot, assets.scene.terrain, config.camera)

    def draw(
        self, chosen: Chosen, picture: Picture, until: DrawStage, overlaid: Rules | None = None
    ) -> None:
        """Draw the pictures of trackers' cameras.

        Cameras are pinholes with the aspect ratio of the configured picture. Pictures with another
        one show the same view distorted, like the original's observations: 320x240 resized to
        84x84.

        Args:
            chosen: The trackers, shape (V,).
            picture: V pictures to draw into; the subject of each is its tracker's target.
            until: The stage at which to stop; see `Renderer.draw`.
            overlaid: Rules whose overlay is drawn over the colours; None: no overlay.
        """
        cameras = CameraState(*(array[chosen] for array in self._snapshot.cameras))
        views, movers = self._views(chosen, cameras, self._aspect)
        if self._bodies.any:
            movers = self._bodies.added(chosen, views.world, movers, self._snapshot.trackers)
            views.world = np.arange(len(chosen), dtype=np.int32)
        fields = cameras.field_of_view.tolist()
        views.vertical_field_of_view = np.array([field_along(f, self._aspect) for f in fields])
        deep = picture if overlaid is None else with_depth(picture)
        draw = partial(self._renderer.draw, views, movers, samples=self._samples, until=until)
        if self._camera is None or deep.rgb is None or until < DrawStage.SHADING:
            draw(deep)
        else:
            self._camera.draw(draw, chosen, self._snapshot.episodes.step_count, deep)
        if overlaid is not None:
            paint_overlays(views, [self._marks.of(n, overlaid) for n in chosen.tolist()], deep)

    def draw_from(
        self,
        chosen: Chosen,
        cameras: CameraState,
        picture: Picture,
        rules: Rules | None,
    ) -> None:
        """Draw the worlds of trackers from other cameras.

        Args:
            chosen: The tracker whose world each view shows, shape (V,); the subject is its target.
            cameras: V cameras.
            picture: V pictures with colours, of any size; pixels are square.
            rules: Rules for the overlay of all trackers of that world; None: no overlay.
        """
        height, width = picture_size(picture)
        views, movers = self._views(chosen, cameras, height / width)
        deep = picture if rules is None else with_depth(picture)
        self._renderer.draw(views, movers, deep, self._samples)
        if rules is not None:
            worlds = [self._worlds.trackers_of(n).tolist() for n in chosen.tolist()]
            marks = [
                self._marks.of(n, rules, seen)
                for n, seen in zip(chosen.tolist(), worlds, strict=True)
            ]
            paint_overlays(views, marks, deep)

    def draw_parts(self, tracker: int, posed: DrawList) -> MovingParts:
        """Draw which moving part each pixel of a tracker's picture shows.

        Args:
            tracker: The tracker.
            posed: All actors of its world, each in the same slots in all pictures.
        """
        chosen = np.array([tracker], np.int32)
        cameras = CameraState(*(array[chosen] for array in self._snapshot.cameras))
        views, _ = self._views(chosen, cameras, self._aspect)
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

    def _views(self, chosen: Chosen, cameras: CameraState, aspect: float) -> tuple[Views, DrawList]:
        """Return views of the worlds of trackers: cameras, with square pixels, and movers.

        `aspect` is the height of what the cameras show over its width.
        """
        ticks = self._snapshot.episodes.tick
        world, movers = self._worlds.draw_list(chosen, ticks, cameras, aspect)
        views = Views(
            position=cameras.position,
            rotation=cameras.rotation,
            world=world,
            subject=self._worlds.object_ids(self._snapshot.targets.actor[chosen]),
            field_of_view=cameras.field_of_view,
            light=self._light.of(chosen),
            instant=np.multiply(ticks[chosen], PHYSICS_STEP) if self._flakes else None,
        )
        return views, movers
