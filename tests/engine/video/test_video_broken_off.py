"""`eyas video` killed, on a full disk, and in a folder made read-only: `--resume` ends it.

`EYAS_TEST_KILLS=30` kills as often as before a release.
"""

import hashlib
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.config import updated
from eyas.engine.core.errors import OutputError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import save_settings
from eyas.engine.settings.video import VideoConfig
from eyas.engine.task.config import DoneConfig
from eyas.engine.video import run as video
from eyas.engine.world.config import WorldConfig

pytestmark = pytest.mark.slow  # what its tests share takes long to make

KILLS = int(os.environ.get("EYAS_TEST_KILLS", "4"))

# Two trackers, three episodes of 0.3 s each, a frame every 8 ms, where each process loads little.
CONFIG = EyasConfig(
    seed=5,
    world=WorldConfig(map="simpleway-grass"),
    extras=[],
    camera=CameraConfig(width=64, height=48),
    done=DoneConfig(total_steps=150, grace_steps=20),
    video=VideoConfig(
        channels=2, fps=125.0, start_time=0.7, total_time=0.9, warm_up_steps=10,
        writers=("jpeg", "mp4", "webp", "labels", "mark"),
    ),
)  # fmt: skip
UNPRIVILEGED = ["setpriv", "--bounding-set=-dac_override,-dac_read_search,-fowner"]
"""Root without its right to ignore permissions; for others it changes nothing."""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> dict[str, bytes]:
    path = tmp_path_factory.mktemp("video") / "out"
    video.run(CONFIG, path, quiet=True)
    return contents(path)


@pytest.fixture
def settings(tmp_path) -> Path:
    save_settings(CONFIG, tmp_path / "settings.json")
    return tmp_path / "settings.json"


def contents(path: Path) -> dict[str, bytes]:
    return {
        inside.relative_to(path).as_posix(): inside.read_bytes()
        for inside in path.rglob("*")
        if inside.is_file()
    }


