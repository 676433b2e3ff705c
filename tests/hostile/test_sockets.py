"""Every place that receives from outside, fed with what no ordinary program sends.

The list of places is made from the code: one without a row in `FEEDERS` fails the first test.
"""

import ast
import asyncio
import io
import itertools
import json
import math
import random
import re
import socket
import struct
import threading
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import eyas
from eyas.engine.core.bounds import FARTHEST
from eyas.engine.core.config import updated
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.serving import Loop, serve
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.robotics.mavlink.readings import equipped
from eyas.robotics.serving.mavlink import AS_FLOWN

from .values import ABSURD, HUGE_WHOLE, NOT_FINITE, json_contents, mutated

pytestmark = pytest.mark.slow  # simulations are built for it

RECEIVE = {"recv", "recvfrom", "recv_into", "recvfrom_into", "recvmsg", "accept", "urlopen"}
STREAMS = {("os", "read"), ("stream", "read"), ("reader", "take"), ("sys", "stdin")}
WORDS = re.compile("|".join([*RECEIVE, *map(".".join, STREAMS), "process_request", "async for"]))
NOT_OURS = "dat/webots/controllers"  # copied out, and run by Webots

NUMBERS = (*ABSURD, *NOT_FINITE, 3.4e38, -1e5, 0.0, -0.0, 1.0)
SMALL = {
    "world": {"map": "desert-bare"},
    "camera": {"width": 64, "height": 48},
    "start": {"velocity": "rest"},
}


def places():
    """Return file and word of each place in the code that receives from outside."""
    root = Path(eyas.__file__).parent
    for file in sorted(root.rglob("*.py")):
        name, text = file.relative_to(root).as_posix(), file.read_text(encoding="utf-8")
        if not WORDS.search(text):  # parsing all would take seconds
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Attribute):
                whose = node.value.id if isinstance(node.value, ast.Name) else ""
                if node.attr in RECEIVE or (whose, node.attr) in STREAMS:
                    yield name, node.attr
            elif isinstance(node, ast.AsyncFor):
                yield name, "async for"
            elif isinstance(node, ast.keyword) and node.arg == "process_request":
                yield name, node.arg


@pytest.fixture(scope="module")
def simulation():
    return build_simulation(equipped(updated(AS_FLOWN, SMALL), AS_FLOWN.mavlink), together(1))


def is_sound(simulation):
    """Return whether all is finite and in the box, and a picture is drawn."""
    picture = Picture.create(1, 48, 64)
    simulation.view.draw(np.zeros(1, np.int32), picture)
    arrays = [array for record in simulation.snapshot[:3] for array in record]
    near = np.abs(simulation.snapshot.trackers.position).max() <= 1.1 * FARTHEST
    return near and picture.rgb.any() and all(np.isfinite(array).all() for array in arrays)


def messages_of_mavlink(common, vehicle):
    """Yield a message for each value of each field of each message, and of each parameter of each
    command, that a vehicle handles.
    """
    kinds = {f"MAV_CMD_{name}" for part in vehicle._components.values() for name in part.answers}
    numbers = [at for at, entry in common.enums["MAV_CMD"].items() if entry.name in kinds]
    heard = {kind for part in vehicle._components.values() for kind in part.handlers}
    wholes = (0, 1, -1, 255, 65535, 2**31 - 1, -(2**31), 900_000_000, 2**64 - 1)
    for name in sorted(heard | {"COMMAND_LONG", "COMMAND_INT"}):
        make = getattr(common, f"MAVLink_{name.lower()}_message")
        fields = dict(zip(make.fieldnames, make.fieldtypes, strict=True))
        sizes = dict(zip(make.ordered_fieldnames, make.array_lengths, strict=True))
        usual = {
            field: b"" if kind == "char" else [0] * sizes[field] if sizes[field] else 0
            for field, kind in fields.items()
        }
        usual |= {"target_system": 1} if "target_system" in fields else {}
        for field in fields:
            values = NUMBERS if fields[field] == "float" else wholes
            values = (b"MPC_XY_CRUISE", b"\xff" * 16) if fields[field] == "char" else values
            commands = numbers if name.startswith("COMMAND") and field.startswith("p") else [400]
            for value, command in itertools.product(values, commands):
                several = sizes[field] and fields[field] != "char"
                changed = {field: [value] * sizes[field] if several else value}
                given = {"command": command} if "command" in fields else {}
                yield make(**{**usual, **given, **changed})


