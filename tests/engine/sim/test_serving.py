"""The loop that serves vehicles, with the example of a protocol of one's own."""

import json
import logging
import socket
import sys
from pathlib import Path
from threading import Thread

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.sim import serving
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.serving import Face, Loop, Orders, serve
from eyas.engine.sim.worlds import together

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture
def time_goes(monkeypatch):
    """A clock that goes on only when it is told to."""
    now = [100.0]
    monkeypatch.setattr(serving.time, "monotonic", lambda: now[0])

    def go(seconds):
        now[0] += seconds

    return go


class Held(Face):
    """Flies straight on; notes what it is asked."""

    def __init__(self, simulation, time_goes=None, speed=1.0):
        self.simulation, self._go, self._speed = simulation, time_goes, speed
        self.coming, self.seen, self.late, self.stood, self.closed = [], [], [], [], 0
        self.stands, self.takes = False, 0.0  # whether time stands still; time of a step [s]
        simulation.reset()

    @property
    def speed(self):
        return self._speed

    def receive(self, wait):
        if self._go:
            self._go(wait)
        found, self.coming = self.coming, []
        return [(f"message {message}", message) for message in found]

    def take(self, message):
        self.seen.append(message.upper())

    def orders(self):
        return None if self.stands else Orders(np.array([[2.0, 0.0, 0.0, 0.0]]), 5)

    def answer(self, *, late):
        self.late.append(late)
        if self._go:
            self._go(self.takes)

    def idle(self, stood):
        self.stood.append(round(stood, 1))

    def close(self):
        self.closed += 1


@pytest.fixture(scope="module")
def simulation(config):
    return build_simulation(config, together(1))


def ticks(face):
    return int(face.simulation.snapshot.episodes.tick[0])


@pytest.mark.parametrize(("speed", "steps"), [(1.0, 100), (0.5, 50), (4.0, 400)])
def test_time_goes_as_fast_as_the_face_wants(simulation, time_goes, speed, steps):
    face = Held(simulation, time_goes, speed)
    loop, before = Loop(face), ticks(face)
    end = serving.time.monotonic() + 0.9999
    while serving.time.monotonic() < end:
        loop.turn()
    assert ticks(face) - before == pytest.approx(5 * steps, abs=5)
    assert not any(face.late)


def test_a_face_without_a_pace_never_waits_for_the_clock(simulation, time_goes):
    face = Held(simulation, time_goes, 0.0)
    loop, before = Loop(face), ticks(face)
    for _ in range(100):
        loop.turn()
    assert (ticks(face) - before, serving.time.monotonic()) == (500, 100.0)


def test_a_slow_machine_leaves_out_pictures_then_time_and_is_told_once(
    simulation, time_goes, caplog
):
    face = Held(simulation, time_goes)
    loop, before = Loop(face), ticks(face)
    face.takes = 0.016  # for a step of 0.01 s
    for _ in range(200):
        loop.turn()
    assert face.late[:4] == [False, False, True, True]
    assert 5 < face.late.count(False) < 100  # some are not left out
    assert ticks(face) - before == 1000
    assert face.stood[0] == 0.0
    face.takes = 0.03
    for _ in range(200):
        loop.turn()
    (line,) = caplog.messages
    assert line.startswith("this machine cannot keep up: vehicles fly slower than the clock; small")


def test_where_time_stands_still_the_face_is_asked_once_a_second(simulation, time_goes, caplog):
    face = Held(simulation, time_goes)
    loop, before = Loop(face), ticks(face)
    face.stands = True
    for _ in range(57):
        loop.turn()
    assert face.stood == [1.1, 2.2, 3.3, 4.4, 5.5]  # looked at ten times a second
    assert ticks(face) == before
    face.stands = False
    loop.turn()
    loop.turn()
    assert ticks(face) == before + 10
    assert face.late == [False, False]  # what was waited for is not caught up
    assert not caplog.messages


