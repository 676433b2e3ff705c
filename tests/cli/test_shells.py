"""The program in all kinds of shells: the same bytes, and at most one line."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import eyas
from eyas.engine.camera.config import CameraConfig
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import save_settings
from eyas.engine.settings.video import VideoConfig
from eyas.engine.video import run as video
from eyas.lanes.trusted import cache_folder

CONFIG = EyasConfig(
    camera=CameraConfig(width=64, height=48),
    video=VideoConfig(channels=1, fps=50.0, start_time=0.7, total_time=0.3, warm_up_steps=10),
)
START = """
import sys
sys.path.insert(0, sys.argv.pop(1))
from eyas.cli.main import main
main()
"""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> dict[str, bytes]:
    path = tmp_path_factory.mktemp("video")
    video.run(CONFIG, path / "out", quiet=True)
    save_settings(CONFIG, path / "settings.json")
    return path


def contents(path):
    return {str(p.relative_to(path)): p.read_bytes() for p in path.rglob("*") if p.is_file()}


def command(*arguments, flags=()):
    source = str(Path(eyas.__file__).parents[1])
    return [sys.executable, *flags, "-c", START, source, *map(str, arguments)]


def shell(line, *arguments, flags=(), **environment):
    """Run a command in a shell, in whose line `"$@"` stands for it."""
    return subprocess.run(
        ["sh", "-c", line, "sh", *command(*arguments, flags=flags)],
        capture_output=True, check=False, timeout=120,
        env={**os.environ, "EYAS_CACHE_DIR": str(cache_folder()), **environment},
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "flags", "environment"),
    [
        ('"$@"', ["-I", "-B", "-W", "error"], {"HOME": "/nowhere"}),
        ('exec "$@" >&- 2>&- <&-', ["-OO"], {"TERM": "dumb", "NO_COLOR": "1"}),
        (
            'umask 077; "$@" | head -c 1',
            [],
            {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0", "COLUMNS": "20"},
        ),
    ],
    ids=["isolated", "closed", "C"],
)
def test_a_recording_is_the_same_in_every_shell(recorded, tmp_path, line, flags, environment):
    settings = recorded / "settings.json"
    arguments = ("video", "--config", settings, "--out", tmp_path / "out")
    done = shell(line, *arguments, flags=flags, **environment)
    assert (done.returncode, done.stderr) == (0, b"")
    assert contents(tmp_path / "out") == contents(recorded / "out")


@pytest.mark.slow
def test_without_a_network_nothing_is_missed(recorded, tmp_path):
    if subprocess.run(["unshare", "-n", "true"], capture_output=True, check=False).returncode:
        pytest.skip("only root can take its network away")
    settings = recorded / "settings.json"
    done = shell('unshare -n "$@"', "video", "--config", settings, "--out", tmp_path / "out")
    assert (done.returncode, done.stderr) == (0, b"")
    assert contents(tmp_path / "out") == contents(recorded / "out")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "code", "said"),
    [
        ('"$@" > /dev/full', 2, b"eyas: error: stdout: cannot write: No space left on device\n"),
        ('"$@" 2> /dev/full', 0, b""),
        ('"$@" >&-', 0, b""),
        ('cd "$(mktemp -d)" && rmdir "$PWD" && "$@"', 0, b""),
    ],
)
def test_output_that_goes_nowhere_is_no_traceback(line, code, said):
    done = shell(line, "config", "show")
    assert (done.returncode, done.stderr) == (code, said)


def test_an_error_without_anywhere_to_say_it_is_its_exit_code():
    for line in ('"$@" 2>&-', '"$@" 2> /dev/full', '"$@" >&- 2>&-'):
        done = shell(line, "config", "show", "--set", "sede=1")
        assert (done.returncode, done.stdout, done.stderr) == (2, b"", b"")


def test_without_a_terminal_there_are_no_colours_and_no_bars():
    done = shell('"$@"', "cache", "info", TERM="dumb")
    assert not done.returncode
    assert b"\x1b" not in done.stdout + done.stderr
