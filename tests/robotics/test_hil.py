"""PX4's and ArduPilot's contracts: an autopilot in a process of its own flies by them."""

import json
import math
import re
import socket
import struct
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from threading import Thread

import numpy as np
import pytest

common = pytest.importorskip("pymavlink.dialects.v20.common", reason="needs pymavlink")

from eyas.engine.core.config import updated
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.serving import Loop, serve
from eyas.engine.sim.worlds import together
from eyas.engine.trackers.driven import driven_drone
from eyas.robotics.mavlink.endpoint import StreamParser
from eyas.robotics.mavlink.hil.ardupilot import ArduPilot, servos_of
from eyas.robotics.mavlink.hil.drone import DrivenDrone
from eyas.robotics.mavlink.hil.px4 import Px4
from eyas.robotics.mavlink.readings import equipped
from eyas.robotics.serving.hil import bound, listening
from eyas.robotics.serving.mavlink import AS_FLOWN

pytestmark = pytest.mark.slow  # what its tests share takes long to make

AUTOPILOT = Path(__file__).with_name("small_autopilot.py")
HOVER = math.sqrt(0.5)


@pytest.fixture(scope="module")
def drone():
    small = {"camera": {"width": 96, "height": 54}, "start": {"velocity": "rest"}}
    config = equipped(updated(AS_FLOWN, small), AS_FLOWN.mavlink, noisy=True)
    tracker = driven_drone(config.tracker)
    return DrivenDrone(build_simulation(config, together(1), tracker=tracker), config.mavlink)


def step(drone, outputs, steps):
    """Turn the rotors for some physics steps."""
    drone.simulation.advance(*drone.orders(outputs, steps))
    drone.sense(steps)


def flown_by_small_autopilot(kind, face, server):
    """Return what the autopilot has seen: at its goals, and at the end."""

    def work():
        with suppress(OSError):  # when the socket is closed
            serve(face)

    thread = Thread(target=work, daemon=True)
    thread.start()
    words = [sys.executable, str(AUTOPILOT), kind, str(server.getsockname()[1])]
    said = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    server.close()
    thread.join(5.0)
    assert not thread.is_alive()
    assert said.returncode == 0, said.stderr
    *goals, end = [json.loads(line) for line in said.stdout.splitlines()]
    assert len(goals) == 3
    for each in goals:
        assert each["place"] == pytest.approx(each["goal"], abs=0.03)
        assert each["heading"][1] == pytest.approx(each["heading"][0], abs=0.01)
    return end


def test_an_autopilot_flies_by_px4s_contract(drone):
    server = listening(f"127.0.0.1:{free()}")
    end = flown_by_small_autopilot("px4", Px4(drone, 0.0, server), server)
    kinds = end["kinds"]
    assert kinds["107"] == kinds["115"] == 25 * (kinds["113"] - 1) + (kinds["107"] - 1) % 25 + 1
    assert end["unasked"] == 0
    felt, turn, field = end["rest"]
    assert felt == pytest.approx([0.0, 0.0, -9.81], abs=0.05)
    assert turn == pytest.approx([0.0, 0.0, 0.0], abs=0.002)
    assert field == pytest.approx([0.0106, -0.2145, 0.4297], abs=0.003)  # it looks east
    inertial, slow = 0b111111, 0b1101000000000 | 0b111000000
    assert end["flags"] == [inertial | slow, *[inertial] * 4, inertial | slow]
    assert end["down"] == pytest.approx(-4.0, abs=0.02)
    assert end["hectopascals"] == pytest.approx(-4.0 * 0.113, abs=0.05)
    assert not end["same"]


def free():
    with socket.socket() as some:
        some.bind(("127.0.0.1", 0))
        return some.getsockname()[1]


@pytest.mark.thorough
def test_an_autopilot_flies_by_ardupilots_contract(drone):
    heard = bound(f"127.0.0.1:{free()}")
    end = flown_by_small_autopilot("ardupilot", ArduPilot(drone, 0.0, heard), heard)
    assert end["again"][0] == end["again"][1] > 1.0
    assert end["range"] == pytest.approx(4.0 + 0.18, abs=0.05)
    assert end["anew"]["timestamp"] == pytest.approx(0.002)
    assert end["anew"]["position"] == pytest.approx([0.0, 0.0, 0.0], abs=0.01)


