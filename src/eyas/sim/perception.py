"""What is seen of a simulation at an instant: pictures and packets."""

import numpy as np
from numpy.typing import NDArray

from eyas.sensors.grain import Grain
from eyas.sim.assets import Assets
from eyas.sim.config import SimConfig
from eyas.sim.light import LightChanges
from eyas.sim.pictures import Pictures
from eyas.sim.worlds import Worlds
from eyas.state.draw import DrawStage, Picture
from eyas.state.snapshot import Snapshot
from eyas.task.packet_rows import SENSOR_COLUMNS, PacketRows
from eyas.task.rules import Rules

__all__ = ["Perception"]

Floats = NDArray[np.float64]


class Perception:
    """The sight of N trackers: of their present state, or of an earlier one.

    Attributes:
        snapshot: That state, read at each call.
        pictures: Draws it.

    Args:
        config: The settings.
        assets: Scene and renderer.
        worlds: The worlds, with their moving objects.
        light: The light around each tracker.
        grain: Noise of the cameras; None: they have none.
        snapshot: The state.
        told: What sensors with errors read, see `Readings.told`; None: none has errors.
        visible: Whether trackers see each other.
    """

    def __init__(
        self,
        config: SimConfig,
        assets: Assets,
        worlds: Worlds,
        light: LightChanges,
        grain: Grain | None,
        snapshot: Snapshot,
        told: Floats | None,
        *,
        visible: bool,
    ) -> None:
        self.snapshot = snapshot
        self.pictures = Pictures(config, assets, worlds, light, snapshot, visible=visible)
        self._packets = PacketRows(snapshot, config.camera, assets.scene.terrain)
        self._grain, self._told = grain, told

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
        if self._grain is not None and picture.rgb is not None:
            self._grain.add(picture.rgb, trackers, self.snapshot.episodes.step_count)

    def packets(self) -> tuple[Floats, Floats]:
        """Return copies of the basic packets (N, 22) and the reward packets (N, 60)."""
        basic, reward = self._packets.now()
        if self._told is not None:
            basic[:, SENSOR_COLUMNS] = self._told
        return basic, reward
