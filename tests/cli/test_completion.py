"""Shells complete commands, options and names by the scripts of `eyas completion`."""

import os
import pty
import shutil
import subprocess
import sys

import pytest
import typer.main

from eyas.benchmark.policies.shipped import shipped_names
from eyas.benchmark.policies.table import POLICIES as BUILT_IN
from eyas.cli.app import app
from eyas.cli.completion import CommandShell, script
from eyas.engine.terminal.options import POLICIES

BASH = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _eyas; echo "${COMPREPLY[@]}"
"""

FISH = 'source $argv[1]; complete -C "$argv[2..-1]" | string split -f 1 \\t'

WORDS = [
    (["eyas", "vi"], {"video"}),
    (["eyas", "maps", "sh"], {"show"}),
    (["eyas", "video", "--pol"], {"--policy"}),
    (["eyas", "video", "--seed", "3", "--res"], {"--resume"}),
    (["eyas", "video", "--map", "vil"], {"village", "village-bare"}),
    (["eyas", "evaluate", "--policy", "road"], {"road-graph"}),
    (["eyas", "cache", "clear", "--k"], {"--kind"}),
    (["eyas", "video", "--out", "x", "maps"], set()),
    (["eyas", "maps", "export", "--li"], set()),  # `eyas export` has --link
    (["eyas", "leaderboard", "verify", "--s"], {"--seed", "--share"}),
]
IDS = [" ".join(words) for words, _ in WORDS]


def _script(shell, folder):
    path = folder / f"eyas.{shell}"
    path.write_text(script(shell, typer.main.get_command(app)))
    return path


def _program(shell):
    program = shutil.which(shell)
    if program is None:
        pytest.skip(f"{shell} is not installed")
    return program


@pytest.fixture(scope="module")
def bash(tmp_path_factory):
    return _script(CommandShell.BASH, tmp_path_factory.mktemp("completion"))


@pytest.fixture(scope="module")
def fish(tmp_path_factory):
    return _script(CommandShell.FISH, tmp_path_factory.mktemp("completion"))


@pytest.mark.parametrize(("words", "told"), WORDS, ids=IDS)
def test_bash_completes(bash, words, told):
    done = subprocess.run(
        ["bash", "-c", BASH, "bash", bash, *words], capture_output=True, text=True, check=True
    )
    assert set(done.stdout.split()) == told


@pytest.mark.parametrize(("words", "told"), WORDS, ids=IDS)
def test_fish_completes(fish, words, told, tmp_path):
    done = subprocess.run(
        [_program("fish"), "--no-config", "-c", FISH, fish, *words],
        capture_output=True,
        text=True,
        check=False,  # what `string split` found
        cwd=tmp_path,
        env={"HOME": str(tmp_path), "PATH": os.environ["PATH"]},
    )
    assert not done.stderr
    assert set(done.stdout.split()) == told


def test_zsh_completes(tmp_path):
    """A shell with a terminal: what is typed with a tab runs a function that tells its words."""
    path = _script(CommandShell.ZSH, tmp_path)
    typed = [(words[1:], told) for words, told in WORDS if len(told) == 1]
    lines = [f"source {path}", 'eyas() { print -r -- "<$*>" }']
    lines += [f"eyas {' '.join(words)}\t" for words, _ in typed]
    said = _typed([_program("zsh"), "-f", "-i"], [*lines, "exit"], tmp_path)
    for words, told in typed:
        assert f"<{' '.join([*words[:-1], *told])}>" in said


def _typed(command, lines, home):
    """Type lines into an interactive shell; return what its terminal shows."""
    ours, its = pty.openpty()
    shell = subprocess.Popen(
        command,
        stdin=its,
        stdout=its,
        stderr=its,
        env={"HOME": str(home), "PATH": os.environ["PATH"], "TERM": "dumb"},
        start_new_session=True,
    )
    os.close(its)
    os.write(ours, "".join(line + "\n" for line in lines).encode())
    shown = b""
    try:
        while part := os.read(ours, 4096):
            shown += part
    except OSError:
        pass  # Linux's word for a terminal that the shell has left
    shell.wait()
    os.close(ours)
    return shown.decode(errors="replace")


def test_help_names_all_policies():
    named = {name.split(" ")[0] for name in POLICIES.split(", ")}
    assert named == {*BUILT_IN.built_in, *shipped_names()}  # other tests add some of their own


def test_a_shell_that_is_opened_waits_for_no_simulation():
    code = (
        "import sys; from eyas.cli.main import main; sys.argv = ['eyas', 'completion', 'bash']\n"
        "try: main()\n"
        "except SystemExit as end: assert not end.code\n"
        "heavy = {'eyas.engine.sim.simulation', 'gymnasium', 'llvmlite', 'shapely'}\n"
        "print('loaded:', sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("loaded: []\n")
