"""The blocks of code of the first pages and of the tutorials run as they are written."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
RUNNER = Path(__file__).with_name("page_runner.py")
FIRST = [ROOT / "README.md", ROOT / "docs/start.md"]
TUTORIALS = sorted([*ROOT.glob("docs/tutorials/*.md"), *ROOT.glob("docs/zh/*.md")])
QUICK = ("sensor.md",)
"""Those that take a few seconds; the others are tried before a release."""
PAGES = [
    pytest.param(
        page,
        id=page.relative_to(ROOT).as_posix(),
        marks=[] if page.name in QUICK else [pytest.mark.thorough],
    )
    for page in (*FIRST, *TUTORIALS)
]


def run(page, folder, **more):
    programs = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    return subprocess.run(
        [sys.executable, RUNNER, page],
        cwd=folder,
        env={**os.environ, "PATH": programs, **more},
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("page", PAGES)
def test_the_code_of_a_page_runs_as_it_is_written(page, tmp_path):
    done = run(page, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_what_fails_in_a_page_is_seen(tmp_path):
    for number, block in enumerate(("```sh\nfalse\n```\n", "```python\n1 / 0\n```\n")):
        page = tmp_path / f"{number}.md"
        page.write_text(block)
        assert run(page, tmp_path).returncode != 0


def test_each_block_continues_those_above_it(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "<!-- file: one.py -->\n```python\nONE = 1\n```\n"
        "```sh\nexport TWO=2\n```\n"
        "<!-- not run: it fails -->\n```sh\nfalse\n```\n"
        "```python\nimport one, os\nthree = one.ONE + int(os.environ['TWO'])\n```\n"
        "```python\nassert three == 3\nprint('reached')\n```\n"
    )
    done = run(page, tmp_path)
    assert done.returncode == 0, done.stderr
    assert "reached" in done.stdout
