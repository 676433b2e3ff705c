"""Documents, docstrings, comments and messages are spelt correctly."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOOL = ROOT / "tools/spelling.py"


@pytest.fixture
def spelling():
    spec = importlib.util.spec_from_file_location("spelling", TOOL)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_no_word_is_misspelt():
    done = subprocess.run([sys.executable, TOOL], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "")


def test_mistakes_are_found_in_prose_and_not_in_code(spelling, tmp_path):
    texts = {
        "README.md": "A vehikle.\n\n```sh\nechoo\n```\n\n`anothr` [a link](http://plaace)\n",
        "src/one.py": '"""Yaw of the camra."""\n\nlenght = 1  # it is drwan\n',
        "tests/test_one.py": 'WRONG = "the first of the mistaks"  # a reasn\n',
    }
    for name, text in texts.items():
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(text)
    assert spelling.unknown_words(tmp_path) == {
        "vehikle": "README.md:1",
        "camra": "src/one.py:1",
        "drwan": "src/one.py:3",
        "reasn": "tests/test_one.py:1",
    }


def test_awkward_words_are_found_in_documents_that_people_write(spelling, tmp_path):
    texts = {
        "README.md": "It tells\nnobody; tell them apart, told apart, `told`.\n",
        "docs/one.md": "<!-- made by a tool -->\nIt is told.\n<!-- end -->\nThat which is none.\n",
        "docs/lab/trial.md": "We were told.\n",
        "CHANGELOG.md": "Besides, it was told.\n",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert list(spelling.unwanted(tmp_path)) == [
        "README.md:1: write it otherwise: tells",
        "README.md:2: write it otherwise: nobody",
        "docs/one.md:4: write it otherwise: That which",
        "docs/one.md:4: write it otherwise: is none",
    ]
