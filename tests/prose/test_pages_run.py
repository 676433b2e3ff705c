"""The blocks of code of all pages run as they are written, or say why not."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
RUNNER = Path(__file__).with_name("page_runner.py")
spec = importlib.util.spec_from_file_location("page_runner", RUNNER)
runner = importlib.util.module_from_spec(spec)
spec.loader.exec_module(runner)

QUICK = (
    *("README.md", "docs/labels.md", "docs/lanes.md", "docs/camera/events.md"),
    "docs/tutorials/sensor.md",
)
"""Those that take a few seconds; the others are tried before a release."""
PAGES = [
    pytest.param(
        page, id=name, marks=[] if name in QUICK else [pytest.mark.slow, pytest.mark.thorough]
    )
    for page in runner.pages()
    for name in [page.relative_to(ROOT).as_posix()]
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
    for name in ("examples", "tools"):  # pages are read in a checkout
        (tmp_path / name).symlink_to(ROOT / name)
    done = run(page, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_block_is_run_or_says_why_not():
    known = re.compile(r"((not run|interrupted): \w.{6,}|file: [\w.]+|test command|)")
    wrong, found = [], 0
    for page in (*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")):
        fences = re.findall(r"^ *```(?:sh|bash|python|console)\b", page.read_text(), re.MULTILINE)
        blocks = [each for each in runner.blocks(page) if each.language != "json"]
        blocks = [each for each in blocks if not each.hidden]
        assert len(fences) == len(blocks), f"{page}: a block that the runner does not see"
        found += len(blocks)
        wrong += [
            f"{page}:{each.line}: {each.mark or each.language}"
            for each in blocks
            if not known.fullmatch(each.mark)
            or (each.language == "console" and not each.mark.startswith("not run: "))
        ]
    assert wrong == []
    assert found > 100


def test_what_fails_in_a_page_is_seen(tmp_path):
    blocks = (
        "```sh\nfalse\n```\n",
        "```python\n1 / 0\n```\n",
        "<!-- before sh\nfalse\n-->\n",
        "<!-- interrupted: it never ends -->\n```sh\neyas no-such-command\n```\n",
    )
    for number, block in enumerate(blocks):
        page = tmp_path / f"{number}.md"
        page.write_text(block)
        assert run(page, tmp_path).returncode != 0


def test_each_block_continues_those_above_it(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "<!-- file: one.py -->\n```python\nONE = 1\n```\n"
        "<!-- before sh\nexport TWO=1\n-->\n"
        "```sh\nexport TWO=$((TWO + 1))\n```\n"
        "<!-- not run: it fails -->\n```sh\nfalse\n```\n"
        "<!-- before python\nfour = 4\n-->\n"
        "```python\nimport one, os\nthree = one.ONE + int(os.environ['TWO'])\n```\n"
        "```python\nassert three == four - 1\nprint('reached')\n```\n"
    )
    done = run(page, tmp_path)
    assert done.returncode == 0, done.stderr
    assert "reached" in done.stdout


def test_what_is_not_run_is_listed():
    done = subprocess.run([sys.executable, RUNNER], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = done.stdout.splitlines()
    assert all(re.match(r"[\w./-]+\.md:\d+: (not run|interrupted): ", row) for row in rows)
    assert any(row.startswith("docs/ros.md:") for row in rows)
