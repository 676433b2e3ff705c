"""What targets that agents move see, and the actions that they may take."""

from typing import Any, Final

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.evader import EvaderSight
from eyas.engine.core.errors import ActionError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import Picture
from eyas.engine.state.snapshot import CameraState
from eyas.lanes import exact

_FIELD: Final = 2.4  # Horizontal field of view of the camera on a target [rad]
_UP: Final = 0.9  # Its pitch, so that it sees the road ahead and a drone above [rad]
_OVER: Final = 0.3  # Its height over the target [m]

Floats = NDArray[np.float64]


class EvaderObserver:
    """Observes for the targets of N trackers.

    Attributes:
        space: The space of one observation.
        actions: The space of one action, see `eyas.engine.sim.evaders.Evaders.actions`.
    """

    def __init__(self, config: EyasConfig, simulation: Simulation) -> None:
        evaders = simulation.evaders
        assert evaders is not None, "evader.driver is set"
        self._simulation, self._evaders = simulation, evaders
        seen = config.env.observation
        self._pictures = config.evader.sees is EvaderSight.PICTURE
        self._size = seen.height, seen.width
        self.space: gymnasium.Space[Any]
        if self._pictures:
            self.space = gymnasium.spaces.Box(0, 255, (*self._size, 3), np.uint8)
        else:
            count = len(evaders.seen_names)
            self.space = gymnasium.spaces.Box(-np.inf, np.inf, (count,), np.float32)
        low, high = evaders.low.astype(np.float32), evaders.high.astype(np.float32)
        self.actions = gymnasium.spaces.Box(low, high)
        self.latest = np.zeros((simulation.count, *(self.space.shape or ())), self.space.dtype)

    def look(self, trackers: NDArray[np.int32]) -> NDArray[Any]:
        """Observe for the targets of some trackers; return the latest of all, shape (N, ...)."""
        if not len(trackers):
            return self.latest
        if not self._pictures:
            self.latest[trackers] = self._evaders.observe(trackers.astype(np.int64))
            return self.latest
        picture = Picture.create(len(trackers), *self._size)
        cameras = self._cameras(trackers)
        self._simulation.draw_from(trackers, cameras, picture, overlay=False, bodies=True)
        self.latest[trackers] = picture.rgb
        return self.latest

    def _cameras(self, trackers: NDArray[np.int32]) -> CameraState:
        """Return the cameras over targets, which look ahead and up."""
        targets, cameras = self._simulation.snapshot.targets, CameraState.create(len(trackers))
        yaw = targets.yaw[trackers]
        cosine, sine, level = exact.cos(yaw), exact.sin(yaw), exact.cos(_UP)
        rise = exact.sin(_UP)
        zero = np.zeros(len(trackers))
        ahead = [level * cosine, level * sine, zero + rise]
        left = [-sine, cosine, zero]
        up = [-rise * cosine, -rise * sine, zero + level]
        cameras.rotation[:] = np.moveaxis(np.array([ahead, left, up]), 2, 0).swapaxes(1, 2)
        cameras.position[:] = targets.position[trackers]
        height = targets.size[trackers, 2] - targets.rise[trackers]
        cameras.position[:, 2] += height + _OVER
        cameras.field_of_view[:] = _FIELD
        return cameras


def evader_actions(actions: Any, count: int, name: str = "actions") -> Floats:  # noqa: ANN401  # whatever a learner returns
    """Return actions of targets as an array of shape (count, 2).

    Raises:
        ActionError: They are none, or not finite.
    """
    try:
        array = np.asarray(actions)
    except (TypeError, ValueError):
        array = np.zeros(0)
    real = array.dtype.kind in "biuf"
    if array.shape != (count, 2) or not real or not np.isfinite(array).all():
        raise ActionError(f"{name}: {str(actions)!r:.80} is not allowed: two finite numbers each")
    return array.astype(np.float64)
