"""A fleet without a network, and who sends it packets and reads its own: pymavlink."""

import math
import socket

import numpy as np
import pytest

from ..kit.frames import episode, frame, run

common = pytest.importorskip("pymavlink.dialects.v20.common", reason="needs pymavlink")

from eyas.engine.core.config import updated
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.serving import Loop
from eyas.engine.sim.worlds import together
from eyas.robotics.mavlink.fleet import Fleet
from eyas.robotics.mavlink.readings import equipped
from eyas.robotics.serving.mavlink import AS_FLOWN

SMALL = {"camera": {"width": 96, "height": 54}, "start": {"velocity": "rest"}}
GCS, OTHER = (255, 190), (254, 190)

__all__ = ["episode", "frame", "run"]


BUILT = {}


def simulation_of(config, vehicles):
    """Return a simulation as new; those of other tests are used again, since building is slow."""
    key = config.model_dump_json(exclude={"mavlink"}), vehicles
    if key not in BUILT:
        BUILT[key] = build_simulation(config, together(vehicles))
    BUILT[key].reseed(config.seed)
    BUILT[key].rewind()
    return BUILT[key]


class Line:
    """An endpoint without a network: what is put into `coming` comes, `sent` has been sent."""

    def __init__(self):
        self.coming, self.sent = [], []
        self.socket, self._other = socket.socketpair()
        self._other.send(b"x")  # so that it can always be read

    def send(self, datagram):
        self.sent.append(datagram)

    def received(self):
        found, self.coming = self.coming, []
        return found

    def close(self):
        self.socket.close()
        self._other.close()


class Bench:
    """Flies a fleet; `sent` holds what it has sent since someone looked."""

    def __init__(self, vehicles=1, **settings):
        config = updated(AS_FLOWN, SMALL | settings)
        self.simulation = simulation_of(equipped(config, config.mavlink), vehicles)
        endpoints = []
        self.fleet = Fleet(self.simulation, config.mavlink, endpoints)
        self.line = Line()  # when nothing can be refused any more
        endpoints.append(self.line)
        self.loop = Loop(self.fleet)
        self.fly(0.1)

    def close(self):
        self.fleet.close()
        self.line.close()

    @property
    def pilot(self):
        return self.fleet.vehicles[0].pilot

    def fly(self, seconds, beat=GCS):
        for at in range(round(seconds / self.fleet.period)):
            if beat and at % 50 == 0:
                self.beat(beat)
            self.loop.step()

    def beat(self, sender=GCS):
        self.send("heartbeat", sender, type=6, autopilot=8, base_mode=0, custom_mode=0,
                  system_status=4, mavlink_version=3)  # fmt: skip

    def taken(self):
        """Return all messages since the last look."""
        reader = common.MAVLink(None)
        found = [m for part in self.line.sent for m in reader.parse_buffer(part) or []]
        self.line.sent.clear()
        return found

    def last(self, kind):
        found = [message for message in self.taken() if message.get_type() == kind]
        return found[-1] if found else None

    def send(self, kind, sender=GCS, **fields):
        message = getattr(common, f"MAVLink_{kind}_message")(**fields)
        packet = message.pack(common.MAVLink(None, *sender))
        self.hear(common.MAVLink(None).parse_buffer(packet))

    def hear(self, messages):
        self.line.coming += messages
        self.loop.hear(0.0)

    def command(self, name, *params, sender=GCS, system=1, component=1):
        """Send a command; return the result of the answer, None without one."""
        self.taken()
        number = getattr(common, f"MAV_CMD_{name}")
        filled = [*params, *[math.nan] * (7 - len(params))]
        words = {f"param{k + 1}": value for k, value in enumerate(filled)}
        self.send("command_long", sender, target_system=system, target_component=component,
                  command=number, confirmation=0, **words)  # fmt: skip
        self.answers = self.taken()
        acks = [m for m in self.answers if m.get_type() == "COMMAND_ACK"]
        assert all(ack.command == number for ack in acks)
        return acks[-1].result if acks else None

    def velocity(self, x, y, z, rate=0.0, frame=1, mask=0b0101_1100_0111, system=1):
        self.send("set_position_target_local_ned", time_boot_ms=0, target_system=system,
                  target_component=1, coordinate_frame=frame, type_mask=mask, x=0, y=0, z=0,
                  vx=x, vy=y, vz=z, afx=0, afy=0, afz=0, yaw=0, yaw_rate=rate)  # fmt: skip

    def fly_up(self, height=5.0):
        """Arm, take off, and hold."""
        self.pilot.parameters.values |= {"MIS_TAKEOFF_ALT": height, "MPC_TKO_SPEED": 4.0}
        assert self.command("COMPONENT_ARM_DISARM", 1) == 0
        assert self.command("NAV_TAKEOFF") == 0
        self.fly(height / 4.0 + 4.0)

    def stay_over_target(self, height=25.0):
        """Put the vehicle over its target, whose camera looks down."""
        self.command("DO_GIMBAL_MANAGER_PITCHYAW", -85, 0, math.nan, math.nan, 0, 0, 0)
        x, y, z = self.simulation.snapshot.targets.position[0]
        pose = np.array([[x, y, z + height, 0.0]])
        self.simulation.start_at(np.arange(1), pose, np.full(1, math.radians(85.0)))
        self.fly(0.02)


@pytest.fixture
def make_bench():
    made = []

    def make(*arguments, **settings):
        made.append(Bench(*arguments, **settings))
        return made[-1]

    yield make
    for bench in made:
        bench.close()


@pytest.fixture
def bench(make_bench):
    return make_bench()