def test_a_message_that_cannot_be_handled_is_a_line_and_the_next_is_taken(simulation, caplog):
    face = Held(simulation)
    face.coming = ["go", 3, 4, "left"]
    Loop(face).hear(0.0)
    assert face.seen == ["GO", "LEFT"]
    (line,) = caplog.messages
    assert line.startswith("message 3 ignored: AttributeError: ")


def test_it_ends_when_nothing_has_come_for_long_and_closes(simulation, time_goes, caplog):
    face = Held(simulation, time_goes)
    receive = face.receive

    def late(wait):
        if len(face.late) == 200:
            face.coming = ["go"]
        return receive(wait)

    face.receive = late
    with caplog.at_level(logging.INFO, "eyas"):
        serve(face, until_idle=2.5)
    assert caplog.messages == ["no client for 2.5 s: ended"]
    assert len(face.late) == pytest.approx(450, abs=3)
    assert face.closed == 1


@pytest.mark.parametrize("error", [KeyboardInterrupt(), ConfigError("no"), RuntimeError("bug")])
def test_whatever_ends_it_the_face_is_closed(simulation, error):
    face = Held(simulation, speed=0.0)

    def fails():
        raise error

    face.orders = fails
    with pytest.raises(type(error)):
        serve(face)
    assert face.closed == 1


def test_a_face_may_give_up_those_whom_an_error_concerns(simulation):
    face, orders, given_up = Held(simulation, speed=0.0), [None, ConfigError("no"), None], []

    def next_of():
        if not orders:
            raise KeyboardInterrupt
        if (error := orders.pop()) is not None:
            raise error
        return Held.orders(face)

    face.orders, face.fail = next_of, given_up.append
    with pytest.raises(KeyboardInterrupt):
        serve(face)
    assert list(map(str, given_up)) == ["no"]
    assert len(face.late) == 2


def test_where_the_traffic_ends_all_begins_anew(simulation, config):
    face = Held(simulation, speed=0.0)
    face.simulation.snapshot.episodes.tick[:] += face.simulation.steps_left - 4
    Loop(face).turn()
    assert ticks(face) == config.start.warm_up_steps + 5


def test_a_protocol_of_ones_own_flies_a_drone_and_hears_no_nonsense(
    simulation, monkeypatch, caplog
):
    monkeypatch.syspath_prepend(EXAMPLES)
    from own_protocol import JsonLines

    sys.modules.pop("own_protocol")
    face, ended = JsonLines(simulation), []

    def work():
        serve(face, until_idle=0.5)
        ended.append(True)

    before = simulation.snapshot.trackers.position[0].copy()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.connect(face.socket.getsockname())
        out.settimeout(60.0)
        for nonsense in (b"", b"\xff", b"[" * 990, b"[1]", b'{"up": NaN}', b'{"up": "x"}',
                         b'{"height": 3}', b'{"up": 1e99}', b"7" * 3000):  # fmt: skip
            out.send(nonsense)
        out.send(b'{"forward": 5.0}')
        server = Thread(target=work)
        server.start()
        told = [json.loads(out.recv(1000))]
        for _ in range(9):
            out.send(b'{"forward": 5.0, "up": 1.0}')
            told.append(json.loads(out.recv(1000)))
    server.join()
    assert ended
    assert [line["time"] for line in told] == [round(0.008 * at, 3) for at in range(1, 11)]
    assert told[-1]["position"][2] > before[2] + 0.05
    assert told[-1]["position"] == simulation.snapshot.trackers.position[0].tolist()
    assert len([line for line in caplog.messages if "a line from 127.0.0.1 ignored" in line]) == 1


@pytest.mark.slow
def test_the_example_of_a_protocol_runs(monkeypatch, capsys):
    monkeypatch.syspath_prepend(EXAMPLES)
    import own_protocol

    sys.modules.pop("own_protocol")
    own_protocol.main()
    assert len(capsys.readouterr().out.splitlines()) == 4
