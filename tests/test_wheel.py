"""The built wheel, alone: all that Eyas needs is in it."""

import json
import os
import re
import subprocess
import sys
import venv
import zipfile
import zlib
from email import message_from_string
from importlib.metadata import distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from eyas.engine.core.identity.definitions import INDEX as DEFINITIONS
from eyas.lanes.container import unpacked
from eyas.lanes.shipped import misfit
from eyas.lanes.syntax import INDEX as SYNTAX
from eyas.lanes.text_index import digest_of

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"

pytestmark = pytest.mark.slow

# Everything is imported, and the data that the package brings is read.
PROGRAM = """
import importlib, pkgutil, sys
import eyas
names = [module.name for module in pkgutil.walk_packages(eyas.__path__, "eyas.")]
from eyas.engine.core.errors import MissingExtraError
LEARNS, COMPILES = "eyas.learning.", ("eyas.lanes.", "eyas.gpu.ptx")
ROOMS = {"torch": LEARNS, "onnx": LEARNS, "numba": COMPILES, "llvmlite": COMPILES}
for name in names:
    try:
        file = str(importlib.import_module(name).__file__)
    except MissingExtraError:
        continue
    except ModuleNotFoundError as error:  # what only learns or compiles is an extra as a whole
        assert name.startswith(ROOMS[error.name.partition(".")[0]]), name
        continue
    assert file.startswith(sys.prefix), file
from eyas.engine.sim.scenes import load_network
from eyas.engine.traffic.library import RESPAWN_GROUPS
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.maps import MAPS
for name in MAPS.built_in:
    assert len(load_network(name, 0).lane_points) > 100
    recordings = MAPS.get(name).shipped_traffic()
    assert len(recordings) >= 1 + len(RESPAWN_GROUPS)
    assert load(recordings[-1]).actors > 10
print(len(names))
"""


def done(*command: object, folder: Path) -> str:
    """Run a command that finds nothing of the source tree, and return what it prints."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    ended = subprocess.run(
        [*map(str, command)], cwd=folder, env=environment, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    done(sys.executable, "-m", "pip", "wheel", ROOT, "--no-deps", "-w", folder, folder=folder)
    (path,) = folder.glob("eyas-*.whl")
    return path


def asked_for(metadata: str) -> set[str]:
    """Names of the packages that metadata ask for without extras, and of those that these need."""
    wanted, found = [metadata], set()
    while wanted:
        for text in message_from_string(wanted.pop()).get_all("Requires-Dist") or ():
            need = Requirement(text)
            name = canonicalize_name(need.name)
            if name not in found and (need.marker is None or need.marker.evaluate({"extra": ""})):
                found.add(name)
                wanted.append(distribution(name).read_text("METADATA"))
    return found


@pytest.fixture(scope="module")
def programs(wheel) -> Path:
    """The folder of programs of a virtual environment with the wheel and what it asks for, which is
    linked to what runs the tests: it has been downloaded, and compiled.
    """
    path = wheel.parent / "venv"
    venv.create(path)
    (site,) = path.glob("lib/python*/site-packages")
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith("/METADATA"))
        metadata = archive.read(name).decode()
    for needed in asked_for(metadata):
        files = distribution(needed).files
        for top in {file.parts[0] for file in files} - {"..", "__pycache__"}:
            (site / top).symlink_to(distribution(needed).locate_file(top))
    pip = (sys.executable, "-m", "pip", "--python", path / "bin/python")
    done(*pip, "install", "-q", "--no-index", "--no-deps", wheel, folder=wheel.parent)
    return path / "bin"


def test_the_wheel_has_every_file_of_the_package_and_no_other(wheel):
    sources = {
        path.relative_to(SOURCE).as_posix()
        for path in SOURCE.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert {Path(name).name for name in sources} >= {"network.npz", "traffic.npz", "defaults.json"}
    with zipfile.ZipFile(wheel) as archive:
        packed = {file.filename: file.CRC for file in archive.infolist() if not file.is_dir()}
    indexes = {name for name in packed if name.endswith(".eyi")}
    assert indexes == {"eyas/engine/core/identity/definitions.eyi", "eyas/lanes/syntax.eyi"}
    assert {name for name in packed.keys() - indexes if ".dist-info/" not in name} == sources
    assert any(name.endswith("/LICENSE") for name in packed.keys() - sources)
    for name in sources:
        assert packed[name] == zlib.crc32((SOURCE / name).read_bytes()), name


def test_the_wheel_brings_what_a_clone_makes(wheel):
    texts = [path.read_bytes() for path in SOURCE.rglob("*.py")]
    with zipfile.ZipFile(wheel) as archive:
        for index in (DEFINITIONS, SYNTAX):
            name = index.shipped.relative_to(SOURCE).as_posix()
            own = texts if index is DEFINITIONS else [text for text in texts if b"kernel" in text]
            (maker, digests), told = unpacked(archive.read(name))
            assert maker == index._name
            # Those of a clone are known from the cache; to read all again takes seconds.
            assert dict(zip(digests, map(zlib.decompress, told), strict=True)) == {
                digest_of(text): index.json_of(text) for text in own
            }, name


def test_from_the_wheel_nothing_is_read_from_texts(programs, tmp_path):
    program = """
