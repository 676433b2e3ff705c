"""`eyas verify`: what is computed has the hashes of the manifest; what has not is named."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from eyas.cli.verify.cases import cases
from eyas.cli.verify.run import compared, read_manifest
from eyas.engine.core.identity.build import this_build
from eyas.engine.settings.preset import PRESETS
from eyas.engine.world.maps import MAPS

NEWER = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
OTHER = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F",
    "NPY_DISABLE_CPU_FEATURES": " ".join(NEWER),
    "OPENBLAS_CORETYPE": "Nehalem",
    "NUMBA_NUM_THREADS": "1",
}


EVERYWHERE = ("day", "foggy", "night", "snow")
"""Each other weather takes minutes to build on a map, and is looked at on one."""


def verify(*words, **more):
    command = [sys.executable, "-W", "ignore", "-m", "eyas", "verify", *words]
    return subprocess.run(
        command, env=os.environ | more, capture_output=True, text=True, check=False
    )


def test_every_map_in_every_weather_and_every_preset_is_in_the_manifest():
    known = read_manifest()
    assert known.keys() == {case.name for case in cases()}
    for name in MAPS.names():
        assert {"scene", "traffic", "people"} == known[name].keys()
        for weather in MAPS.get(name).weathers:
            if weather not in EVERYWHERE and name != "citystreet":
                assert f"{name} {weather}" not in known
                continue
            assert {"pictures", "labels", "rewards", "packets"} <= known[f"{name} {weather}"].keys()
    assert all(f"preset {name}" in known for name in PRESETS)
    assert "lidar files" in known["lidar"]


@pytest.mark.thorough  # `tools/ci_matrix.py` does the same, under another Python as well
def test_another_processor_computes_what_the_manifest_promises():
    run = verify("--quick", **OTHER)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "are those of the manifest" in run.stdout
    assert all(f"{name}={value}" in run.stdout for name, value in OTHER.items())


def test_what_differs_is_named():
    known = read_manifest()
    found = {name: dict(hashes) for name, hashes in known.items()}
    found["village day"]["labels"] = "0" * 16
    found["desert"].pop("people")
    found["lidar"]["smells"] = "1" * 16
    verdict = compared(found, known)
    assert verdict.different == {
        "village day": ["labels"], "desert": ["people"], "lidar": ["smells"],
    }  # fmt: skip
    assert verdict.same == sum(map(len, known.values())) - 2


def test_a_map_of_another_name_is_refused_in_one_line(eyas_command):
    run = eyas_command("verify", "--map", "vilage")
    assert run.returncode == 2
    assert "did you mean 'village'" in run.stderr
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.slow
def test_the_report_as_json_holds_all_hashes_and_the_machine(eyas_command):
    this_build()  # reads all sources for seconds, unless the cache knows them, which is empty then
    run = eyas_command("verify", "--map", "desert-bare", "--json")
    told = json.loads(run.stdout)
    assert told["hashes"].keys() == {c.name for c in cases() if c.map == "desert-bare"}
    assert {"machine", "packages", "libraries"} <= told["machine"].keys()
    assert (run.returncode == 0) == (told["different"] == {})
