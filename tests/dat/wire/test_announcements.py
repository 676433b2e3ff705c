import logging
import math
import socket
import threading
import time

import pytest

from eyas.dat.wire.announcements import Announcements, listen_early
from eyas.engine.core.errors import ConfigError, OutputError


@pytest.fixture
def line():
    """The server's socket, and a function that sends to it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.bind(("127.0.0.1", 0))
        port = out.getsockname()[1]
    announcements = Announcements("127.0.0.1", port)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        yield announcements, lambda message: out.sendto(message, ("127.0.0.1", port)), port
    announcements.close()


@pytest.mark.parametrize(("message", "count"), [(b"4\n", 4), (b"1", 1), (b" 12\r\n", 12)])
def test_the_first_number_is_that_of_the_agents(line, message, count):
    announcements, send, _ = line
    threading.Timer(0.1, send, (message,)).start()
    assert announcements.wait(60.0) == count
    assert announcements.poll() is None


def test_what_is_no_number_of_agents_is_told_once_in_a_second_and_ignored(line, caplog):
    announcements, send, _ = line
    for message in (b"", b"0\n", b"-1", b"1025", b"four", b"\xff\x00", b"1 2", b"9" * 400):
        send(message)
    send(b"3\n")
    with caplog.at_level(logging.WARNING, "eyas"):
        assert [announcements.wait(60.0) for _ in range(9)] == [*[None] * 8, 3]
    assert len(caplog.messages) == 1
    assert caplog.messages[0].endswith("ignored: not a number of agents, 1 to 1024")


def test_looking_does_not_wait(line):
    announcements, _, _ = line
    begin = time.monotonic()
    assert announcements.poll() is None
    assert time.monotonic() - begin < 0.4


def test_what_is_announced_before_it_is_made_is_heard():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.bind(("127.0.0.1", 0))
        port = out.getsockname()[1]
    listen_early("127.0.0.1", port)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.sendto(b"7", ("127.0.0.1", port))
    announcements = Announcements("127.0.0.1", port)
    assert announcements.wait(60.0) == 7
    assert announcements.since < math.inf
    announcements.close()
    Announcements("127.0.0.1", port).close()  # it is free


def test_a_port_in_use_is_one_line(line):
    _, _, port = line
    with pytest.raises(OutputError, match=rf"^wire\.port: cannot listen on UDP port {port} of "):
        Announcements("127.0.0.1", port)


def test_it_listens_where_it_is_told_only(line):
    port = line[2]
    with pytest.raises(OutputError, match=r"^wire\.port: "):  # not an address of this machine
        Announcements("192.0.2.1", port)
    with pytest.raises(
        ConfigError, match=r"^wire\.address: 'no such host' is not a network address"
    ):
        Announcements("no such host", port)
