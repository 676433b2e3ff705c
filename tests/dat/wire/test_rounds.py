"""The server in this process, with a group of its own, where the order of events is certain."""

import socket
import threading
import time

import pytest

from eyas.dat.wire.config import WireConfig
from eyas.dat.wire.exchange import HOVER, RESET, ExchangeFolders, Pause
from eyas.dat.wire.server import Server, Service
from eyas.engine.sim.serving import serve as serve_by


class EnoughError(Exception):
    pass


class TrackerGroup:
    """Ends the server at its first round."""

    def __init__(self, played):
        self.played = played

    sim = None

    def orders(self, actions):
        self.played.append(list(actions))
        raise EnoughError

    def close(self):
        self.played.append("closed")


@pytest.fixture
def port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


@pytest.fixture(autouse=True)
def not_for_ever(monkeypatch):
    end = time.monotonic() + 20.0
    sleep = Pause.sleep

    def limited(pause):
        assert time.monotonic() < end, "the server waits for what will not come"
        sleep(pause)

    monkeypatch.setattr(Pause, "sleep", limited)


@pytest.fixture
def run(tmp_path, port):
    """Serve two agents; `begin` is called with each number of agents, and a way to announce."""
    exchange = ExchangeFolders(tmp_path)

    def announce(agents):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            out.sendto(b"%d\n" % agents, ("127.0.0.1", port))

    def first():
        while not (exchange.files / "start.txt").exists():
            time.sleep(0.01)
        announce(2)

    def serve(begin):
        played = []

        def build(count):
            begin(count, announce, lambda n: exchange.names(f"DRONE{n}"))
            return TrackerGroup(played)

        service = Service(WireConfig(port=port), "DRONE", build, verbose=False)
        starter = threading.Thread(target=first, daemon=True)
        starter.start()
        with pytest.raises(EnoughError):
            serve_by(Server(exchange, lambda: service, lambda: ("127.0.0.1", port)))
        starter.join()
        return played

    return serve


def test_first_resets_that_come_before_another_number_is_heard_are_not_lost(run):
    def begin(count, announce, names):
        if count == 2:
            announce(3)
            names(0).action.write_text("0,0,0,0,1\n")
            names(1).action.write_text("0,0,0,0,1\n")
        else:
            names(2).action.write_text("0,0,0,0,1\n")

    assert run(begin) == ["closed", [RESET] * 3, "closed"]


def test_what_clients_that_are_gone_have_asked_for_is_forgotten(run):
    def begin(count, announce, names):
        if count == 2:
            names(0).action.write_text("5,0,0,0,0\n")  # and then it dies
            threading.Timer(0.3, announce, (1,)).start()
        else:
            names(0).action.write_text("0,0,0,0,0\n")

    assert run(begin) == ["closed", [HOVER], "closed"]


def test_the_same_number_again_changes_nothing(run):
    def begin(count, announce, names):
        announce(2)
        names(0).action.write_text("0,0,0,0,1\n")
        names(1).action.write_text("0,0,0,0,0\n")

    assert run(begin) == [[RESET, HOVER], "closed"]
