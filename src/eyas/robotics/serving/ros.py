"""Serve a drone to nodes of ROS 2 that run: topics out, velocities in."""

import logging
import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_RATE, PHYSICS_STEP, physics_steps
from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.serving import Face, Orders, serve
from eyas.engine.world.maps import MAPS

if TYPE_CHECKING:
    from eyas.engine.sim.simulation import Simulation
    from eyas.robotics.ros.dds import Bus
    from eyas.robotics.ros.messages import Messages

_LOG = logging.getLogger("eyas")

AS_FLOWN = updated(
    EyasConfig(),
    {
        "tracker": {"supervised": False},
        "control": {"frequency": 100},
        "camera": {"width": 640, "height": 360},
        "start": {"velocity": "rest"},
    },
)
"""Settings of `eyas serve --ros` without a file: a flight controller flies the drone."""

HEARD = {"/cmd_vel": "geometry_msgs/msg/Twist", "/camera/cmd_vel": "geometry_msgs/msg/Twist"}
"""What it listens to: velocities of the body, and turn rates of the camera."""

_PATIENCE = 0.5  # Longest time that a velocity holds [s]


class Bridge(Face):
    """A drone, what it tells and what it is told."""

    relief = "smaller or fewer pictures help (camera.width, camera.height, video.fps)"

    def __init__(
        self,
        simulation: "Simulation",  # One tracker, not yet reset
        config: EyasConfig,
        bus: "Bus",  # Where messages go and come from
        messages: "Messages",  # Makes the messages
    ) -> None:
        from eyas.engine.state.draw import Picture

        self.simulation, self._config = simulation, config
        self._bus, self._messages = bus, messages
        self._steps = physics_steps(config.control.frequency)
        self._between = max(round(PHYSICS_RATE / config.video.fps), 1)
        self._readers = {name: bus.listen(name, kind) for name, kind in HEARD.items()}
        self._velocities = {name: (np.zeros(6), -_PATIENCE) for name in HEARD}
        camera = config.camera
        many = simulation.actors
        self._picture = Picture.create(1, camera.height, camera.width, subject=True, actors=many)
        self._ticks = self._due = self._number = 0
        simulation.reset()
        simulation.advance(self._command(), 1)  # which may have to be compiled
        simulation.reset()

    @property
    def now(self) -> float:
        """Time since the start [s]."""
        return self._ticks * PHYSICS_STEP

    def receive(self, wait: float) -> Iterable[tuple[str, Any]]:
        """Return the readers, after a time [s]: DDS keeps what has come."""
        time.sleep(wait)
        return [(f"messages of {name}", name) for name in self._readers]

    def take(self, message: str) -> None:
        """Take the velocities of a topic."""
        for twist in self._bus.heard(self._readers[message]):
            parts = _numbers(twist.linear), _numbers(twist.angular)
            whole = np.array([*parts[0], *parts[1]])
            self._velocities[message] = np.where(np.isfinite(whole), whole, 0.0), self.now

    def orders(self) -> Orders:
        """Tell what is due, and return the velocities that hold."""
        if self._ticks >= self._due:
            self._due += self._between
            self._publish()
        return Orders(self._command(), self._steps)

    def answer(self, *, late: bool) -> None:
        """Let time go on."""
        self._ticks += self._steps

    def _command(self) -> NDArray[np.float64]:
        """Return the command that holds now, shape (1, 8)."""
        from eyas.engine.envs.actions import turn_commands

        body, camera = (self._velocity(name) for name in HEARD)
        command = np.array([[body[0], body[1], body[2] * PHYSICS_STEP, body[5]]])
        gimbal = self._config.env.gimbal
        most = np.array([gimbal.pitch_rate, gimbal.yaw_rate])
        rates = np.minimum(np.maximum(camera[4:6], -most), most)
        return np.concatenate((command, turn_commands(rates[None], gimbal)), axis=1)

    def _velocity(self, name: str) -> NDArray[np.float64]:
        velocity, since = self._velocities[name]
        return velocity if self.now - since < _PATIENCE else np.zeros(6)

    def _publish(self) -> None:
        from eyas.engine.exports.capture import frame_of, moment_of
        from eyas.engine.exports.frame import RecordedAction

        simulation, picture = self.simulation, self._picture
        simulation.view.draw(np.zeros(1, np.int32), picture)
        moment = moment_of(simulation, 0, picture, 0)
        frame = frame_of(moment, 0, picture, 0, self._number, RecordedAction(-1, None))
        frame = replace(frame, time=self.now)  # which goes on when the traffic begins anew
        self._number += 1
        for name, message in self._messages.of(frame):
            self._bus.publish(name, message)


def _numbers(vector: Any) -> Sequence[float]:  # noqa: ANN401  # of a message
    return float(vector.x), float(vector.y), float(vector.z)


def run(config: EyasConfig, domain: int) -> None:
    """Fly until the user stops it.

    Raises:
        EyasError: A setting cannot be used, or a library is missing.
        KeyboardInterrupt: The user stopped it.
    """
    from eyas.engine.exports.writer import Run
    from eyas.robotics.ros.dds import Bus
    from eyas.robotics.ros.messages import Messages
    from eyas.robotics.ros.types import message_types

    MAPS.get(config.world.map).light(config.world.weather)  # raises before anything is built
    types = message_types("--ros")
    video = config.video
    about = Run(
        folder=Path(),
        trackers=("DRONE0",),
        config=config,
        target_direction=False,
        jpeg_quality=video.jpeg_quality,
        depth_unit=video.depth_unit,
    )
    messages = Messages(types, about)
    # What the drone is told comes from others here.
    told = {name: kind for name, kind in messages.topics.items() if name not in HEARD}
    bus = Bus(domain, types, told)

    # Slow to import, so only when all else is right.
    from eyas.engine.sim.build import build_simulation
    from eyas.engine.sim.worlds import together

    bridge = Bridge(build_simulation(config, together(1)), config, bus, messages)
    _LOG.info("on the air in domain %d: %s; hears %s", domain, ", ".join(told), ", ".join(HEARD))
    serve(bridge)