from eyas.engine.core.identity.build import this_build
from eyas.engine.core.identity.definitions import INDEX as DEFINITIONS
from eyas.engine.core.identity.program import code_of
from eyas.lanes.identity import identity
from eyas.lanes.syntax import INDEX as SYNTAX
from eyas.engine.render.kernels.draw import draw_views
from eyas.engine.sim import scenes
for index in (DEFINITIONS, SYNTAX):
    index._read = None
print(this_build().world, code_of(scenes._packed), identity(draw_views.function))
"""
    here = done(
        sys.executable, "-c", program.replace("index._read = None", "pass"), folder=tmp_path
    )
    assert done(programs / "python", "-I", "-c", program, folder=tmp_path) == here


def test_the_wheel_is_no_larger_than_a_release_may_be(wheel):
    limit = re.search(r"^LARGEST_WHEEL = (.+)$", (ROOT / "tools/release.py").read_text(), re.M)
    assert wheel.stat().st_size <= float(limit[1])


def test_pypi_gets_addresses_and_a_readme_without_relative_links(wheel):
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith("/METADATA"))
        metadata = archive.read(name).decode()
    repository = re.search(r"^Project-URL: Repository, (.+)$", metadata, re.M)[1]
    links = re.findall(r"\]\(([^)\s]+)\)", metadata)
    assert len(links) == len(re.findall(r"\]\(", (ROOT / "README.md").read_text()))
    assert all(link.startswith("https://") for link in links), links
    assert f"![A drone follows a car through traffic]({repository}/raw/" in metadata
    for path in ("CITATION.cff", ".github/ISSUE_TEMPLATE/config.yml"):
        assert repository in (ROOT / path).read_text(), path


def test_every_module_and_the_data_of_every_map_load_from_the_wheel_alone(programs, tmp_path):
    modules = [path for path in (SOURCE / "eyas").rglob("*.py") if path.name != "__init__.py"]
    assert int(done(programs / "python", "-I", "-c", PROGRAM, folder=tmp_path)) >= len(modules)


def test_the_command_of_the_wheel_reads_settings_in_both_notations(programs, tmp_path):
    show = (programs / "eyas", "config", "show")
    legacy = tmp_path / "env_config.json"
    legacy.write_text(done(*show, "--legacy", "--set", "video.fps=9", folder=tmp_path))
    again = done(*show, "--config", legacy, folder=tmp_path)
    assert json.loads(again)["video"]["fps"] == 9
    assert "citystreet" in done(programs / "eyas", "maps", "list", folder=tmp_path)


DRAWS = """
import hashlib, sys
import numpy as np
import eyas
envs = eyas.make_vec("citystreet-day", num_envs=2)
digest = hashlib.sha256()
for observations in (envs.reset(seed=1)[0], envs.step(np.ones(2, int))[0]):
    digest.update(np.ascontiguousarray(observations).tobytes())
print(digest.hexdigest(), sorted({"numba", "llvmlite"} & sys.modules.keys()))
"""


@pytest.mark.skipif(bool(misfit()), reason="no machine code ships for this machine")
def test_without_a_compiler_the_same_pictures_are_drawn(programs, tmp_path):
    drawn = done(programs / "python", "-I", "-c", DRAWS, folder=tmp_path)
    assert drawn.endswith(" []\n")
    assert drawn == done(sys.executable, "-c", DRAWS, folder=tmp_path)


def test_what_would_have_to_be_compiled_ends_in_a_line_that_names_the_extra(programs, tmp_path):
    video = (programs / "eyas", "video", "--out", "out", "--set", "video.total_time=0.1")
    ended = subprocess.run(
        video,
        cwd=tmp_path,
        env=os.environ | {"EYAS_SHIPPED_CODE": "0"},
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 2
    line = ended.stderr.splitlines()[-1]
    assert line.startswith("eyas: error: ")
    assert line.endswith(
        ": no machine code (what ships is not used, by EYAS_SHIPPED_CODE=0); "
        "to compile it: pip install 'eyas[compile]'"
    )