def feed_mavlink(simulation, tmp_path, caplog):
    common = pytest.importorskip("pymavlink.dialects.v20.common")
    from eyas.robotics.mavlink.endpoint import Parser, _nearest
    from eyas.robotics.mavlink.fleet import Fleet

    sent, chance, parser = [], random.Random(1), Parser()
    line = SimpleNamespace(send=sent.append)
    fleet = Fleet(simulation, updated(AS_FLOWN, SMALL).mavlink, [line])
    loop = Loop(fleet)
    packer = common.MAVLink(None, 1, 191)

    def send(message):
        for field, kind in zip(message.fieldnames, message.fieldtypes, strict=True):
            setattr(message, field, _nearest(getattr(message, field), kind))
        packet = message.pack(packer)
        for heard in parser.messages(packet):
            fleet.take(heard)
        fleet.flush()
        return packet

    def fly(seconds):
        for _ in range(round(seconds / fleet.period)):
            loop.step()

    def command(number, *params):
        send(
            common.MAVLink_command_long_message(1, 1, number, 0, *params, *[0] * (7 - len(params)))
        )

    command(400, 1)
    command(22)
    fly(3.0)
    hostile = list(messages_of_mavlink(common, fleet.vehicles[0]))
    assert len(hostile) > 1000
    chance.shuffle(hostile)
    for at, message in enumerate(hostile):
        packet = send(message)
        if at % 20 == 0:
            command(176, 1, 6)  # offboard, as far as set points are there
            loop.step()
            for damaged in mutated(packet, chance, 6):
                for heard in parser.messages(damaged):
                    fleet.take(heard)
    assert not [line for line in caplog.messages if "ignored" in line]
    fly(0.5)
    assert is_sound(simulation)
    sent.clear()
    command(400, 1)
    answers = [message for datagram in sent for message in parser.messages(datagram)]
    assert answers[-1].get_type() == "COMMAND_ACK"


def driven():
    from eyas.engine.trackers.driven import driven_drone
    from eyas.robotics.mavlink.hil.drone import DrivenDrone

    config = updated(AS_FLOWN, SMALL | {"tracker": {"supervised": False, "ground_contact": True}})
    config, tracker = equipped(config, config.mavlink), driven_drone(config.tracker)
    return DrivenDrone(build_simulation(config, together(1), tracker=tracker), config.mavlink)


def begin(face):
    """Serve in a thread, until the socket of the face is closed."""

    def work():
        with suppress(OSError):
            serve(face)

    threading.Thread(target=work, daemon=True).start()


def feed_ardupilot(simulation, tmp_path, caplog):
    from eyas.robotics.mavlink.hil.ardupilot import ArduPilot

    drone, chance = driven(), random.Random(2)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as heard, heard.dup() as server:
        heard.bind(("127.0.0.1", 0))
        begin(ArduPilot(drone, 0.0, server))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            out.connect(heard.getsockname())
            out.settimeout(60.0)

            def answer(frame, rate=400, width=1500):
                out.send(struct.pack("<HHI16H", 18458, rate, frame, *[width] * 16))
                return json.loads(out.recv(65535))

            whole = struct.pack("<HHI16H", 18458, 400, 7, *[65535] * 16)
            for packet in mutated(whole, chance, 200):
                if packet[:2] != whole[:2] or len(packet) != len(whole):  # others are answered
                    out.send(packet)
            for frame, rate, width in itertools.product((1, 2**32 - 1, 0), (0, 65535), (0, 65535)):
                answer(frame, rate, width)
            told = answer(5)
    assert all(map(math.isfinite, told["position"] + told["velocity"]))
    assert is_sound(drone.simulation)


def feed_px4(simulation, tmp_path, caplog):
    common = pytest.importorskip("pymavlink.dialects.v20.common")
    from eyas.robotics.mavlink.hil.px4 import Px4

    drone, chance, packer = driven(), random.Random(3), common.MAVLink(None, 1, 1)
    server = socket.create_server(("127.0.0.1", 0))
    begin(Px4(drone, 0.0, server))
    control = common.MAVLink_hil_actuator_controls_message
    numbers = [number for number in NUMBERS if not abs(number) > 3.4e38 or math.isinf(number)]
    packets = [control(0, [number] * 16, 255, 2**64 - 1).pack(packer) for number in numbers]
    for contents in ([b"\xfd" * 5000, *mutated(packets[0], chance, 50)], packets, packets[-1:]):
        with socket.create_connection(server.getsockname(), 60.0) as out:
            assert out.recv(1)  # each is served
            for content in contents:
                out.sendall(content)
            assert out.recv(65535)
    with suppress(OSError):
        server.shutdown(socket.SHUT_RDWR)
    server.close()
    assert is_sound(drone.simulation)


