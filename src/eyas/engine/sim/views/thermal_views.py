"""Thermal pictures of trackers: from what the renderer says of each pixel, not from light."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.temperature import SurfaceTemperatures
from eyas.engine.camera.thermal import (
    ThermalConfig,
    ThermalFrames,
    ThermalImager,
    slot_heat,
)
from eyas.engine.core.counter_rng import SEEDS
from eyas.engine.render.outputs import picture_size
from eyas.engine.sim.assets import Assets
from eyas.engine.state.draw import DrawList, Picture, Views
from eyas.engine.state.scene import ACTOR_OBJECT


class ThermalViews:
    """The thermal cameras of N trackers.

    Args:
        config: The settings.
        assets: Scene, light and renderer.
        hour: Hour of the day; None: the weather's own.
        count: N.
    """

    def __init__(
        self, config: ThermalConfig, assets: Assets, hour: float | None, count: int
    ) -> None:
        self._temperatures = SurfaceTemperatures(assets.lighting, hour)
        classes = assets.scene.object_class
        self._imager = ThermalImager(config, self._temperatures, classes)
        self._renderer, self._reach = assets.renderer, assets.renderer.part_reach()
        self._fog = float(assets.lighting.fog_density)
        self._seed = np.zeros(count, np.int64)

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        self._seed[tracker] = rng.integers(SEEDS)

    def draw(
        self,
        views: Views,  # V views
        movers: DrawList,  # The moving things
        trackers: NDArray[np.integer],  # The tracker of each view, shape (V,)
        step: NDArray[np.int64],  # Physics steps of each tracker since its reset, shape (N,)
        rgb: NDArray[np.uint8],  # Written, shape (V, H, W, 3)
    ) -> None:
        """Write the pictures of some trackers, grey."""
        slots = np.arange(movers.part.shape[1], dtype=np.int32)
        numbered = np.broadcast_to(ACTOR_OBJECT + slots, movers.part.shape)
        shown = Picture.create(
            len(rgb), *rgb.shape[1:3], rgb=False, depth=True, object_id=True, normal=True
        )
        numbers = replace(movers, object_id=np.ascontiguousarray(numbered))
        self._renderer.draw(views, numbers, shown)
        assert shown.object_id is not None
        assert shown.depth is not None
        assert shown.normal is not None
        fog = np.full(len(rgb), self._fog, np.float32)
        frames = ThermalFrames(
            object_id=shown.object_id,
            depth=shown.depth,
            normal=shown.normal,
            eye=views.position,
            rotation=views.rotation,
            ray=1.0 / views.focal(*picture_size(shown)),
            lens=np.zeros((0, 10)) if views.lens is None else views.lens,
            world=views.world,
            heat=slot_heat(movers, self._reach, self._temperatures.air),
            fog=fog if views.light is None else views.light.fog_density,
            seed=self._seed[trackers],
            step=step[trackers],
        )
        self._imager.develop(frames, rgb)
