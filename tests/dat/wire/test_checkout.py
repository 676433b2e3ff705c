"""The commands of docs/coming-from-dat.md as typed, in a checkout of the original made anew."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from eyas.engine.settings.file import preset_file

HERE = Path(__file__).parent
PAGE = (HERE.parents[2] / "docs" / "coming-from-dat.md").read_text()
SHELL = next(
    block for block in re.findall(r"```sh\n(.*?)```", PAGE, re.S) if "webots-shim" in block
)
TRAINERS = [line for line in SHELL.splitlines() if line.startswith("python ")]
PREPARATION = [line for line in SHELL.splitlines() if not line.startswith("python ")]


@pytest.fixture
def checkout(tmp_path):
    """The folder above the checkout `DAT`."""
    algorithms = tmp_path / "DAT" / "Alg_Base" / "DAT_Benchmark"
    for name in ("A3CLSTM_E2E/main.py", "R_VAT/RVAT.py", "D_VAT/DVAT_main.py"):
        (algorithms / "models" / name).parent.mkdir(parents=True)
        shutil.copy(HERE / "original_trainer.py", algorithms / "models" / name)
    (algorithms / "envs" / "communication").mkdir(parents=True)
    shutil.copy(HERE / "client.py", algorithms / "envs" / "communication")
    own = {"Benchmark": {"port_process": 1, "Control_Frequence": 125, "RewardParams": True}}
    (algorithms / "config.json").write_text(json.dumps(own))
    simulator = tmp_path / "DAT" / "Webots_Simulation" / "traffic_project"
    (simulator / "config").mkdir(parents=True)
    settings = json.loads(preset_file("dat-train").read_text())
    settings["Sumo_Params"]["fixed_seed"] = True  # nothing to record
    (simulator / "config" / "env_config.json").write_text(json.dumps(settings))
    (simulator / "Files2Alg").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    "line",
    [
        pytest.param(line, marks=[pytest.mark.slow] if number else [])
        for number, line in enumerate(TRAINERS)
    ],
)
def test_a_trainer_runs_as_the_page_says(checkout, line):
    script = "\n".join(["set -e", *PREPARATION, line])
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    said = checkout / "said.txt"
    with said.open("w") as stream:  # not a pipe: the server holds it open
        done = subprocess.run(
            ["sh", "-c", script],
            cwd=checkout,
            env={**os.environ, "HOME": str(checkout), "PATH": path},
            stdout=stream,
            stderr=stream,
        )
    server = re.search(r"until 'kill (\d+)'", said.read_text())
    os.kill(int(server[1]), signal.SIGTERM)
    assert done.returncode == 0
    assert "trained 4 in citystreet-day.wbt" in said.read_text()


def test_the_page_has_all_three_trainers():
    programs = ["A3CLSTM_E2E/main.py", "R_VAT/RVAT.py", "D_VAT/DVAT_main.py"]
    assert [line.split()[1] for line in TRAINERS] == [f"./models/{name}" for name in programs]


@pytest.mark.slow  # PyTorch
def test_what_asks_for_a_card_gets_this_processor(tmp_path):
    (block,) = [text for text in re.findall(r"```python\n(.*?)```", PAGE, re.S) if "cuda" in text]
    (tmp_path / "sitecustomize.py").write_text(block)
    code = (
        "import torch; here = torch.device('cuda'); assert isinstance(here, torch.device);"
        "layer = torch.nn.Linear(2, 1).to(here); print(here, layer(torch.zeros(1, 2)).device,"
        " torch.zeros(1, device=torch.device('cuda')).device, torch.device('cpu', 0))"
    )
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True)
    assert done.stdout.split() == [b"cpu", b"cpu", b"cpu", b"cpu:0"], done.stderr
