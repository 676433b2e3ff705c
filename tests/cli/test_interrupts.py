"""Ctrl-C, SIGTERM and SIGHUP: one line, its own exit code, and whole files, at any moment."""

import json
import os
import random
import signal
import subprocess
import sys
import time

import pytest
from PIL import Image

from eyas.lanes.trusted import read_trusted

PROGRAM = """
import sys
from eyas.cli.main import main
print("ready", flush=True)
main()
"""
SETTINGS = {
    "camera": {"width": 64, "height": 48},
    "video": {"channels": 2, "total_time": 300.0, "fps": 50, "writers": ["jpeg", "mp4", "labels"]},
}
WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}


def started(folder, *arguments, cache=None, program=PROGRAM):
    """Start a command; return it when `main` begins."""
    environment = {**os.environ, **({"EYAS_CACHE_DIR": str(cache)} if cache else {})}
    environment.pop("NUMBA_CACHE_DIR", None)
    process = subprocess.Popen(
        [sys.executable, "-c", program, *map(str, arguments)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, cwd=folder, env=environment,
    )  # fmt: skip
    assert process.stdout.readline() == "ready\n"
    return process


def recording(folder, **options):
    (folder / "settings.json").write_text(json.dumps(SETTINGS))
    return started(folder, "video", "--config", "settings.json", "--out", "out", **options)


def ended(process, number, timeout=60):
    """Check how a command ended that was sent a signal."""
    out, err = process.communicate(timeout=timeout)
    *told, line = err.splitlines()
    assert process.returncode == 128 + number, err
    assert line.startswith(f"eyas: {WORDS[number]}")
    # What took long to make is told, if nothing is in the cache yet.
    first = ("warning: first start", "making ")
    once = tuple(f"eyas: {words}" for words in first)
    assert all(each.startswith(once) for each in told), err
    assert "Traceback" not in out
    return line


def check_whole(folder):
    for path in folder.rglob("*"):
        assert not path.name.endswith(".part"), path
        if path.suffix == ".jpeg":
            Image.open(path).load()
        elif path.suffix == ".json":
            json.loads(path.read_text())


@pytest.mark.slow
@pytest.mark.parametrize("number", WORDS)
def test_a_signal_at_any_moment_is_one_line_and_its_own_exit_code(tmp_path, number):
    moments = random.Random(int(number))
    for attempt, latest in enumerate((0.05, 0.5, 1.2, 3.0)):
        folder = tmp_path / str(attempt)
        folder.mkdir()
        process = recording(folder)
        time.sleep(moments.uniform(0.0, latest))
        process.send_signal(number)
        ended(process, number)
        check_whole(folder)


def until_frames(process, folder):
    while not list(folder.glob("out/DRONE*/episode0/000003.jpeg")):
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)


@pytest.mark.slow
def test_further_signals_change_nothing_and_the_line_says_how_to_go_on(tmp_path):
    process = recording(tmp_path)
    until_frames(process, tmp_path)
    for number in (signal.SIGINT, signal.SIGINT, signal.SIGTERM, signal.SIGINT):
        process.send_signal(number)
        time.sleep(0.02)
    line = ended(process, signal.SIGINT)
    assert line == "eyas: interrupted; every file in out is whole; continue with --resume"
    check_whole(tmp_path)


COMPILES = """
import signal
from eyas.cli import app
from eyas.cli.main import main

def run():
    from eyas.lanes import entry
    entry.shipped_address = lambda name: None  # so that there is something to compile
    import eyas
    print("ready", flush=True)
    eyas.make("desert-bare-day").reset()
    signal.pause()  # a fast machine is done before the signal comes

app.run = run
main()
"""


@pytest.mark.slow
def test_a_signal_while_compiling_is_one_line_and_what_is_kept_is_whole(tmp_path):
    process = started(tmp_path, cache=tmp_path / "cache", program=COMPILES)
    time.sleep(2.0)
    process.send_signal(signal.SIGINT)
    assert ended(process, signal.SIGINT) == "eyas: interrupted"
    assert all(map(read_trusted, tmp_path.rglob("*.ey[km]")))
    assert not list(tmp_path.rglob("*.tmp.*"))


IN_RUST = """
import os, signal
from pydantic_core import SchemaValidator, core_schema
from eyas.cli import app
from eyas.cli.main import main

class Member:
    @property
    def value(self):
        os.kill(os.getpid(), signal.SIGINT)

def run():
    SchemaValidator(core_schema.enum_schema(Member, [Member()]))

app.run = run
print("ready", flush=True)
main()
"""


def test_an_interrupt_that_pydantic_puts_in_words_is_one_line(tmp_path):
    process = started(tmp_path, program=IN_RUST)
    assert ended(process, signal.SIGINT) == "eyas: interrupted"


@pytest.mark.slow
def test_a_program_started_with_the_signal_ignored_goes_on(tmp_path):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        process = recording(tmp_path)
    finally:
        signal.signal(signal.SIGHUP, before)
    until_frames(process, tmp_path)
    process.send_signal(signal.SIGHUP)
    time.sleep(0.3)
    assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    ended(process, signal.SIGTERM)


LOSES = """
import sys, time
from eyas.cli import app
from eyas.cli.main import main

class Deaf:
    def __del__(self):  # Python cannot raise from here
        print("ready", flush=True)
        time.sleep(60)

def run():
    Deaf()
    time.sleep(60)
    return 0

app.run = run
main()
"""


def test_an_interrupt_that_python_would_lose_comes_again(tmp_path):
    process = started(tmp_path, program=LOSES)
    time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    ended(process, signal.SIGINT, timeout=20)


WRAPS = """
import time
from eyas.cli import app
from eyas.cli.main import main

class Slow:
    def __set_name__(self, owner, name):  # Python 3.11 wraps what is raised here
        print("ready", flush=True)
        time.sleep(60)

def run():
    class Owner:
        slow = Slow()
    return 0

app.run = run
main()
"""


def test_an_interrupt_that_python_wraps_in_an_error_is_still_one_line(tmp_path):
    process = started(tmp_path, program=WRAPS)
    time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    assert ended(process, signal.SIGINT, timeout=20) == "eyas: interrupted"


LATE = """
import atexit, time
from eyas.cli import app
from eyas.cli.main import main

def late():
    print("ready", flush=True)
    time.sleep(0.5)

app.run = lambda: atexit.register(late) and 0 or 0
main()
"""


def test_a_signal_after_all_is_done_changes_nothing(tmp_path):
    process = started(tmp_path, program=LATE)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (0, "")
