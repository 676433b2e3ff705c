"""The engine works with every other house but `lanes` and `maps` deleted from a copy."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import eyas

pytestmark = pytest.mark.slow

SOURCE = Path(eyas.__file__).parent
KEPT = ("__init__.py", "__main__.py", "lanes", "engine", "maps")
FLIGHT = """
import json, sys
import eyas
env = eyas.make("citystreet-day")
env.reset(seed=3)
rewards = [float(env.step(1)[1]) for _ in range(4)]
env.close()
print(json.dumps([eyas.__file__, rewards]))
"""
SHORT = {
    "video": {"fps": 20, "total_time": 0.1, "channels": 1, "writers": ["jpeg", "labels"]},
    "camera": {"width": 64, "height": 48},
}


MISSED = {
    "policy": (
        "eyas.record({'video': {'policy': 'follow'}}, 'policy')",
        "ConfigError video.policy: 'follow': no house here brings policies",
    ),
    "device": (
        "eyas.make_vec('citystreet-day', 2, device='cuda').reset(seed=1)",
        "UnknownNameError device: 'cuda' is not allowed; known: none",
    ),
    "keys": (
        "eyas.load_settings(None, ['Simulation_Mode=Video_Mode'])",
        "ConfigError --set Simulation_Mode: the keys of another program, and no house here "
        "reads them",
    ),
    "section": (
        "eyas.load_settings(None, ['mavlink.port=1'])",
        "ConfigError mavlink: unknown key; known: seed, target,",
    ),
    "format": (
        f"eyas.export(eyas.record({SHORT}, 'exported'), 'coco')",
        "UnknownNameError --format: 'coco' is not allowed; known: none, or "
        "package.module:attribute",
    ),
    "preset": (
        "eyas.make_config('paper')",
        "UnknownNameError preset: 'paper' is not allowed; known: ",
    ),
    "name": (
        "eyas.evaluate('follow')",
        "AttributeError eyas.evaluate is not here: it is of the house eyas.benchmark",
    ),
}
"""What other houses bring: a statement, and how the line begins that it raises."""
TELLS = """
import json, sys
import eyas

told = {}
for name, statement in json.loads(sys.argv[1]).items():
    try:
        exec(statement)
    except Exception as error:
        told[name] = f"{type(error).__name__} {error}"
print(json.dumps(told))
"""


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Return what runs a program, or a module, with the copy in an empty folder."""
    folder = tmp_path_factory.mktemp("alone")
    for name in KEPT:
        place = SOURCE / name
        if place.is_dir():
            shutil.copytree(
                place, folder / "eyas" / name, ignore=shutil.ignore_patterns("__pycache__")
            )
        else:
            (folder / "eyas").mkdir(exist_ok=True)
            shutil.copy(place, folder / "eyas" / name)

    def run(*arguments):
        return subprocess.run(
            [sys.executable, *arguments],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(folder)},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


@pytest.fixture(scope="module")
def told(alone):
    """What each of `MISSED` raises, its class and its lines, all in one process."""
    statements = {name: statement for name, (statement, _) in MISSED.items()}
    done = alone("-c", TELLS, json.dumps(statements))
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_it_flies_as_it_does_among_the_others(alone):
    done = alone("-c", FLIGHT)
    assert done.returncode == 0, done.stderr
    file, rewards = json.loads(done.stdout.splitlines()[-1])
    assert not Path(file).is_relative_to(SOURCE.parent)
    env = eyas.make("citystreet-day")
    env.reset(seed=3)
    assert rewards == [float(env.step(1)[1]) for _ in range(4)]
    env.close()


def test_it_records_frames_with_labels_and_reads_them(alone):
    done = alone(
        "-c",
        f"import eyas\nout = eyas.record({SHORT}, 'video')\n"
        "(episode,) = eyas.load(out)\n"
        "print(len(episode), episode[1].label['frame'], episode[1].picture().shape)",
    )
    assert done.returncode == 0, done.stderr
    frames, number, *shape = done.stdout.split()
    assert (int(frames) >= 2, number, " ".join(shape)) == (True, "1", "(48, 64, 3)")


@pytest.mark.parametrize("name", MISSED)
def test_what_another_house_brings_is_missed_in_one_line(told, name):
    (found,) = told[name].splitlines()
    assert found.startswith(MISSED[name][1])


def test_the_command_line_is_missed_in_one_line(alone):
    done = alone("-m", "eyas", "doctor")
    assert done.returncode == 1
    assert done.stderr == "eyas: error: the command line is not here (eyas.cli)\n"