def start(settings: Path, out: Path, *before: str, workers: int = 1) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "eyas.cli.main", "video", "--config", str(settings)]
    options = ["--out", str(out), "--resume", "--quiet", "--workers", str(workers)]
    return subprocess.Popen(
        [*before, *command, *options],
        stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def check_resumed(out, recorded):
    video.run(CONFIG, out, resume=True, quiet=True)
    assert contents(out) == recorded


def check_whole(out, recorded):
    """Check that whatever has its last name has its last content."""
    for name, data in contents(out).items():
        if not name.endswith((".part", ".lock", ".checksums")):
            assert data == recorded[name], name


def test_killed_at_any_moment_it_continues_to_the_same_bytes(settings, tmp_path, recorded):
    """Each recording is killed a few times before it is done, and the next one goes on there."""
    moments, latest = random.Random(7), 2.0
    for attempt in range(KILLS):
        out = tmp_path / f"out{attempt // 3}"
        process = start(settings, out)
        if attempt % 3:  # in the recording; else anywhere, mostly before it
            while not list(out.glob("DRONE*/episode*/*.jpeg")) and process.poll() is None:
                time.sleep(0.01)
            latest = 0.4
        time.sleep(moments.uniform(0.0, latest))
        process.kill()
        process.communicate()
        if out.exists():
            check_whole(out, recorded)
        if attempt % 3 == 2 or attempt == KILLS - 1:
            check_resumed(out, recorded)


def test_several_processes_record_the_same_bytes(tmp_path, recorded):
    video.run(CONFIG, tmp_path / "out", quiet=True, workers=3)
    assert contents(tmp_path / "out") == recorded


@pytest.mark.parametrize(
    ("cores", "settings", "workers"),
    [
        ("8", {"total_time": 60.0}, 4),
        ("2", {"total_time": 60.0}, 1),
        ("8", {"total_time": 60.0, "policy": "hover"}, 1),
        ("8", {"episode_frames": 5000, "channels": 1}, 1),
        ("8", {"episode_frames": 100, "channels": 2, "episodes": 3}, 2),
    ],
)
def test_processes_are_chosen_by_cores_and_by_what_there_is_to_record(
    monkeypatch, cores, settings, workers
):
    monkeypatch.setenv("NUMBA_NUM_THREADS", cores)
    assert video.default_workers(updated(EyasConfig(), {"video": settings})) == workers


def begun_with_helpers(settings: Path, out: Path) -> tuple[subprocess.Popen[str], list[int]]:
    """Return a recording whose second process has drawn, and the ids of its own processes."""
    process = start(settings, out, workers=2)
    while not list(out.glob("DRONE1/episode0/*.jpeg")) and process.poll() is None:
        time.sleep(0.01)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    named = {child: Path(f"/proc/{child}/cmdline").read_bytes() for child in children}
    return process, [int(child) for child in children if b"spawn_main" in named[child]]


def test_interrupted_it_ends_its_processes_and_leaves_nothing_unfinished(
    settings, tmp_path, recorded
):
    process, helpers = begun_with_helpers(settings, tmp_path / "out")
    assert helpers
    process.send_signal(signal.SIGINT)
    err = process.communicate(timeout=60)[1]
    assert (process.returncode, err.count("\n")) == (130, 1), err
    assert not any(Path(f"/proc/{helper}").exists() for helper in helpers)
    assert not list((tmp_path / "out").rglob("*.part"))
    check_whole(tmp_path / "out", recorded)
    check_resumed(tmp_path / "out", recorded)


def test_a_killed_process_ends_it_in_one_line(settings, tmp_path, recorded):
    process, helpers = begun_with_helpers(settings, tmp_path / "out")
    os.kill(helpers[0], signal.SIGKILL)
    err = process.communicate(timeout=60)[1]
    assert (process.returncode, err.count("\n")) == (2, 1), err
    assert "one of the processes was killed" in err
    assert "--resume" in err
    check_whole(tmp_path / "out", recorded)
    check_resumed(tmp_path / "out", recorded)


@pytest.mark.parametrize("last", ["version.json", "config.json", "env_config.json"])
def test_broken_off_among_its_first_files_it_goes_on(tmp_path, recorded, last):
    (tmp_path / "out").mkdir()
    for name in ("version.json", "config.json", "env_config.json"):
        (tmp_path / "out" / name).write_bytes(recorded[name])
        if name == last:
            break
    check_resumed(tmp_path / "out", recorded)


def test_a_file_of_others_with_the_name_of_its_first_one_is_kept(tmp_path):
    (tmp_path / "version.json").write_text('{"mine": 1}')
    with pytest.raises(OutputError, match="unknown version"):
        video.run(CONFIG, tmp_path, resume=True, quiet=True)
    assert contents(tmp_path) == {"version.json": b'{"mine": 1}'}


def stopped(process: subprocess.Popen[str], reason: str) -> None:
    """Check that a recording ends by one line."""
    err = process.communicate(timeout=60)[1]
    assert (process.returncode, err.count("\n")) == (2, 1), err
    assert f"cannot write: {reason}" in err
    assert err.endswith("; continue with --resume\n")


def test_in_a_folder_made_read_only_it_ends_in_one_line_and_goes_on(settings, tmp_path, recorded):
    out = tmp_path / "out"
    process = start(settings, out, *UNPRIVILEGED)
    while not (out / "DRONE1" / "episode1" / "000001.jpeg").exists():
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    folders = [out, *(path for path in out.rglob("*") if path.is_dir())]
    for folder in folders:
        folder.chmod(0o555)
    stopped(process, "Permission denied")
    check_whole(out, recorded)
    for folder in folders:
        folder.chmod(0o755)
    check_resumed(out, recorded)


def test_on_a_full_disk_it_ends_in_one_line_and_goes_on(settings, tmp_path, recorded):
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=700k", "tmpfs", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("disks of a given size are only for root")
    try:
        stopped(start(settings, disk / "out"), "No space left on device")
        check_whole(disk / "out", recorded)
        subprocess.run(["mount", "-o", "remount,size=100m", str(disk)], check=True)
        check_resumed(disk / "out", recorded)
    finally:
        subprocess.run(["umount", "-l", str(disk)], check=True)


def flipped(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0x10
    path.write_bytes(content)


def emptied(path):
    path.write_bytes(b"")


def edited(path):
    path.write_text(path.read_text().replace("0.", "1.", 1))


@pytest.mark.parametrize(
    ("name", "damage"),
    [
        ("DRONE0/episode0/000000.jpeg", flipped),
        ("DRONE0/episode0/000001.jpeg", emptied),
        ("DRONE1/episode0/mark.json", edited),
        ("DRONE1/episode0/labels.jsonl", edited),
        ("checksums.sha256", emptied),
        ("checksums.sha256", flipped),
    ],
)
def test_what_was_damaged_after_its_end_is_drawn_again(tmp_path, recorded, name, damage):
    for inside, content in recorded.items():
        path = tmp_path / inside
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    damage(tmp_path / name)
    assert (tmp_path / name).read_bytes() != recorded[name]
    check_resumed(tmp_path, recorded)


def test_the_checksums_are_those_of_all_files_of_episodes(recorded):
    lines = recorded["checksums.sha256"].decode().split("\n")[:-1]
    told = dict(line.split("  ")[::-1] for line in lines)
    assert list(told) == sorted(told)
    found = {name: hashlib.sha256(recorded[name]).hexdigest() for name in told}
    assert found == told
    assert {name for name in recorded if "/" in name} == told.keys()