def feed_announcements(simulation, tmp_path, caplog):
    from eyas.dat.wire.announcements import Announcements

    announcements, chance = Announcements("127.0.0.1", 0), random.Random(4)
    texts = [str(number).encode() for number in (*NUMBERS, *HUGE_WHOLE, -1, 0, 1025)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.connect(announcements._socket.getsockname())
        for content in (*texts, "\u0663\u00b2".encode(), *mutated(b"x12y", chance, 50)):
            out.send(content[:60_000])
            assert announcements.poll() in (None, 1, 2, 12)
        out.send(b"3")
        assert announcements.poll() == 3
    announcements.close()


def feed_wire(simulation, tmp_path, caplog):
    from eyas.dat.wire.client_session import ClientSession
    from eyas.dat.wire.exchange import Names

    session = ClientSession(Names(tmp_path, "DRONE0"), lambda line: None)
    chance, texts = random.Random(5), [str(number) for number in (*NUMBERS, *HUGE_WHOLE, "\u0663")]
    lines = [",".join([text] * 4 + ["0"]).encode() for text in texts]
    for content in (*lines, *mutated(b"1.5,-2,0.01,0.5,0", chance, 200), b"0,0,0,0,0"):
        session.names.action.write_bytes(content + b"\n")
        assert session.poll()
        simulation.reset()
        simulation.advance(np.array([session.action.command]), 20)
        assert np.isfinite(simulation.snapshot.trackers.position).all()
        session.action = None
    assert is_sound(simulation)


def feed_ros(simulation, tmp_path, caplog):
    from eyas.robotics.serving.ros import HEARD, Bridge

    class Bus:
        """Hears what is put into `next`; a bus that needs no network."""

        next = ()

        def listen(self, name, kind):
            return name

        def heard(self, name):
            found, self.next = self.next, ()
            return found

    def twist(number):
        vector = SimpleNamespace(x=number, y=number, z=number)
        return SimpleNamespace(linear=vector, angular=vector)

    bus, silent = Bus(), SimpleNamespace(of=lambda frame: [])
    for supervised in (True, False):
        tracker = {"supervised": supervised, "ground_contact": False}
        config = updated(AS_FLOWN, SMALL | {"tracker": tracker})
        bridge = Bridge(build_simulation(config, together(1)), config, bus, silent)
        loop = Loop(bridge)
        for number in (*NUMBERS, *HUGE_WHOLE, "x", None, []):
            bus.next = [twist(number), *([SimpleNamespace()] if number is None else [])]
            for _ in range(len(HEARD) * 3):
                loop.hear(0.0)
                loop.step()
        bus.next = [twist(1.0)]
        loop.hear(0.0)
        loop.step()
        assert bridge._velocities["/cmd_vel"][0].tolist() == [1.0] * 6
        assert is_sound(bridge.simulation)


DEMO = {
    "keys": {"held": {"forward": 1.0}, "sequence": 1, "time": 1.0},
    "ack": {"frame": 1, "spent": 1.0},
    "pictures": {"coding": "jpeg"},
    "look": {"view": "drone", "overlay": True, "width": 64, "height": 48},
    "click": {"x": 0.5, "y": 0.5},
    "pace": {"speed": 1.0},
    "reward": {"view_range": 1.0, "distance_range": 1.0},
    "world": {"map": "desert-bare"},
    "fly": {"policy": "follow"},
    "box": {"box": [0.1, 0.1, 0.2, 0.2]},
    "ready": {"pilot": "1", "device": "touch"},
    "leave": {},
    "film": {"link": "desert-bare/day/follow/1/00000000/hour=9"},
    "duel": {"policy": "follow"},
    "stage": {"protocol": "none"},
}


def feed_demo(simulation, tmp_path, caplog):
    pytest.importorskip("websockets")
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    from eyas.demo.choices import WorldChoice
    from eyas.demo.film import link_of, read_link
    from eyas.demo.offer import Offer
    from eyas.demo.run import listen
    from eyas.demo.server import DemoServer
    from eyas.demo.session import Session
    from eyas.demo.stages import FreeStage

    config = updated(AS_FLOWN, SMALL)
    session = Session(config, lambda: Offer.of(config, folder=tmp_path), tmp_path)
    listening, chance, loop = listen("127.0.0.1", 0), random.Random(6), asyncio.new_event_loop()
    port, begun = listening.getsockname()[1], threading.Event()
    server = loop.create_task(
        DemoServer(FreeStage(session), "127.0.0.1", listening).run(lambda _: begun.set())
    )
    thread = threading.Thread(target=lambda: asyncio_run(loop, server))
    thread.start()
    assert begun.wait(60.0)

    def page():
        return connect(f"ws://127.0.0.1:{port}/socket", max_size=None)

    texts = [
        content.replace(b"{", b'{"message": "%s", ' % kind.encode(), 1)
        for kind, values in DEMO.items()
        for content in json_contents(values, chance, 12)
    ]
    texts += list(mutated(json.dumps({"message": "pace", "speed": 1.0}).encode(), chance, 50))
    texts.sort(key=len)  # a page that says one of the last, which are too long, is closed
    for first in range(0, len(texts), 15):
        with page() as connection, suppress(ConnectionClosed):
            for text in texts[first : first + 15]:
                connection.send(text.decode(errors="ignore"))
    link = link_of(WorldChoice(EyasConfig(), 40), "follow", 1, session.offer).text
    more = [f"{link}/{name}={value:g}" for name in ("hour", "people") for value in NUMBERS]
    damaged = [content.decode(errors="replace") for content in mutated(link.encode(), chance, 200)]
    for text in (*more, *damaged, *(link.replace("/1/", f"/{bad}/") for bad in HUGE_WHOLE)):
        with suppress(EyasError):
            read_link(text, session.offer)
    for content in mutated(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", chance, 50):
        with socket.create_connection(("127.0.0.1", port), 60.0) as out:
            out.sendall(content)
    with page() as connection:
        while not isinstance(connection.recv(60.0), bytes):  # a frame
            pass
    assert not [line for line in caplog.messages if "ignored" in line]
    assert is_sound(session.flight.simulation)
    loop.call_soon_threadsafe(server.cancel)
    thread.join()


def asyncio_run(loop, task):
    try:
        loop.run_until_complete(asyncio.wait([task]))
    finally:
        loop.close()


def feed_policy(simulation, tmp_path, caplog):
    from eyas.benchmark.policies.sandbox import _decision, receive, send

    chance, whole = random.Random(7), io.BytesIO()
    send(whole, {"failed": {}}, [np.zeros((2, 3)), np.zeros(2)])
    heads = json_contents({"failed": {"0": ["", ""]}, "arrays": [["<f8", [2, 3]]]}, chance, 200)
    framed = [len(head).to_bytes(4, "little") + head + bytes(48) for head in heads]
    shapes = ([2**29] * 3, [-1], [0.5], [1e300], [math.nan], [2**62, 4], "x", None)
    for shape in shapes:
        head = json.dumps({"failed": {}, "arrays": [["<f8", shape]]}).encode()
        framed.append(len(head).to_bytes(4, "little") + head + bytes(48))
    for content in (*framed, *mutated(whole.getvalue(), chance, 300)):
        try:
            _decision(2, *receive(io.BytesIO(content)))
        except (EOFError, ValueError, KeyError, TypeError, AttributeError):  # as `ask` expects
            continue
    assert len(receive(io.BytesIO(whole.getvalue()))[1]) == 2


FEEDERS = {
    ("robotics/mavlink/endpoint.py", "recvfrom"): feed_mavlink,
    ("robotics/mavlink/hil/ardupilot.py", "recvfrom"): feed_ardupilot,
    ("robotics/mavlink/hil/px4.py", "accept"): feed_px4,
    ("robotics/mavlink/hil/px4.py", "recv"): feed_px4,
    ("dat/wire/announcements.py", "recvfrom"): feed_announcements,
    ("dat/wire/client_session.py", "read"): feed_wire,
    ("robotics/ros/dds.py", "take"): feed_ros,
    ("demo/server.py", "async for"): feed_demo,
    ("demo/server.py", "process_request"): feed_demo,
    ("benchmark/policies/sandbox.py", "read"): feed_policy,
    ("engine/terminal/helpers.py", "recv"): None,  # pipes of processes that it has started
    ("cli/bench/measurement.py", "read"): None,  # counters of this machine's own system
}


def test_each_place_that_receives_from_outside_is_fed():
    found = {place for place in places() if not place[0].startswith(NOT_OURS)}
    assert found == set(FEEDERS)


@pytest.mark.parametrize(
    "feed", sorted({feed for feed in FEEDERS.values() if feed}, key=lambda feed: feed.__name__)
)
def test_whatever_comes_ordinary_clients_are_served(feed, simulation, tmp_path, caplog):
    caplog.set_level("WARNING", "eyas")
    feed(simulation, tmp_path, caplog)
