"""All vehicles in one world: their steps, their packets and their pictures."""

import logging
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from eyas.engine.core.clock import PHYSICS_RATE, physics_steps
from eyas.engine.core.faults import FaultLog
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import Picture
from eyas.engine.task.config import Crash
from eyas.robotics.mavlink.camera import Lens
from eyas.robotics.mavlink.config import MavlinkConfig
from eyas.robotics.mavlink.endpoint import parsed_address
from eyas.robotics.mavlink.frames import Geodesy
from eyas.robotics.mavlink.modes import Landed, Mode
from eyas.robotics.mavlink.places import standing_places
from eyas.robotics.mavlink.readings import Readings
from eyas.robotics.mavlink.targets import Sights, seen_in
from eyas.robotics.mavlink.vehicle import Vehicle
from eyas.robotics.mavlink.video import Stream, VideoSender

__all__ = ["Fleet"]

_LOG = logging.getLogger("eyas")

_DATAGRAM = 1200
"""Packets are gathered up to this size [bytes]."""
_TOGETHER = 4
"""Most pictures that are drawn at once: of 20 vehicles, 320x240 pixels, one takes 6.4 ms so, 9.0 ms
alone."""


class Fleet:
    """Vehicles that fly in real time, or step by step.

    Attributes:
        period: Length of a step: that of a command [s].
        vehicles: By number.
        now: Time since the start [s].

    Args:
        simulation: Trackers in one world, not yet reset.
        config: Its settings.
        out: Takes datagrams.

    Raises:
        EyasError: Something of the settings is not possible.
    """

    def __init__(
        self, simulation: Simulation, config: MavlinkConfig, out: Callable[[bytes], None]
    ) -> None:
        self._simulation, self._config, self._out = simulation, config, out
        self._steps = physics_steps(simulation.config.control.frequency)
        self.period = self._steps / PHYSICS_RATE
        self.now, self._taken = 0.0, 0
        self._gathered: list[bytes] = []
        self._length = 0
        self._faults = FaultLog()
        geodesy = Geodesy(config.latitude, config.longitude, config.altitude)
        self._readings, self._sights = Readings(simulation, geodesy), Sights(simulation)
        count = simulation.count
        self._commands, self._angles = np.zeros((count, 4)), np.zeros((count, 2))
        self._senders = self._video()
        self._pitch = np.full(count, 0.5)
        simulation.reset()
        self._fields = simulation.snapshot.cameras.field_of_view.copy()
        places = standing_places(simulation)
        simulation.start_at(np.arange(count), places, self._pitch)
        self.vehicles = [self._vehicle(at, tuple(places[at, :3])) for at in range(count)]
        self._groups = [
            list(range(first, min(first + _TOGETHER, count)))
            for first in range(0, count, _TOGETHER)
        ]
        # Not all at once, so that no step takes long.
        spread = np.arange(len(self._groups)) / (len(self._groups) * config.picture_rate)
        self._picture_due: list[float] = spread.tolist()
        camera, most = simulation.config.camera, len(self._groups[0])
        self._picture = Picture.create(most, camera.height, camera.width, subject=True)
        # A target that nobody tracks is not measured, which is 6 % of a picture's time.
        self._plain = replace(self._picture, subject_box=None, subject_pixels=None)
        self._set_points = [0] * count
        self._crashed = np.zeros(count, np.bool_)

    def _video(self) -> list[VideoSender]:
        config, camera = self._config, self._simulation.config.camera
        if not config.video:
            return []
        host, port = parsed_address(config.video, "mavlink.video")
        how = camera.height, camera.width, config.picture_rate, config.video_quality
        return [
            VideoSender(Stream((host, port + 2 * at), *how), at + 1)
            for at in range(self._simulation.count)
        ]

    def _vehicle(self, at: int, home: Any) -> Vehicle:  # noqa: ANN401  # three numbers
        config, camera = self._config, self._simulation.config.camera
        port = parsed_address(config.video, "mavlink.video")[1] + 2 * at if config.video else 0
        field = float(self._fields[at])
        lens = Lens(camera.width, camera.height, field, config.picture_rate, port)
        system = config.first_system + at
        return Vehicle(at, system, self._readings, self._sights, home, lens, self._gather)

    @property
    def encodes(self) -> bool:
        """Whether pictures wait to be encoded."""
        return any(sender.waits for sender in self._senders)

    def close(self) -> None:
        """End the threads of the video."""
        for sender in self._senders:
            sender.close()

    def take(self, messages: Iterable[Any]) -> None:
        """Give messages to those they are for, and send the answers.

        One that cannot be handled is a line in the log. A companion computer has the system id of
        its vehicle, so only what a vehicle's own component seems to have sent is an echo.
        """
        own = {sender for vehicle in self.vehicles for sender in vehicle.senders}
        for message in messages:
            sender = message.get_srcSystem(), message.get_srcComponent()
            if sender in own:  # an echo, or another vehicle of the same number
                continue
            with self._faults.guard(f"{message.get_type()} from {sender[0]}/{sender[1]}"):
                for vehicle in self.vehicles:
                    vehicle.take(message)
        self._flush()

    @property
    def waits(self) -> bool:
        """Whether a vehicle in offboard mode has got no set point since the last step."""
        return any(self._waiting())

    def _waiting(self) -> Iterator[Vehicle]:
        """Yield the vehicles in offboard mode that have got no set point since the last step."""
        for vehicle, before in zip(self.vehicles, self._set_points, strict=True):
            if vehicle.pilot.mode is Mode.OFFBOARD and vehicle.pilot.set_points == before:
                yield vehicle

    @property
    def offboard(self) -> bool:
        """Whether any vehicle is in offboard mode."""
        return any(vehicle.pilot.mode is Mode.OFFBOARD for vehicle in self.vehicles)

    def step(self, *, look: bool = True) -> None:
        """Fly for a period, and send what is due; pictures, too, if `look`."""
        for at, vehicle in enumerate(self.vehicles):
            self._set_points[at] = vehicle.pilot.set_points
            forward, left, up, turn = vehicle.command(self.now, self.period)
            self._commands[at] = forward, left, up / PHYSICS_RATE, turn
            self._angles[at] = vehicle.aim(self.period)
        self._zoom()
        simulation = self._simulation
        if simulation.steps_left < self._steps:
            self._begin_traffic_anew()
        simulation.command_gimbal(self._angles)
        simulation.advance(self._commands, self._steps)
        self._taken += 1
        self.now = self._taken * self._steps / PHYSICS_RATE
        self._readings.renew()
        self._tell_crashes()
        for vehicle in self.vehicles:
            vehicle.tell(self.now)
            self._flush()
        if look:
            self._look()

    def beat(self) -> None:
        """Send heartbeats while time stands still."""
        for vehicle in self.vehicles:
            vehicle.beat()
        self._flush()

    def hold(self, why: str) -> None:
        """Let those that wait for a set point hold."""
        for vehicle in list(self._waiting()):
            vehicle.pilot.hold(why)

    def _zoom(self) -> None:
        fields = np.array([vehicle.camera.field_of_view for vehicle in self.vehicles])
        if (fields != self._fields).any():
            self._fields = fields
            self._simulation.set_fields_of_view(fields)

    def _tell_crashes(self) -> None:
        """Report what flying vehicles touch, where contacts are computed."""
        if self._simulation.config.done.crash is Crash.ORIGINAL:
            return
        crashed = self._simulation.snapshot.episodes.crash
        for at in np.flatnonzero(crashed & ~self._crashed).tolist():
            if self.vehicles[at].pilot.landed is Landed.AIR:
                self.vehicles[at].pilot.said.append((2, "Crashed"))
        self._crashed = crashed.copy()

    def _begin_traffic_anew(self) -> None:
        """Begin the traffic anew; vehicles stay where they are, at rest."""
        _LOG.info("the traffic has reached its end, and begins anew")
        simulation, state = self._simulation, self._simulation.snapshot
        poses = np.column_stack([state.trackers.commanded_position, state.trackers.commanded_yaw])
        actors = state.targets.actor.tolist()
        simulation.rewind()
        simulation.reset()
        simulation.start_at(np.arange(simulation.count), poses, self._pitch)
        simulation.set_fields_of_view(self._fields)
        for tracker, actor in enumerate(actors):
            simulation.follow(tracker, actor)

    def _look(self) -> None:
        """Draw the pictures that are due, and let cameras see their targets in them."""
        for at, group in enumerate(self._groups):
            if self.now < self._picture_due[at]:
                continue
            later = self._picture_due[at] + 1.0 / self._config.picture_rate
            self._picture_due[at] = max(later, self.now)
            if self._senders:
                self._film(group)
            for vehicle in () if self._senders else group:
                if self.vehicles[vehicle].camera.tracks:
                    self.vehicles[vehicle].see(self._sights.seen(vehicle))

    def _film(self, group: list[int]) -> None:
        """Draw and send the pictures of some vehicles."""
        tracks = any(self.vehicles[vehicle].camera.tracks for vehicle in group)
        picture = (self._picture if tracks else self._plain).first(len(group))
        self._simulation.view.draw(np.array(group, np.int32), picture)
        assert picture.rgb is not None
        for at, vehicle in enumerate(group):
            self._senders[vehicle].send(picture.rgb[at], self.now)
            if tracks:
                self.vehicles[vehicle].see(seen_in(picture, at))

    def _gather(self, packet: bytes) -> None:
        if self._length + len(packet) > _DATAGRAM:
            self._flush()
        self._gathered.append(packet)
        self._length += len(packet)

    def _flush(self) -> None:
        if self._gathered:
            self._out(b"".join(self._gathered))
            self._gathered.clear()
            self._length = 0
