"""The drone that an autopilot outside flies, by the outputs to its motors."""

import logging
import math
from collections.abc import Sequence

import numpy as np

from eyas.engine.core.addresses import parsed_address
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.sim.serving import Face, Orders
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import Picture
from eyas.engine.trackers.driven import WEIGHT
from eyas.robotics.mavlink.config import MavlinkConfig
from eyas.robotics.mavlink.fleet import standing_places
from eyas.robotics.mavlink.frames import Geodesy
from eyas.robotics.mavlink.readings import Instant, VehicleReadings
from eyas.robotics.mavlink.video import VideoSender, VideoStream

_LOG = logging.getLogger("eyas")

MOTORS = (0, 2, 1, 3)
"""The motor that turns each rotor: front right, front left, rear left, rear right. PX4's and
ArduPilot's quadrotors of the form X have the same: 1 front right and 2 rear left turn
counter-clockwise, 3 front left and 4 rear right clockwise; so do the original's rotors."""

_PITCH = 0.5  # Pitch of the camera, positive down [rad]
_RESTING = 250  # Physics steps in which it comes to rest on its feet before time begins


class DrivenDrone:
    """One drone, and its sensors.

    Attributes:
        simulation: As below.
        now: Time since it has begun [s].
        instant: What it knows of itself now.

    Args:
        simulation: One tracker, made with `driven_drone`, and `equipped`.
    """

    def __init__(self, simulation: Simulation, config: MavlinkConfig) -> None:
        self.simulation, self._config = simulation, config
        geodesy = Geodesy(config.latitude, config.longitude, config.altitude)
        self._readings = VehicleReadings(simulation, geodesy)
        self._most = 0.25 * config.hil.thrust_to_weight * WEIGHT
        camera = simulation.config.camera
        self._picture = Picture.create(1, camera.height, camera.width)
        self._video: VideoSender | None = None
        if config.video:
            place = parsed_address(config.video, "mavlink.video")
            how = camera.height, camera.width, config.picture_rate, config.video_quality
            self._video = VideoSender(VideoStream(place, *how), 1)
            simulation.view.pictures.prepare()  # not in flight, where time goes on
        simulation.reset()
        self._place = standing_places(simulation)
        self.begin()

    def close(self) -> None:
        """End the thread of the video."""
        if self._video is not None:
            self._video.close()

    def begin(self) -> None:
        """Stand where it stands at first, at time 0, in the traffic of then."""
        simulation = self.simulation
        simulation.reseed(simulation.config.seed)
        simulation.rewind()
        simulation.reset()
        simulation.start_at(np.arange(1), self._place, np.full(1, _PITCH))
        simulation.advance(np.zeros((1, 4)), _RESTING)
        self._ticks, self._picture_due = 0, 0.0
        self._renew()

    def orders(self, outputs: Sequence[float], steps: int) -> Orders:
        """Return the orders that turn its rotors.

        Args:
            outputs: Of the first four motors, 0 to 1; a rotor's rate is proportional to its output,
                its thrust to the square of that.
            steps: Physics steps of 2 ms.
        """
        shares = [outputs[motor] for motor in MOTORS]
        held = [min(max(share, 0.0), 1.0) if math.isfinite(share) else 0.0 for share in shares]
        return Orders(np.array([[self._most * share * share for share in held]]), steps)

    def sense(self, steps: int) -> None:
        """Know what has come of orders of some physics steps, and send a picture if one is due."""
        self._ticks += steps
        self._renew()
        if self._video is not None and self.now >= self._picture_due:
            self._picture_due += 1.0 / self._config.picture_rate
            self.simulation.view.draw(np.zeros(1, np.int32), self._picture)
            assert self._picture.rgb is not None
            self._video.send(self._picture.rgb[0], self.now)

    def _renew(self) -> None:
        self.now = self._ticks * PHYSICS_STEP
        self._readings.renew()
        home = self._place[0, :3].tolist()
        self.instant = Instant(self._readings, 0, (home[0], home[1], home[2]), self.now)

    def home(self) -> tuple[float, float, float]:
        """Return latitude, longitude [degrees] and altitude [m] of where it stands at first."""
        home = self._place[0, :3].tolist()
        return self.instant.global_of((home[0], home[1], home[2]))

    def height(self) -> float:
        """Return its height over the ground below [m], not below 0."""
        body = self.instant.body
        return max(body.position[2] - body.ground, 0.0)


class ExternalAutopilot(Face):
    """What is the same for all autopilots outside."""

    def __init__(
        self,
        drone: DrivenDrone,  # What it flies
        speed: float,  # See `HilConfig.speed`
    ) -> None:
        self._drone, self._speed = drone, speed
        self.simulation = drone.simulation
        self._over = False

    @property
    def speed(self) -> float:
        """Factor on the clock's speed, from the settings."""
        return self._speed

    def rewind(self) -> None:
        """Go on in a traffic that stands still, as an autopilot cannot be put back."""
        if not self._over:
            self._over = True
            _LOG.info("the traffic has reached its end, and stands still")

    def close(self) -> None:
        """End the video."""
        self._drone.close()