def as_ardupilot_reads(line):
    """Return a line's fields as SIM_JSON.cpp finds them: behind the name, a quote and a colon."""
    numbers = r"\[([-+.e\d]+), ?([-+.e\d]+), ?([-+.e\d]+)(?:, ?([-+.e\d]+))?\]"
    found = {}
    for name in ("gyro", "accel_body", "position", "attitude", "quaternion", "velocity"):
        at = line.index(name) + len(name) + 2
        found[name] = [float(part) for part in re.match(numbers, line[at:]).groups() if part]
    at = line.index("timestamp") + len("timestamp") + 2
    return found | {"timestamp": float(re.match(r"[-+.e\d]+", line[at:])[0])}


@pytest.fixture
def ask(drone):
    """Return the line that answers a packet of ArduPilot."""
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out,
        bound(f"127.0.0.1:{free()}") as heard,
    ):
        out.connect(heard.getsockname())
        out.settimeout(60.0)
        loop = Loop(ArduPilot(drone, 0.0, heard))

        def answer(frame, width=1000):
            out.send(struct.pack("<HHI16H", 18_458, 400, frame, *[width] * 16))
            loop.turn()
            return out.recv(65_535)

        yield answer


def test_its_lines_are_read_as_ardupilot_reads_them(ask):
    ask(0)
    line = ask(1).decode()
    assert line[0] == line[-1] == "\n"
    seen = as_ardupilot_reads(line.strip())
    assert seen["timestamp"] == pytest.approx(0.004)
    assert seen["accel_body"] == pytest.approx([0.0, 0.0, -9.81], abs=0.05)
    assert seen["attitude"] == pytest.approx([0.0, 0.0, math.pi / 2], abs=1e-3)
    assert seen["quaternion"] == pytest.approx([HOVER, 0.0, 0.0, HOVER], abs=1e-3)
    again = ask(1, width=2000)
    assert as_ardupilot_reads(again.decode())["timestamp"] == seen["timestamp"]


def test_packets_of_ardupilot_are_read():
    widths = [1000, 1500, 2000, 0, 900, 2200, *[1000] * 10]
    packet = bytes.fromhex("1a48 9001 07000000") + struct.pack("<16H", *widths)
    assert servos_of(packet) == (400, 7, (0.0, 0.5, 1.0, 0.0, 0.0, 1.0, *[0.0] * 10))
    long = struct.pack("<HHI32H", 29_569, 1200, 2**32 - 1, *[1250] * 32)
    assert servos_of(long) == (1200, 2**32 - 1, (0.25,) * 32)
    for wrong in (b"", b"\x1a", packet[:-1], packet + b"\0", b"\0\0" + packet[2:], long[:40]):
        assert servos_of(wrong) is None


@pytest.mark.parametrize(
    ("motor", "roll", "pitch", "yaw"),
    [(0, -1, 1, 1), (1, 1, -1, 1), (2, 1, 1, -1), (3, -1, -1, -1)],
    ids=["1 front right", "2 rear left", "3 front left", "4 rear right"],
)
def test_each_motor_turns_the_drone_as_in_px4_and_ardupilot(drone, motor, roll, pitch, yaw):
    drone.begin()
    step(drone, [0.9] * 16, 50)  # off the ground
    before = drone.instant.rates
    outputs = [0.8] * 4
    outputs[motor] = 0.9
    step(drone, outputs, 5)
    change = np.sign(np.subtract(drone.instant.rates, before))
    assert change.tolist() == [roll, pitch, yaw]


def test_outputs_are_found_in_a_stream_that_ends_anywhere(drone):
    maker = common.MAVLink(None, 1, 1)
    controls = common.MAVLink_hil_actuator_controls_message(9, [0.25] * 16, 129, 1).pack(maker)
    beat = common.MAVLink_heartbeat_message(2, 12, 0, 0, 0, 3).pack(maker)
    damaged = controls[:20] + bytes([controls[20] ^ 1]) + controls[21:]
    parser, found = StreamParser(), []
    for byte in b"noise" + beat + damaged + controls:
        found += parser.messages(bytes([byte]))
    assert [message.get_type() for message in found] == ["HEARTBEAT", "HIL_ACTUATOR_CONTROLS"]
    assert found[1].controls == [0.25] * 16


def test_the_same_outputs_give_the_same_flight(drone):
    flights = []
    for _ in range(2):
        drone.begin()
        for outputs in ([0.8] * 16, [0.7, 0.72, 0.71, math.nan], [9.0, -1.0, 0.5, 0.5]):
            step(drone, outputs, 20)
        at = drone.instant
        sensed = at.imu(), at.magnetic(), at.pressure()
        flights.append((at.local, at.attitude, sensed))
    assert flights[0] == flights[1]
