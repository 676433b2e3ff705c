"""What is seen of a simulation at an instant: pictures and packets."""

import numpy as np
from numpy.typing import NDArray

from eyas.sim.assets import Assets
from eyas.sim.config import SimConfig
from eyas.sim.light import LightChanges
from eyas.sim.pictures import Pictures
from eyas.sim.worlds import Worlds
from eyas.state.draw import DrawStage, Picture
from eyas.state.snapshot import Snapshot
from eyas.task.packet_rows import PacketRows

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
        snapshot: The state.
        visible: Whether trackers see each other.
    """

    def __init__(
        self,
        config: SimConfig,
        assets: Assets,
        worlds: Worlds,
        light: LightChanges,
        snapshot: Snapshot,
        *,
        visible: bool,
    ) -> None:
        self.snapshot = snapshot
        self.pictures = Pictures(config, assets, worlds, light, snapshot, visible=visible)
        self._packets = PacketRows(snapshot, config.camera, assets.scene.terrain)

    def draw(self, trackers: NDArray[np.int32], picture: Picture) -> None:
        """Draw what the cameras of some trackers see.

        Args:
            trackers: The trackers, shape (V,).
            picture: V pictures to draw into.
        """
        self.pictures.draw(np.asarray(trackers, np.int32), picture, DrawStage.SHADING)

    def packets(self) -> tuple[Floats, Floats]:
        """Return copies of the basic packets (N, 22) and the reward packets (N, 60)."""
        return self._packets.now()
