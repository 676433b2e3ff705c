"""One server of the demo for all tests of a module, in a process of its own, on a simple map."""

import contextlib
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest

from eyas.demo.messages import RewardMessage
from eyas.engine.task.config import RewardConfig

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")

try:
    import playwright  # noqa: F401
except ImportError:
    CHROMIUM = None

# Tests of the page itself run where a browser and what drives it are installed.
if CHROMIUM is None:
    collect_ignore = ["test_page.py", "test_hands.py", "test_reference_page.py"]

QUICK = ["--set", "world.map=simpleway-grass", "--set", "traffic.max_vehicles=40"]


WORLD = {
    "map": "simpleway-grass",
    "weather": "day",
    "vehicles": 40,
    "target": "SUMO_VEHICLE",
    "tracker": "drone",
    "light": "own",
    "hour": "own",
    "people": 0,
}
REWARD = RewardConfig().model_dump(mode="json", include=set(RewardMessage.model_fields))


class Served:
    """A running `eyas demo`."""

    def __init__(self, folder, *options, quick=QUICK):
        command = [sys.executable, "-m", "eyas.cli.main", "demo", "--no-browser", "--port", "0"]
        self.folder = folder
        self.process = subprocess.Popen(
            [*command, *quick, *options],
            stdout=subprocess.PIPE,
            text=True,
            cwd=folder,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))},
        )
        self.address = self.process.stdout.readline().strip()

    @property
    def port(self):
        return int(self.address.partition("?")[0].rstrip("/").rpartition(":")[2])

    @property
    def socket(self):
        page, _, query = self.address.partition("?")
        return page.replace("http", "ws") + "socket" + (f"?{query}" if query else "")

    def stop(self):
        self.process.terminate()
        return self.process.wait(20)


@pytest.fixture(scope="module")
def serve(tmp_path_factory):
    """Starts `eyas demo` with options; all are stopped at the end of the file."""
    with contextlib.ExitStack() as stack:

        def start(*options, folder=None, **how):
            folder = folder or Path(tmp_path_factory.mktemp("demo"))
            served = Served(folder, *options, **how)
            stack.callback(served.process.stdout.close)
            stack.callback(served.stop)
            return served

        yield start


@pytest.fixture(scope="module")
def served(serve):
    """One server for a file, so that no file flies with what another has set."""
    served = serve()
    yield served
    served.stop()


class Viewer:
    """A page without a browser: it acknowledges what it reads."""

    def __init__(self, address, **options):
        from websockets.sync.client import connect

        self._open = contextlib.ExitStack()
        self.connection = self._open.enter_context(connect(address, max_size=None, **options))
        self.told, self.sequence = {}, 0
        self.errors = []

    def say(self, message, **values):
        self.connection.send(json.dumps({"message": message, **values}))

    def hold(self, *controls):
        self.sequence += 1
        held = dict.fromkeys(map(str, controls), 1)
        self.say("keys", held=held, sequence=self.sequence, time=self.sequence)

    def read(self, timeout=30.0):
        """Return the state of the next frame and its picture, or None for a text."""
        data = self.connection.recv(timeout)
        if isinstance(data, str):
            told = json.loads(data)
            self.told |= told
            self.errors += [told["error"]] if "error" in told else []
            return None
        length = struct.unpack("<I", data[:4])[0]
        return json.loads(data[4 : 4 + length]), data[4 + length :]

    def frame(self):
        """Return the state of the next frame, and acknowledge it."""
        while (found := self.read()) is None:
            pass
        self.picture = found[1]
        self.say("ack", frame=found[0]["frame"])
        return found[0]

    def until(self, wanted, seconds=30.0, while_waiting=lambda: None):
        """Return the first state of which something is true."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            state = self.frame()
            if wanted(state):
                return state
            while_waiting()
        raise AssertionError(f"not within {seconds} s; last state: {state}")

    def settled(self):
        """Return a state in which nothing is held and the drone stands still."""
        self.hold()
        sequence = self.sequence
        return self.until(
            lambda s: s["sequence"] >= sequence and abs(s["speed"]) + abs(s["yaw_rate"]) < 0.05,
            while_waiting=self.hold,
        )

    def close(self):
        self._open.close()


def moved(before, after):
    """Forward, left, up [m] and turn to the left [rad] from one state to another."""
    x, y, z, yaw = before["drone"]
    dx, dy = after["drone"][0] - x, after["drone"][1] - y
    return {
        "forward": math.cos(yaw) * dx + math.sin(yaw) * dy,
        "left": -math.sin(yaw) * dx + math.cos(yaw) * dy,
        "up": after["drone"][2] - z,
        "turn": (after["drone"][3] - yaw + math.pi) % (2 * math.pi) - math.pi,
        "pitch": after["pitch"] - before["pitch"],
        "camera": after["camera_yaw"] - before["camera_yaw"],
    }


def restore(viewer):
    """Set everything that a test before may have set, so that no test meets what another did."""
    viewer.say("do", what="pilot")
    viewer.say("duel", policy=None)
    viewer.say("record", on=False)
    viewer.say("pace", speed=1)
    viewer.say("fly", policy=None)
    viewer.say("look", overlay=False, width=160, height=90)
    viewer.frame()
    if not viewer.told.keys() >= {"world", "reward"}:
        viewer.until(lambda s: viewer.told.keys() >= {"world", "reward"})
    world = {name: viewer.told["world"][name] for name in WORLD}
    if world != WORLD or viewer.told["busy"]:
        viewer.say("world", **WORLD)
        viewer.until(lambda s: viewer.told["busy"], seconds=120)
        viewer.until(lambda s: not viewer.told["busy"], seconds=120)
    viewer.say("reward", **REWARD)
    viewer.say("do", what="parked_target")
    viewer.until(lambda s: s["target"]["parked"] and s["steps"] < 500 and not s["recorded"])
    viewer.settled()
    viewer.errors.clear()


@pytest.fixture
def viewer(served):
    one = Viewer(served.socket)
    restore(one)
    yield one
    one.close()


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        flags = ["--headless", "--no-sandbox", "--disable-gpu"]
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=flags)
        yield chromium
        chromium.close()


def until(page, truth, seconds=40):
    """Wait until something is true of the page; its policy forbids what playwright has for that."""
    from playwright.sync_api import Error

    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            if page.evaluate(truth):
                return
        except Error as error:
            if "navigation" not in str(error):  # the page loads anew
                raise
        time.sleep(0.05)
    raise AssertionError(f"not within {seconds} s: {truth}; {page.evaluate('window.eyas.state')}")
