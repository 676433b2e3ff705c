"""Flies the camera as a log says that a real drone flew: `video.flight=flight.ulg`."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.rng import stream
from eyas.engine.core.variation import sample
from eyas.engine.custom.tracks import Placement, on_map
from eyas.engine.custom.trajectory import Trajectory
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.flights.registry import SETTING
from eyas.engine.sim.flights.signals import STEP
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.terrain import reliefs
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.place import projection_of

Floats = NDArray[np.float64]

_LOWEST = 1.0  # Of the camera above the ground [m]


class LoggedFlight:
    """The flight of a log on the map of a simulation.

    Altitudes count from the first one, which is the ground there, and the camera stays a metre
    above the ground. A file without altitudes is flown at `start.height`. The camera looks down by
    `start.pitch`, and ahead.

    Raises:
        ConfigError: The file is no track, or lies elsewhere: one line.
    """

    def __init__(self, file: Path, sim: Simulation, config: EyasConfig) -> None:
        scene = sim.scene
        placement = Placement(
            scene.name, projection_of(MAPS.get(scene.name)), config.video.flight_at, aloft=True
        )
        try:
            self._trajectory: Trajectory = on_map([file], placement)[0][1]
        except DataFileError as error:
            raise ConfigError(f"{SETTING}: {error}") from None
        self._terrain, self._seed = scene.terrain, config.seed
        self._height, self._pitch = config.start.height, config.start.pitch

    def points(self, tracker: int, episode: int, begun: float, count: int, lens: float) -> Floats:
        """Return the control points of a flight, as in `FlightPlan.points`, shape (M, 6).

        Args:
            tracker: Whose flight it is.
            episode: Number of its episode.
            begun: Time of the second point since the start of the log, at whose end it stays [s].
            count: M.
            lens: Field of view [rad].
        """
        rng = stream(self._seed, "flight", tracker, episode)
        height, pitch = sample(self._height, rng), sample(self._pitch, rng)
        last = float(self._trajectory.time[-1])
        times = np.clip(begun + STEP * (np.arange(count) - 1), 0.0, last)
        place, yaw = self._trajectory.at(times)
        ground = reliefs(self._terrain, place[:, :2])
        first = float(reliefs(self._terrain, self._trajectory.position[:1, :2])[0])
        level = np.where(np.isnan(place[:, 2]), ground + height, first + place[:, 2])
        level = np.maximum(level, ground + _LOWEST)
        still = np.full(count, 1.0)
        return np.column_stack([place[:, :2], level, yaw, pitch * still, lens * still])
