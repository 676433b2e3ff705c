"""Who is let in, what is refused, and what several viewers get; the server is real."""

import contextlib
import json
import socket
import subprocess
import sys
import urllib.error
import urllib.request

import pytest
from PIL import Image
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from .conftest import QUICK, Viewer

pytestmark = pytest.mark.slow  # what its tests share takes long to make


def test_what_is_no_message_is_refused_with_a_line(viewer):
    for bad in (
        "",
        "no JSON",
        "[]",
        "{}",
        '{"message": "quit"}',
        '{"message": "keys"}',
        '{"message": "keys", "held": {"eject": 1}, "sequence": 1, "time": 0}',
        '{"message": "keys", "held": {"forward": 2}, "sequence": 1, "time": 0}',
        '{"message": "pace", "speed": NaN}',
        '{"message": "pace", "speed": 1e9}',
        "[" * 2000,
    ):
        viewer.errors.clear()
        viewer.connection.send(bad)
        viewer.until(lambda s: viewer.errors)
        assert "\n" not in viewer.errors[0]
        assert len(viewer.errors[0]) < 400
    assert viewer.frame()["speed_of_time"] == 1.0


def test_who_says_nothing_but_nonsense_is_thrown_out(served):
    other = Viewer(served.socket)
    for _ in range(25):
        other.connection.send("nonsense")
    with pytest.raises(ConnectionClosed):
        other.until(lambda s: False, seconds=20)
    other.close()


def test_too_long_a_message_ends_the_connection_only(served, viewer):
    other = Viewer(served.socket)
    other.connection.send("x" * 5000)
    with pytest.raises(ConnectionClosed):
        other.until(lambda s: False, seconds=20)
    other.close()
    viewer.frame()


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1"])
def test_pages_of_others_cannot_connect(served, origin):
    with pytest.raises(InvalidStatus) as refused, connect(served.socket, origin=origin):
        pass
    assert refused.value.response.status_code == 403


def test_our_own_page_can_connect(served):
    with connect(served.socket, origin=served.address.rstrip("/")):
        pass


def test_a_foreign_name_for_our_address_is_refused(served):
    request = urllib.request.Request(served.address, headers={"Host": "evil.example"})
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(request)


@pytest.mark.parametrize(
    "lines",
    [
        "GET / HTTP/1.1|Host: [",
        "GET / HTTP/1.1|Host: [::1",
        "GET / HTTP/1.1|Host: HERE|Host: evil.example",
        "GET / HTTP/1.1",
        "GET / HTTP/1.1|Host: user@localhost",
        "GET / HTTP/1.1|Host: user:secret@HERE",
        "GET / HTTP/1.1|Host: localhost:99999999",
        "GET / HTTP/1.1|Host: localhost/evil",
        "GET / HTTP/1.1|Host: localhost#@evil.example",
        "GET / HTTP/1.1|Host: HERE|Origin: http://[",
        "GET / HTTP/1.1|Host: HERE|Origin: http://HERE|Origin: http://evil.example",
        "GET //[::1 HTTP/1.1|Host: HERE",
        "GET //[::1?role=tracker HTTP/1.1|Host: HERE",
        "GET /socket?role=[&%ff&token=%ff HTTP/1.1|Host: HERE|Origin: http://\xff",
    ],
)
def test_what_is_malformed_is_refused_and_no_failure_of_ours(served, lines):
    text = lines.replace("HERE", f"127.0.0.1:{served.port}").replace("|", "\r\n") + "\r\n\r\n"
    with socket.create_connection(("127.0.0.1", served.port), 20) as connection:
        connection.sendall(text.encode("latin-1"))
        answer = connection.makefile("rb").readline()
    assert answer.split()[1:2] in ([b"403"], [b"404"], [b"400"])


@pytest.mark.parametrize(
    "method", ["POST", "PUT", "DELETE", "TRACE", "OPTIONS", "HEAD", "get", "X"]
)
def test_only_get_is_answered(served, method):
    text = f"{method} / HTTP/1.1\r\nHost: localhost:{served.port}\r\n\r\n"
    with socket.create_connection(("127.0.0.1", served.port), 20) as connection:
        connection.sendall(text.encode())
        answer = connection.makefile("rb").read()
    assert answer.startswith(b"HTTP/1.1 405 ")
    assert b"\r\nAllow: GET\r\n" in answer


def test_a_page_cannot_name_code_or_files(served, viewer):
    for message in (
        {"message": "world", "map": "unittest.__main__:main"},
        {"message": "world", "map": "/"},
        {"message": "world", "weather": "os:abort"},
        {"message": "world", "target": "os:abort"},
        {"message": "world", "tracker": "os:abort"},
        {"message": "fly", "policy": "os:abort"},
        {"message": "fly", "policy": "/tmp/x.zip"},
        {"message": "duel", "policy": "os:abort"},
    ):
        viewer.errors.clear()
        viewer.connection.send(json.dumps(message))
        viewer.until(lambda s: viewer.errors)
        assert "known: " in viewer.errors[0] or "allowed: " in viewer.errors[0]
    viewer.frame()


