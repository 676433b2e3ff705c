"""All vehicles in one world: their places, steps, packets and pictures."""

import logging
import math
import select
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.addresses import parsed_address
from eyas.engine.core.clock import PHYSICS_RATE, physics_steps
from eyas.engine.core.errors import SpawnError
from eyas.engine.sim.serving import Face, Orders
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import Picture
from eyas.engine.state.terrain import reliefs
from eyas.engine.task.clearance import Margin
from eyas.engine.task.config import Crash
from eyas.lanes import exact
from eyas.robotics.mavlink.camera import Lens, Sights, seen_in
from eyas.robotics.mavlink.config import MavlinkConfig
from eyas.robotics.mavlink.endpoint import Endpoint
from eyas.robotics.mavlink.frames import Geodesy
from eyas.robotics.mavlink.pilot import FEET, FlightMode, Landed
from eyas.robotics.mavlink.readings import VehicleReadings
from eyas.robotics.mavlink.vehicle import Vehicle
from eyas.robotics.mavlink.video import VideoSender, VideoStream

_LOG = logging.getLogger("eyas")

_DATAGRAM = 1200  # Packets are gathered up to this size [bytes]
_TOGETHER = 4
"""Most pictures that are drawn at once: of 20 vehicles, 320x240 pixels, one takes 6.4 ms so, 9.0 ms
alone."""
_PATIENCE = 10.0  # Longest time that stands still for a vehicle without a set point [s]


