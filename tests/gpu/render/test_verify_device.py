"""`tools/verify_device.py` finds what differs, and needs no card to emulate one."""

import importlib.util
import json
import sys
from pathlib import Path

import pytest

from eyas.gpu.cuda import CudaError

TOOL = Path(__file__).parents[3] / "tools" / "verify_device.py"
ASKED = ["--emulate", "--views", "2", "--maps", "village", "--weathers", "day"]


@pytest.fixture
def run(monkeypatch, capsys):
    monkeypatch.syspath_prepend(TOOL.parent)
    spec = importlib.util.spec_from_file_location("verify_device", TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["verify_device", *arguments])
        code = tool.main()
        return code, capsys.readouterr()

    run.tool = tool
    return run


@pytest.mark.slow  # compiles environments for devices
def test_emulated_pictures_and_environments_are_equal(run):
    code, said = run(*ASKED)
    assert code == 0, said.out
    assert "village day: equal (2 of 2 with checksums" in said.out
    assert "observations, rewards and ends equal" in said.out


def test_a_cards_own_code_is_run(run, emulated):
    code, said = run("--ptx", *ASKED[1:])
    assert code == 0, said.out
    assert "village day: equal (2 of 2 with checksums" in said.out
    assert "environments: 4, 10 steps: observations, rewards and ends equal" in said.out


def test_without_a_compiler_there_is_one_line(run, monkeypatch):
    monkeypatch.setenv("PATH", "")
    code, said = run("--ptx")
    assert (code, said.out) == (2, "")
    assert said.err == "verify_device: --ptx needs a C compiler, cc\n"


def test_another_checksum_is_told(run, monkeypatch, tmp_path):
    document = json.loads(run.tool.CHECKSUMS.read_text())
    document["checksums"]["village day"]["facts"][1] += 1
    monkeypatch.setattr(run.tool, "CHECKSUMS", tmp_path / "sums.json")
    run.tool.CHECKSUMS.write_text(json.dumps(document))
    monkeypatch.setattr(run.tool, "_states", lambda *_: 0)
    code, said = run(*ASKED)
    assert code == 1
    assert "DIFFERENT: facts of this processor in 1 of the checksums, which are of" in said.out


def test_another_picture_is_told(run, monkeypatch):
    class Dimmed(run.tool.ReadBackRenderer):
        def draw(self, views, draw_list, picture, samples=1):
            super().draw(views, draw_list, picture, samples)
            if picture.rgb is not None and samples == 4:
                picture.rgb[1, 5, 7, 2] ^= 1

    monkeypatch.setattr(run.tool, "ReadBackRenderer", Dimmed)
    monkeypatch.setattr(run.tool, "_states", lambda *_: 0)
    code, said = run(*ASKED)
    assert code == 1
    assert "rgb 4 in 1 of 2 pictures by device 0" in said.out
    assert "rgb 2" not in said.out


def test_without_a_card_there_is_one_line(run, monkeypatch):
    def none():
        raise CudaError("there is no graphics processor of NVIDIA")

    monkeypatch.setattr(run.tool, "cuda_device", none)
    code, said = run()
    assert (code, said.out) == (2, "")
    assert said.err.startswith("verify_device: no card: there is no graphics processor of NVIDIA; ")
    assert said.err.count("\n") == 1
