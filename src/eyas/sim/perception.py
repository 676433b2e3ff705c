"""What is seen of a simulation at an instant: pictures and packets."""

import numpy as np
from numpy.typing import NDArray

from eyas.sensors.lidar import Lidar
from eyas.sim.assets import Assets
from eyas.sim.config import SimConfig
from eyas.sim.light import LightChanges
from eyas.sim.pictures import Pictures
from eyas.sim.senses import Senses
from eyas.sim.sight import Sight
from eyas.sim.words import target_in_words
from eyas.sim.worlds import Worlds
from eyas.state.draw import DrawStage, Picture
from eyas.state.motion import ActorView
from eyas.task.packet_rows import SENSOR_COLUMNS, PacketRows
from eyas.task.rules import Rules

__all__ = ["Perception"]

Floats = NDArray[np.float64]


class Perception:
    """What N trackers, or those who record them, get to see: pictures, packets, the lidar.

    Attributes:
        sight: The state that is seen, read at each call.
        pictures: Draws it.

    Args:
        config: The settings.
        assets: Scene and renderer.
        worlds: The worlds, with their moving objects.
        light: The light around each tracker.
        senses: The sensors.
        sight: The state that is seen.
        visible: Whether trackers see each other.
    """

    def __init__(
        self,
        config: SimConfig,
        assets: Assets,
        worlds: Worlds,
        light: LightChanges,
        senses: Senses,
        sight: Sight,
        *,
        visible: bool,
    ) -> None:
        self.sight = sight
        self.pictures = Pictures(config, assets, worlds, light, sight.shown, visible=visible)
        self._packets = PacketRows(sight.snapshot, config.camera, assets.scene.terrain)
        self._senses = senses
        self._worlds = worlds

    def draw(
        self,
        trackers: NDArray[np.int32],
        picture: Picture,
        until: DrawStage = DrawStage.SHADING,
        overlaid: Rules | None = None,
    ) -> None:
        """Draw what the cameras of some trackers see.

        Args:
            trackers: The trackers, shape (V,).
            picture: V pictures to draw into.
            until: Last stage to run, see `Renderer.draw`.
            overlaid: Rules whose overlay is drawn over the colours; None: no overlay.
        """
        if overlaid is None:
            self.pictures.draw(trackers, picture, until)
        else:
            self.pictures.draw_overlaid(trackers, picture, overlaid, until)
        grain = self._senses.grain
        if grain is not None and picture.rgb is not None:
            grain.add(picture.rgb, trackers, self.sight.shown.episodes.step_count)

    def packets(self) -> tuple[Floats, Floats]:
        """Return copies of the basic packets (N, 22) and the reward packets (N, 60)."""
        basic, reward = self._packets.now()
        if self.sight.told is not None:
            basic[:, SENSOR_COLUMNS] = self.sight.told
        return basic, reward

    def actors(self, tracker: int) -> ActorView:
        """Return the actors around a tracker at the instant that its pictures show."""
        tick = int(self.sight.shown.episodes.tick[tracker])
        state, model = self._worlds.actors_around(tracker, tick)
        before, _ = self._worlds.actors_around(tracker, tick - 1)
        return ActorView(state, before, model, self._worlds.looks_around(tracker).colour[0])

    def words(self, tracker: int, aspect: float) -> str:
        """Return the target of a tracker in words, see `eyas.sim.words`."""
        return target_in_words(self.sight.shown, self.actors(tracker), tracker, aspect)

    @property
    def lidar(self) -> Lidar | None:
        """The lidars; what they tell is late by `sight.late`. None: there are none."""
        return self._senses.lidar