def test_ctrl_c_while_a_page_is_served_ends_the_loop_without_a_word():
    script = """
import asyncio, os, signal
from eyas.engine.terminal.interrupts import EndingSignals
from eyas.demo.run import run_until_signal

async def page():
    os.kill(os.getpid(), signal.SIGINT)
    await asyncio.sleep(0.2)

async def serve():
    pages = [asyncio.create_task(page())]
    try:
        await asyncio.sleep(60)
    finally:
        print("closed", flush=True)

EndingSignals().take()
try:
    run_until_signal(serve())
except KeyboardInterrupt:
    print("interrupted")
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60
    )
    assert (done.stdout, done.stderr) == ("closed\ninterrupted\n", "")


@pytest.mark.parametrize("path", ["../server.py", "%2e%2e/run.py", "nothing", "socket"])
def test_nothing_but_the_page_is_given(served, path):
    with pytest.raises(urllib.error.HTTPError, match=r"4[02]"):
        urllib.request.urlopen(served.address + path)


def test_an_address_for_others_needs_its_token(serve):
    served = serve("--host", "0.0.0.0")
    page, _, token = served.address.partition("?")
    assert len(token) > 20
    for wrong in (page, f"{page}?token=wrong", f"{page}env_config.json"):
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(wrong)
    with pytest.raises(InvalidStatus), connect(served.socket.partition("?")[0]):
        pass
    with urllib.request.urlopen(served.address) as answer:
        assert b"main.js" in answer.read()
    other = Viewer(served.socket)
    other.frame()
    other.close()


def test_one_flies_and_the_others_watch(served, viewer):
    viewer.say("pace", speed=0)
    other = Viewer(served.socket)
    other.frame()
    assert other.told["pilot"] is False
    assert other.told["viewers"] == 2
    other.say("pace", speed=1)
    other.until(lambda s: other.errors)
    assert other.frame()["speed_of_time"] == 0
    other.say("do", what="pilot")
    other.say("pace", speed=1)
    other.until(lambda s: s["speed_of_time"] == 1)
    viewer.until(lambda s: viewer.told["pilot"] is False)
    other.close()
    viewer.until(lambda s: viewer.told["pilot"] is True)


def test_who_does_not_acknowledge_gets_two_frames_and_no_queue(served, viewer):
    slow = Viewer(served.socket)
    first = viewer.frame()["frame"]
    viewer.until(lambda s: s["frame"] > first + 20)
    got = []
    for _ in range(6):
        with contextlib.suppress(TimeoutError):
            found = slow.read(timeout=0.3)
            got += [] if found is None else [found[0]["frame"]]
    assert len(got) == 2
    newest = viewer.frame()["frame"]
    slow.say("ack", frame=got[-1])
    assert slow.until(lambda s: True)["frame"] > newest - 3  # not one of those that were missed
    slow.close()


def test_a_page_comes_back_to_where_it_was(served, viewer):
    viewer.hold("climb")
    high = viewer.until(lambda s: s["height"] > 30, while_waiting=lambda: viewer.hold("climb"))[
        "height"
    ]
    viewer.close()
    again = Viewer(served.socket)
    assert again.frame()["height"] > high - 1
    again.say("do", what="reset")
    again.close()


def test_a_port_that_is_taken_is_one_line(served, eyas_command):
    port = str(served.port)
    done = eyas_command("demo", "--no-browser", "--port", port, *QUICK)
    assert done.returncode == 2
    assert done.stdout == ""
    assert port in done.stderr
    assert "--port" in done.stderr
    assert done.stderr.count("\n") == 1


def test_without_a_screen_the_terminal_gets_the_lines_of_the_original(eyas_command):
    done = eyas_command("demo", "--headless", "--seconds", "0.5", *QUICK)
    lines = done.stdout.splitlines()
    assert len(lines) == 5
    assert all(line.startswith("id: DRONE0 done: ") and " reward: " in line for line in lines)
    times = [float(line.split(" time: ")[1].split()[0]) for line in lines]
    assert times == sorted(set(times))


def test_streets_for_the_small_map(served):
    with urllib.request.urlopen(served.address + "map.json") as answer:
        streets = json.load(answer)
    assert len(streets["lanes"]) == len(streets["widths"]) > 0
    assert all(len(lane) >= 2 for lane in streets["lanes"])


def test_stopping_ends_a_recording_whole_also_without_pyav(serve, tmp_path, monkeypatch):
    (tmp_path / "av.py").write_text("raise ImportError('not here')")
    monkeypatch.syspath_prepend(tmp_path)  # the server has this process's path
    served = serve()
    viewer = Viewer(served.socket)
    viewer.say("record", on=True)
    viewer.until(lambda s: (s["recorded"] or 0) >= 3)
    viewer.close()
    assert served.stop() == 143
    (folder,) = (served.folder / "runs/demo").iterdir()
    pictures = list((folder / "DRONE0/episode0").glob("*.jpeg"))
    marks = json.loads((folder / "DRONE0/episode0/mark.json").read_text())
    assert len(marks) == len(pictures) >= 3
    with Image.open(folder / "DRONE0/episode0/episode.webp") as film:
        assert film.n_frames == len(pictures)
