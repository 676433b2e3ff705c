"""`eyas doctor` tells what is here, in lines and in JSON."""

import json
import platform
import sys

import numpy as np
import pytest

from eyas.cli import doctor
from eyas.cli.main import main
from eyas.gpu.cuda import gpu_line
from eyas.lanes import shipped

V3 = shipped.LEVELS["x86_64"]


def told(monkeypatch, capsys, *options):
    monkeypatch.setattr(sys, "argv", ["eyas", "doctor", *options])
    with pytest.raises(SystemExit) as caught:
        main()
    said = capsys.readouterr()
    assert (caught.value.code or 0, said.err) == (0, "")
    return said.out


def test_json_and_lines_tell_the_same(monkeypatch, capsys):
    found = json.loads(told(monkeypatch, capsys, "--json"))
    lines = told(monkeypatch, capsys).splitlines()
    assert [line.split(":", 1)[1].strip() for line in lines] == list(found.values())
    assert platform.python_version() in found["Python"]
    assert f"numpy {np.__version__}" in found["packages"]
    assert found["graphics card"] == gpu_line()
    assert found["a picture"] == "drawn, 320x240 pixels"


def test_an_extra_that_is_not_whole_is_named_with_what_it_lacks(monkeypatch):
    here = doctor._version
    gone = {"osmium", "pygame", "pygame-ce"}
    monkeypatch.setattr(doctor, "_version", lambda name: "missing" if name in gone else here(name))
    assert "osm lacks osmium" in doctor.facts()["extras"]
    assert "play lacks pygame" in doctor.facts()["extras"]
    assert "dev lacks" not in doctor.facts()["extras"]


def test_what_an_extra_needs_under_another_python_is_not_lacking(monkeypatch):
    minor = sys.version_info[1]
    lines = [
        f'no-{number}; python_version {sign} "3.{number}" and extra == "play"'
        for number in (minor, minor + 1)
        for sign in ("<", ">=")
    ]
    lines[0], lines[3] = lines[0].replace("no", "other"), lines[3].replace("no", "other")
    monkeypatch.setattr(doctor, "requires", lambda _: lines)
    assert doctor.facts()["extras"] == f"play lacks no-{minor}, no-{minor + 1}"


def test_the_cache_and_who_has_moved_it(monkeypatch, tmp_path):
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path))
    assert doctor.facts()["cache"] == f"{tmp_path} (by EYAS_CACHE_DIR)"
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path / "file"))
    assert "; compiled kernels are not kept: " in doctor.facts()["cache"]


def test_why_shipped_kernels_do_not_serve(monkeypatch, tmp_path):
    for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", shipped.VARIABLE):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(shipped, "features", lambda: V3.needs - {"avx2"})
    assert "lacks avx2: kernels are compiled" in doctor.facts()["shipped kernels"]
    monkeypatch.setattr(shipped, "features", lambda: V3.needs)
    monkeypatch.setattr(platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(shipped.sys, "platform", "linux")
    monkeypatch.setattr(shipped, "FOLDER", tmp_path)
    assert "damaged or missing" in doctor.facts()["shipped kernels"]
    monkeypatch.setenv("EYAS_SHIPPED_CODE", "0")
    assert doctor.facts()["shipped kernels"].startswith("not used, by EYAS_SHIPPED_CODE=0")
    monkeypatch.setattr(doctor, "find_spec", lambda name: None)
    assert "cannot be compiled without: pip install 'eyas[" in doctor.facts()["shipped kernels"]
