"""Training programs that start `webots` themselves, and change its settings before."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from eyas.dat.serve.stand_in import install, serve_arguments
from eyas.engine.core.errors import EyasError, OutputError

from .conftest import PATIENCE, client, free_port

TRAINER = Path(__file__).with_name("trainer.py")
SETTINGS = Path("Webots_Simulation", "traffic_project", "config", "env_config.json")
SMALL = ("camera.width=64", "camera.height=48")


@pytest.fixture
def dat(tmp_path):
    """The original's folder, with settings that are not those of the training."""
    root = tmp_path / "DAT bench"  # with a space
    (root / SETTINGS).parent.mkdir(parents=True)
    (root / SETTINGS).write_text(json.dumps({"Tracker_Def": "DRONE", "Config_Agen_Num_Port": 9}))
    return root


def trained(dat, tmp_path, world, agents):
    """Run a trainer with our `webots` in its PATH; return its code, and where all is that was said
    by it and what it has started."""
    path = tmp_path / "said.txt"
    environment = {**os.environ, "PATH": f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"}
    words = [sys.executable, str(TRAINER), str(dat), world, str(agents), "3"]
    with path.open("w") as said:
        done = subprocess.run(words, stdout=said, stderr=said, env=environment)
    return done.returncode, path


def ended(said):
    """End the server by the id that it has told; return all that was said."""
    os.kill(int(re.search(r"until 'kill (\d+)'", said.read_text())[1]), signal.SIGTERM)
    end = time.monotonic() + PATIENCE
    while "terminated" not in said.read_text():
        assert time.monotonic() < end
        time.sleep(0.05)
    return said.read_text()


def test_a_trainer_that_starts_webots_itself_runs_unchanged(dat, tmp_path):
    install(tmp_path / "bin", None, SMALL)
    code, said = trained(dat, tmp_path, "traffic_project/worlds/simpleway-grass_day.wbt", 2)
    text = ended(said)
    assert code == 0, text
    assert "trained" in text
    assert "--map simpleway-grass --weather day" in text
    assert "serving DRONE0 to DRONE1" in text
    assert f"UDP port {text.splitlines()[0]} " in text  # as written just before
    assert text.rstrip().endswith("terminated; clients that still wait must be started again")
    assert "Traceback" not in text


def test_agents_that_announce_themselves_at_once_are_served_and_it_ends_when_they_have(
    dat, tmp_path
):
    program, port = install(tmp_path / "bin", None, SMALL, until_idle=1.0), free_port()
    (dat / SETTINGS).write_text(f'{{"Config_Agen_Num_Port": {port}, // drawn\n "Verbose": false}}')
    (dat / client.FILES).mkdir()
    world = dat / "Webots_Simulation" / "worlds" / "simpleway-lake.wbt"
    with subprocess.Popen([program, world], stderr=subprocess.PIPE, text=True) as shim:
        while not _heard(port):
            assert shim.poll() is None
        client.Client(dat, 0, patience=PATIENCE).reset()
        _, told = shim.communicate()
    assert shim.returncode == 0, told
    assert "--map simpleway-lake --weather day" in told
    assert told.rstrip().endswith("no client for 1 s: ended")


def _heard(port):
    """Announce an agent; return whether anyone listens."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.connect(("127.0.0.1", port))
        out.send(b"1")
        out.settimeout(0.02)
        try:
            out.recv(1)
        except ConnectionRefusedError:
            return False
        except TimeoutError:
            return True


def test_it_listens_before_anything_heavy_is_imported(dat):
    code = (
        "import sys; from eyas.dat.shim import _listen_early as listen;"
        "from eyas.dat.wire import announcements; listen(sys.argv[1:]);"
        "print(len(announcements._early), *{'numpy', 'pydantic', 'typer'} & sys.modules.keys())"
    )
    for words in (["--root", dat, "--"], ["--", dat / "Webots_Simulation" / "lake-day.wbt"]):
        command = [sys.executable, "-c", code, *map(str, words)]
        (dat / SETTINGS).write_text(json.dumps({"Config_Agen_Num_Port": free_port()}))
        done = subprocess.run(command, capture_output=True, text=True)
        assert (done.stdout, done.stderr) == ("1\n", "")


@pytest.mark.slow
def test_a_server_that_was_there_before_follows_the_trainer_s_settings(dat, tmp_path):
    """The documented order, with nothing named `webots` that could start."""
    command = [sys.executable, "-m", "eyas.cli.main", "serve", "--root", str(dat)]
    words = [word for override in SMALL for word in ("--set", override)]
    told = tmp_path / "server.txt"
    settings = json.loads((dat / SETTINGS).read_text())
    settings["Config_Agen_Num_Port"] = free_port()
    (dat / SETTINGS).write_text(json.dumps(settings))
    with told.open("w") as file:
        server = subprocess.Popen([*command, *words, "--map", "simpleway-grass"], stderr=file)
    try:
        while "waiting for clients" not in told.read_text():
            assert server.poll() is None, told.read_text()
            time.sleep(0.05)
        code, said = trained(dat, tmp_path, "worlds/simpleway-grass_day.wbt", 1)
    finally:
        server.send_signal(signal.SIGINT)
        assert server.wait(PATIENCE) == 130
    text, said = told.read_text(), said.read_text()
    assert code == 0, (said, text)
    port = next(line for line in said.splitlines() if line.isdigit())
    assert f"now waiting for clients on UDP port {port}" in text
    assert f"Config_Agen_Num_Port is {port} (was " in text
    assert "Reward_Config.view_range is 0.55 (was " in text


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--mode=fast", "worlds/lake-foggy.wbt"], "lake foggy"),
        (["/abs/x/village-snow.wbt", "--stdout"], "village snow"),
        (["worlds/simpleway-clinker_foggy.wbt"], "simpleway-clinker foggy"),
        (["-m", "simpleway-grass.wbt"], "simpleway-grass day"),
        (["a\\b\\desert-day.wbt"], "desert day"),
    ],
)
def test_map_and_weather_are_those_of_the_world_file(tmp_path, words, told):
    (tmp_path / "Webots_Simulation" / "traffic_project").mkdir(parents=True)
    folder = tmp_path / "Webots_Simulation" / "traffic_project"
    root, _, name, _, weather = serve_arguments(words, folder)[1:]
    assert (root, f"{name} {weather}") == (str(tmp_path), told)


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        ([], "no argument is not allowed"),
        (["--batch"], "--batch is not allowed"),
        (["worlds/la.wbt"], "names no map and weather"),
        (["worlds/lake-day.wbt"], "no folder above it holds 'Webots_Simulation'"),
    ],
)
def test_what_cannot_be_served_is_one_line(tmp_path, words, problem):
    with pytest.raises(EyasError, match=problem):
        serve_arguments(words, tmp_path)


def test_the_program_answers_its_version_and_tells_mistakes(tmp_path):
    program = install(tmp_path / "b i n", None, ())
    done = subprocess.run([program, "--version"], capture_output=True, text=True)
    assert (done.returncode, done.stdout[:5]) == (0, "eyas ")
    done = subprocess.run([program, "x.wbt"], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("eyas: error: webots (Eyas): ")
    assert len(done.stderr.splitlines()) == 1


def test_another_program_named_webots_is_never_replaced(tmp_path):
    (tmp_path / "webots").write_text("#!/bin/sh\n")
    with pytest.raises(OutputError, match="another program is there"):
        install(tmp_path, None, ())
    (tmp_path / "webots").unlink()
    install(tmp_path, None, ())
    again = install(tmp_path, tmp_path, ("seed=3",))  # ours is
    assert "seed=3" in again.read_text()
    assert os.access(again, os.X_OK)
