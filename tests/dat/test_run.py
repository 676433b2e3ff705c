"""`eyas run` does what a file's mode says."""

import json
import socket
from types import SimpleNamespace

import pytest

from eyas.dat.wire.exchange import SETTINGS_FILE

SMALL = ["camera.width=32", "camera.height=24", "video.channels=1", "video.total_time=0.2"]


@pytest.fixture
def run(eyas_command):
    def done(folder, *words):
        done = eyas_command("run", *words, folder=folder)
        return done.returncode, done.stdout, done.stderr

    return done


def settings(path, mode, **others):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"Simulation_Mode": mode, **others}))
    return path


def test_video_records(run, tmp_path):
    file = settings(tmp_path / "env_config.json", "video")
    changes = [word for each in SMALL for word in ("--set", each)]
    code, _, said = run(tmp_path, "--config", file, *changes)
    assert code == 0, said
    assert "'eyas video'" in said
    assert (tmp_path / "runs/video/DRONE0/episode0/mark.json").exists()


def test_demo_shows_the_reward(run, tmp_path, monkeypatch):
    slept = [0.0]  # for the ten seconds of the original
    clock = SimpleNamespace(monotonic=lambda: sum(slept), sleep=slept.append)
    monkeypatch.setattr("eyas.demo.run.time", clock)
    file = settings(tmp_path / "env_config.json", "demo")
    code, out, _ = run(tmp_path, "--config", file, "--headless", "--set", "camera.width=32")
    assert code == 0
    assert "id: DRONE0" in out


def test_train_serves_the_folder_that_holds_the_file(run, tmp_path):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        file = settings(tmp_path / SETTINGS_FILE, "train", Config_Agen_Num_Port=port)
        code, _, said = run(tmp_path, "--config", file)
    assert code == 2
    assert "'eyas serve'" in said
    assert f"cannot listen on UDP port {port}" in said


def test_train_elsewhere_asks_for_the_folder(run, tmp_path):
    file = settings(tmp_path / "mine.json", "train")
    code, _, said = run(tmp_path, "--config", file)
    assert code == 2
    assert said.startswith("eyas: error: ")
    assert "give the folder with --root" in said
