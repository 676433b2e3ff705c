"""`eyas serve --mavlink` as a process of its own, flown by MAVSDK in another."""

import importlib.util
import json
import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

if importlib.util.find_spec("mavsdk") is None:
    pytest.skip("needs mavsdk", allow_module_level=True)

from pymavlink.dialects.v20 import common

CLIENT = Path(__file__).with_name("mavsdk_client.py")


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as some:
        some.bind(("127.0.0.1", 0))
        return some.getsockname()[1]


@contextmanager
def running(*words):
    process = subprocess.Popen([sys.executable, *words], stdout=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


@contextmanager
def serving(*addresses):
    words = [word for address in addresses for word in ("--mavlink", address)]
    small = ["--set", "camera.width=96", "--set", "camera.height=54"]
    with running("-m", "eyas", "serve", *words, *small, "--set", "mavlink.picture_rate=5") as it:
        yield it


class Listener:
    """A second ground station, which only listens."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        self.socket.settimeout(60.0)

    def until(self, true, seconds=60.0):
        """Return the first message of which something is so."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for message in common.MAVLink(None).parse_buffer(self.socket.recv(65_535)) or []:
                if true(message):
                    return message
        raise AssertionError("no such message")


@pytest.mark.slow
def test_mavsdk_finds_it_flies_a_square_and_lands():
    port, other = free_port(), free_port()
    addresses = [f"udp:127.0.0.1:{one}" for one in (port, other)]
    listener = Listener(other)
    with serving(*addresses), running(str(CLIENT), str(port), "flight") as client:
        told = [json.loads(line) for line in client.stdout if line.startswith("{")]
        assert client.wait() == 0
        landed = listener.until(lambda m: m.get_type() == "EXTENDED_SYS_STATE")
    listener.socket.close()
    facts = {key: value for line in told for key, value in line.items()}
    assert (facts["system"], facts["healthy"], facts["flies"]) == (1, True, True)
    corners = [line for line in told if "corner" in line]
    assert len(corners) == 4
    for line in corners:
        assert line["place"] == pytest.approx([*line["corner"], -2.0], abs=0.3)
    assert facts["gimbal"] == pytest.approx([-35.0, 20.0], abs=0.6)
    assert (facts["camera"], facts["size"]) == (100, [96, 54])
    assert (facts["parameters"], facts["height"], facts["mission"]) == (20, 2.0, [])
    assert facts["landed"] is True
    assert landed is not None


@pytest.mark.slow
def test_when_its_client_dies_it_holds_and_another_takes_over():
    port, other = free_port(), free_port()
    listener = Listener(other)
    with serving(f"udp:127.0.0.1:{port}", f"udp:127.0.0.1:{other}") as server:
        with running(str(CLIENT), str(port), "lost") as client:
            assert any("offboard" in line for line in client.stdout)
            os.kill(client.pid, signal.SIGKILL)
        text = listener.until(lambda m: m.get_type() == "STATUSTEXT" and "lost" in m.text).text
        assert text == "Offboard set points lost: holding"
        beat = listener.until(lambda m: m.get_type() == "HEARTBEAT" and m.get_srcComponent() == 1)
        assert beat.custom_mode == 4 << 16 | 3 << 24
        peer = listener.socket.recvfrom(65_535)[1]
        land = common.MAVLink_command_long_message(1, 1, 21, 0, *[0.0] * 7)
        listener.socket.sendto(land.pack(common.MAVLink(None, 254, 190)), peer)
        assert listener.until(lambda m: m.get_type() == "COMMAND_ACK").result == 0
        assert server.poll() is None
    listener.socket.close()


@pytest.mark.slow
@pytest.mark.thorough
def test_mavsdks_follow_me_stays_active_and_is_followed():
    port = free_port()
    with serving(f"udp:127.0.0.1:{port}"), running(str(CLIENT), str(port), "follow") as client:
        told = [json.loads(line) for line in client.stdout if line.startswith("{")]
        assert client.wait() == 0
    facts = {key: value for line in told for key, value in line.items()}
    assert (facts["active"], facts["followed"], facts["stopped"]) == (True, True, True)
