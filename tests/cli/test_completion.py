"""Shells complete commands, options and names by the scripts of `eyas completion`."""

import shutil
import subprocess

import pytest
import typer.main

import eyas
from eyas.cli.app import app
from eyas.cli.completion import Shell, script
from eyas.cli.options import POLICIES

ASK = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _eyas; echo "${COMPREPLY[@]}"
"""


@pytest.fixture(scope="module")
def bash(tmp_path_factory):
    path = tmp_path_factory.mktemp("completion") / "eyas.bash"
    path.write_text(script(Shell.BASH, typer.main.get_command(app)))
    return path


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["eyas", "vi"], {"video"}),
        (["eyas", "maps", "sh"], {"show"}),
        (["eyas", "video", "--pol"], {"--policy"}),
        (["eyas", "video", "--seed", "3", "--re"], {"--resume"}),
        (["eyas", "video", "--map", "vil"], {"village", "village-bare"}),
        (["eyas", "evaluate", "--policy", "road"], {"road-graph"}),
        (["eyas", "cache", "clear", "--k"], {"--kind"}),
        (["eyas", "video", "--out", "x", "maps"], set()),
    ],
    ids=" ".join,
)
def test_bash_completes(bash, words, told):
    done = subprocess.run(
        ["bash", "-c", ASK, "bash", bash, *words], capture_output=True, text=True, check=True
    )
    assert set(done.stdout.split()) == told


@pytest.mark.parametrize("shell", [Shell.ZSH, Shell.FISH])
def test_other_shells_read_their_script(shell, tmp_path):
    text = script(shell, typer.main.get_command(app))
    assert "webots-shim" in text
    program = shutil.which(shell)
    if program is None:
        return  # the text is all that can be looked at here
    path = tmp_path / "script"
    path.write_text(text)
    subprocess.run([program, "-n", path], check=True)


def test_help_names_all_policies():
    named = {name.split(" ")[0] for name in POLICIES.split(", ")}
    assert named == set(eyas.list_policies())
