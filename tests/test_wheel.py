"""The built wheel, alone: all that Eyas needs is in it."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"

# Everything is imported, and the data that the package brings is read; nothing is drawn, as
# compiling the kernels anew takes a minute.
PROGRAM = """
import importlib, pkgutil, sys
sys.path.insert(0, sys.argv[1])
import eyas
names = [module.name for module in pkgutil.walk_packages(eyas.__path__, "eyas.")]
modules = [importlib.import_module(name) for name in names]
files = [str(module.__file__) for module in modules]
assert all(file.startswith(sys.argv[1]) for file in files), files
from eyas.sim.scenes import load_network
from eyas.traffic.recording_file import load
from eyas.world.maps import MAPS
from eyas.world.maps.recipe import TRAFFIC_FILE
for name in MAPS.built_in:
    assert len(load_network(name, 0).lane_points) > 100
    assert load(MAPS.get(name).shipped(TRAFFIC_FILE)).actors > 10
print(len(names))
"""
CLI = """
import sys
from importlib.metadata import distribution
sys.path.insert(0, sys.argv.pop(1))
(command,) = distribution("eyas").entry_points.select(group="console_scripts", name="eyas")
command.load()()
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", str(ROOT), "--no-deps", "-q", "-w", folder]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (path,) = folder.glob("eyas-*.whl")
    return path


@pytest.fixture(scope="module")
def unpacked(wheel) -> Path:
    path = wheel.parent / "unpacked"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(path)
    return path


def run(unpacked, program, *arguments) -> str:
    """Run in a folder of its own with nothing of the source tree on the path."""
    done = subprocess.run(
        [sys.executable, "-I", "-c", program, str(unpacked), *map(str, arguments)],
        cwd=unpacked.parent,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_wheel_has_every_file_of_the_package_and_no_other(unpacked):
    sources = {
        path.relative_to(SOURCE).as_posix()
        for path in SOURCE.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert {Path(name).name for name in sources} >= {"network.npz", "traffic.npz", "defaults.json"}
    files = {path.relative_to(unpacked).as_posix() for path in unpacked.rglob("*")}
    packed = {name for name in files if (unpacked / name).is_file()}
    assert {name for name in packed if ".dist-info/" not in name} == sources
    assert any(name.endswith("/LICENSE") for name in packed - sources)


def test_every_module_and_the_data_of_every_map_load_from_the_wheel(unpacked):
    modules = [path for path in (SOURCE / "eyas").rglob("*.py") if path.name != "__init__.py"]
    assert int(run(unpacked, PROGRAM)) >= len(modules)


def test_the_command_of_the_wheel_reads_settings_of_both_notations(unpacked, tmp_path):
    shown = run(unpacked, CLI, "config", "show", "--legacy", "--set", "video.fps=9")
    legacy = tmp_path / "env_config.json"
    legacy.write_text(shown)
    again = run(unpacked, CLI, "config", "show", "--config", legacy)
    assert json.loads(again)["video"]["fps"] == 9
    assert "citystreet" in run(unpacked, CLI, "maps", "list")