class Fleet(Face):
    """Vehicles that fly by the clock; or in lock-step, where time stands still while a vehicle in
    offboard mode waits for a set point.

    Attributes:
        period: Length of a step: that of a command [s].
        vehicles: By number.
        now: Time since the start [s].

    Raises:
        EyasError: Something of the settings is not possible.
    """

    relief = "smaller or fewer pictures help (camera.width, camera.height, mavlink.picture_rate)"

    def __init__(
        self,
        simulation: Simulation,  # Trackers in one world, not yet reset
        config: MavlinkConfig,
        endpoints: Sequence[Endpoint],  # Where messages go and come from
    ) -> None:
        self.simulation, self._config, self._endpoints = simulation, config, endpoints
        self._steps = physics_steps(simulation.config.control.frequency)
        self.period = self._steps / PHYSICS_RATE
        self.now, self._taken = 0.0, 0
        self._gathered: list[bytes] = []
        self._length = 0
        geodesy = Geodesy(config.latitude, config.longitude, config.altitude)
        self._readings, self._sights = VehicleReadings(simulation, geodesy), Sights(simulation)
        count = simulation.count
        self._commands, self._angles = np.zeros((count, 4)), np.zeros((count, 2))
        self._senders = self._video()
        simulation.view.pictures.prepare()  # not in flight, where time goes on
        self._pitch = np.full(count, 0.5)
        simulation.reset()
        self._fields = simulation.snapshot.cameras.field_of_view.copy()
        places = standing_places(simulation)
        simulation.start_at(np.arange(count), places, self._pitch)
        self.vehicles = [self._vehicle(at, tuple(places[at, :3])) for at in range(count)]
        # What they seem to have sent is an echo, or comes from another vehicle of the same number;
        # a companion computer has the system id of its vehicle.
        self._own = {sender for vehicle in self.vehicles for sender in vehicle.senders}
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
        config, camera = self._config, self.simulation.config.camera
        if not config.video:
            return []
        host, port = parsed_address(config.video, "mavlink.video")
        how = camera.height, camera.width, config.picture_rate, config.video_quality
        return [
            VideoSender(VideoStream((host, port + 2 * at), *how), at + 1)
            for at in range(self.simulation.count)
        ]

    def _vehicle(self, at: int, home: Any) -> Vehicle:  # noqa: ANN401  # three numbers
        config, camera = self._config, self.simulation.config.camera
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

    @property
    def speed(self) -> float:
        """Factor on the clock's speed; 0: lock-step, as fast as set points come."""
        return 0.0 if self._config.lockstep and self._offboard else 1.0

    def receive(self, wait: float) -> Iterable[tuple[str, Any]]:
        """Yield what comes within a time [s], and send the answers."""
        ready, _, _ = select.select([end.socket for end in self._endpoints], [], [], wait)
        for message in [m for end in self._endpoints if ready for m in end.received()]:
            sender = f"{message.get_srcSystem()}/{message.get_srcComponent()}"
            yield f"{message.get_type()} from {sender}", message
        self.flush()

    def take(self, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        """Give a message to those it is for."""
        if (message.get_srcSystem(), message.get_srcComponent()) not in self._own:
            for vehicle in self.vehicles:
                vehicle.take(message)

    def _waiting(self) -> Iterator[Vehicle]:
        """Yield the vehicles in offboard mode that have got no set point since the last step."""
        for vehicle, before in zip(self.vehicles, self._set_points, strict=True):
            if vehicle.pilot.mode is FlightMode.OFFBOARD and vehicle.pilot.set_points == before:
                yield vehicle

    @property
    def _offboard(self) -> bool:
        """Whether any vehicle is in offboard mode."""
        return any(vehicle.pilot.mode is FlightMode.OFFBOARD for vehicle in self.vehicles)

    def orders(self) -> Orders | None:
        """Return what the pilots want; None in lock-step while one waits for a set point."""
        if self._config.lockstep and any(self._waiting()):
            return None
        for at, vehicle in enumerate(self.vehicles):
            self._set_points[at] = vehicle.pilot.set_points
            forward, left, up, turn = vehicle.command(self.now, self.period)
            self._commands[at] = forward, left, up / PHYSICS_RATE, turn
            self._angles[at] = vehicle.aim(self.period)
        self._zoom()
        self.simulation.command_gimbal(self._angles)
        return Orders(self._commands, self._steps)

    def answer(self, *, late: bool) -> None:
        """Send what is due; pictures only if there is time."""
        self._taken += 1
        self.now = self._taken * self._steps / PHYSICS_RATE
        self._readings.renew()
        self._tell_crashes()
        for vehicle in self.vehicles:
            vehicle.tell(self.now)
            self.flush()
        if not late:
            self._look()

    def idle(self, stood: float) -> None:
        """Send heartbeats; and give up who sends no set point for long, whatever else comes: the
        heartbeats of a ground station go on when the program has died.
        """
        for vehicle in self.vehicles:
            vehicle.beat()
        self.flush()
        for vehicle in list(self._waiting()) if stood > _PATIENCE else ():
            vehicle.pilot.hold("No set points")

    def _zoom(self) -> None:
        fields = np.array([vehicle.camera.field_of_view for vehicle in self.vehicles])
        if (fields != self._fields).any():
            self._fields = fields
            self.simulation.set_fields_of_view(fields)

    def _tell_crashes(self) -> None:
        """Report what flying vehicles touch, where contacts are computed."""
        if self.simulation.config.done.crash is Crash.ORIGINAL:
            return
        crashed = self.simulation.snapshot.episodes.crash
        for at in np.flatnonzero(crashed & ~self._crashed).tolist():
            if self.vehicles[at].pilot.landed is Landed.AIR:
                self.vehicles[at].pilot.notices.append((2, "Crashed"))
        self._crashed = crashed.copy()

    def rewind(self) -> None:
        """Begin the traffic anew; vehicles stay where they are, at rest."""
        _LOG.info("the traffic has reached its end, and begins anew")
        simulation, state = self.simulation, self.simulation.snapshot
        poses = np.column_stack([state.trackers.commanded_position, state.trackers.commanded_yaw])
        actors = state.targets.actor.tolist()
        simulation.rewind()
        simulation.reset()
        simulation.start_at(np.arange(simulation.count), poses, self._pitch)
        simulation.set_fields_of_view(self._fields)
        for tracker, actor in enumerate(actors):
            simulation.follow(tracker, actor)
        simulation.command_gimbal(self._angles)

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
        self.simulation.view.draw(np.array(group, np.int32), picture)
        assert picture.rgb is not None
        for at, vehicle in enumerate(group):
            self._senders[vehicle].send(picture.rgb[at], self.now)
            if tracks:
                self.vehicles[vehicle].see(seen_in(picture, at))

    def _gather(self, packet: bytes) -> None:
        if self._length + len(packet) > _DATAGRAM:
            self.flush()
        self._gathered.append(packet)
        self._length += len(packet)

    def flush(self) -> None:
        """Send the packets that have been gathered."""
        if self._gathered:
            datagram = b"".join(self._gathered)
            for endpoint in self._endpoints:
                endpoint.send(datagram)
            self._gathered.clear()
            self._length = 0


_FREE = 2.0  # Radius without things [m]
_ROAD = 5.0  # Distance from the middle of the nearest lane [m]
_APART = 4.0  # Least distance between two vehicles [m]
_REACH = 120.0  # Largest distance of a place from the first target [m]
_RING = 4.0  # Between rings of places, and between the places of one [m]


def standing_places(simulation: Simulation) -> NDArray[np.float64]:
    """Return a place for each tracker: east, north, up [m], heading [rad], shape (N, 4).

    They are those nearest to the first tracker's target that are free, and away from all lanes.

    Raises:
        SpawnError: There are too few.
    """
    near = simulation.snapshot.targets.position[0, :2]
    places = _candidates(near)
    places = places[_far_from_lanes(simulation, places)]
    ground = simulation.scene.terrain.floor + reliefs(simulation.scene.terrain, places)
    free = simulation.clearance.lifted(np.column_stack([places, ground]), Margin(_FREE, 3.0, 0.0))
    good = np.flatnonzero(free < ground + 0.3)  # the ground itself may slope
    chosen: list[int] = []
    for at in good.tolist():
        away = places[chosen] - places[at]
        if (away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1] >= _APART * _APART).all():
            chosen.append(at)
        if len(chosen) == simulation.count:
            break
    if len(chosen) < simulation.count:
        raise SpawnError(
            f"mavlink.vehicles: only {len(chosen)} of {simulation.count} find free ground within "
            f"{_REACH:g} m; allowed there: up to {len(chosen)}"
        )
    height = ground[chosen] + FEET
    return np.column_stack([places[chosen], height, np.zeros(len(chosen))])


def _candidates(middle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return places around one, the nearest first [m], shape (K, 2)."""
    found = []
    for ring in range(1, int(_REACH / _RING) + 1):
        radius = ring * _RING
        turns = np.linspace(0.0, 2.0 * math.pi, 6 * ring, endpoint=False)
        circle = np.stack([exact.cos(turns), exact.sin(turns)], axis=1)
        found.append(middle + radius * circle)
    return np.concatenate(found)


def _far_from_lanes(simulation: Simulation, places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which places are far enough from all lanes, shape (K,)."""
    network = simulation.scene.network
    points, first = network.lane_points, network.lane_first
    begin, way = points[:-1], np.diff(points, axis=0)
    way[first[1:-1] - 1] = 0.0  # from one lane to the next there is no road
    square = np.maximum((way * way).sum(axis=1), 1e-12)
    far = np.ones(len(places), np.bool_)
    for at, place in enumerate(places):
        off = place - begin
        share = np.clip((off * way).sum(axis=1) / square, 0.0, 1.0)
        off = off - share[:, None] * way
        far[at] = (off * off).sum(axis=1).min() > _ROAD * _ROAD
    return far
