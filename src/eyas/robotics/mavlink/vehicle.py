"""One vehicle: its components, its pilot, and who of them a message is for."""

from collections.abc import Callable, Iterable
from typing import Any

from eyas.lanes import exact
from eyas.robotics.mavlink import autopilot, camera, gimbal
from eyas.robotics.mavlink.camera import Sighting, Sights
from eyas.robotics.mavlink.component import Component, Fields
from eyas.robotics.mavlink.frames import Vector
from eyas.robotics.mavlink.pilot import FlightMode, Parameters, Pilot
from eyas.robotics.mavlink.readings import Instant, VehicleReadings
from eyas.robotics.mavlink.telemetry import Telemetry

CUSTOM_MODE = 1  # `MAV_MODE_FLAG_CUSTOM_MODE_ENABLED`
_COMMANDS = ("COMMAND_LONG", "COMMAND_INT")


class Vehicle:
    """A tracker as a vehicle of MAVLink.

    Attributes:
        system: System id.
        senders: System and component id of each of its components.
        pilot: Who flies it.
        camera: Its camera.
    """

    def __init__(
        self,
        number: int,
        system: int,  # As above
        readings: VehicleReadings,  # What all vehicles know of themselves
        sights: Sights,  # What their cameras see
        home: Vector,  # Where it stands, world frame [m]
        lens: camera.Lens,  # Its camera's picture
        out: Callable[[bytes], None],  # Takes packets
    ) -> None:
        self._number, self.system, self._readings = number, system, readings
        self._sights, self._origin = sights, home
        self._instant = Instant(readings, number, home, 0.0)
        parts = {
            id_: Component(system, id_, out)
            for id_ in (autopilot.COMPONENT, camera.COMPONENT, gimbal.DEVICE)
        }
        first = parts[autopilot.COMPONENT]
        self._components = parts
        self.senders = [(system, id_) for id_ in parts]
        self.pilot = Pilot(home, Parameters())
        self._autopilot = autopilot.Autopilot(first, self.pilot, self._now)
        self._telemetry = Telemetry(first, self.pilot, self._now)
        self._gimbal = gimbal.Gimbal(first, parts[gimbal.DEVICE], self._now, 0.0)
        self.camera = camera.CameraComponent(
            parts[camera.COMPONENT], lens, self._now, self._choose, self._subject
        )
        for id_ in (camera.COMPONENT, gimbal.DEVICE):
            parts[id_].producers["heartbeat"] = self._following(parts[id_].producers["heartbeat"])

    def _following(self, told: Callable[[], Iterable[Fields]]) -> Callable[[], Iterable[Fields]]:
        """Return what tells heartbeats that have the mode while the vehicle follows.

        MAVSDK's FollowMe takes the mode from the heartbeats of all components, and sends nothing
        after one that has another (follow_me_impl.cpp, `process_heartbeat`).
        """

        def beats() -> Iterable[Fields]:
            for fields in told():
                mode = self.pilot.mode
                if mode is FlightMode.FOLLOW:
                    yield {**fields, "base_mode": CUSTOM_MODE, "custom_mode": mode.custom}
                else:
                    yield fields

        return beats

    def _now(self) -> Instant:
        return self._instant

    def take(self, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        """Take a message, if it is for this vehicle."""
        if getattr(message, "target_system", 0) not in (0, self.system):
            return
        component = self._addressed(message)
        if component is not None:
            component.take(message)

    def _addressed(self, message: Any) -> Component | None:  # noqa: ANN401
        """Return the component a message is for; None if there is none of that id.

        A command to all is for who knows it, else for the autopilot.
        """
        wanted = getattr(message, "target_component", 0)
        if wanted:
            return self._components.get(wanted)
        if message.get_type() in _COMMANDS:
            for component in self._components.values():
                if component.knows(message.command):
                    return component
        return self._components[autopilot.COMPONENT]

    def command(self, now: float, dt: float) -> tuple[float, float, float, float]:
        """Return forward, left, up [m/s], turn to the left [rad/s] for the next time `dt` [s]."""
        body = self._instant.body
        east, north, up, turn = self.pilot.fly(body, now, dt)
        cosine, sine = float(exact.cos(body.yaw)), float(exact.sin(body.yaw))
        return cosine * east + sine * north, cosine * north - sine * east, up, turn

    def aim(self, dt: float) -> tuple[float, float]:
        """Return pitch, positive down, and yaw to the left to command to the camera [rad]."""
        return self._gimbal.aim(dt)

    def tell(self, now: float) -> None:
        """Send what is due at a time [s], after a step."""
        self._instant = Instant(self._readings, self._number, self._origin, now)
        for component in self._components.values():
            component.tick(now)
        self._autopilot.report()

    def beat(self) -> None:
        """Send all heartbeats while time stands still."""
        for component in self._components.values():
            component.tell("heartbeat")

    def see(self, seen: Sighting | None) -> None:
        """Take where the target is in the newest picture."""
        self.camera.see(seen)

    def _choose(self, box: tuple[float, float, float, float]) -> str:
        actor = self._sights.chosen(self._number, box)
        if isinstance(actor, str):
            return actor
        self._readings.simulation.follow(self._number, actor)
        self.camera.see(self._sights.seen(self._number))
        return ""

    def _subject(self) -> camera.LockedSubject:
        targets, at = self._readings.simulation.snapshot.targets, self._number
        place, velocity = targets.centre[at].tolist(), targets.velocity[at].tolist()
        return camera.LockedSubject(tuple(place), tuple(velocity))
