"""Parts of the documents are made from the code; files and names of the code in them exist."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from eyas.engine.core.doors import houses

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])
SOURCES = sorted([*ROOT.glob("src/eyas/**/*.py"), *ROOT.glob("examples/*.py")])
NAMING = [
    ROOT / "CONTRIBUTING.md",
    ROOT / "docs/architecture.md",
    *sorted(ROOT.glob("docs/decisions/*.md")),
]
"""Pages that name files of the code."""
ELSEWHERE = {
    *(".venv/bin", "definitions/", "eyas/_src", "eyas.json", "eyas.onnx"),
    "eyas.steps",
    *("eyas.algorithms", "eyas.policies", "eyas.protocols", "eyas.sensors", "eyas.weathers"),
    *(group for house in houses().values() for group in house.brings),
}
"""What these texts name that is no file or name of the code: loggers, groups of entry points, what
another build has or a user makes."""


def test_made_documents_are_up_to_date():
    tool = ROOT / "tools/write_docs.py"
    done = subprocess.run([sys.executable, tool, "--check"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, ""), "run `python tools/write_docs.py`"


@pytest.mark.parametrize("page", NAMING, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_files_that_the_pages_name_exist(page):
    prose = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    code = re.findall(r"`([\w./-]+)`", prose)
    paths = {name for name in code if re.fullmatch(r"[\w./-]*\.py|[a-z_./-]+/[\w.-]*", name)}
    assert not {path for path in paths - ELSEWHERE if not _is_there(path)}


def test_names_of_eyas_that_texts_mention_exist():
    named = re.compile(r"`(eyas(?:\.[A-Za-z_]\w*)+)(?:\(\))?`")
    lost = [
        f"{file.relative_to(ROOT)}: {name}"
        for file in (*PAGES, *SOURCES)
        for name in set(named.findall(file.read_text())) - ELSEWHERE
        if not _is_known(name)
    ]
    assert not lost


INSIDE = {"architecture.md", "lanes.md", "stability.md", "reproducibility.md", "CONTRIBUTING.md"}
"""Pages for developers of Eyas, beside those of `docs/decisions` and of `docs/maps/plan.md`."""


def test_pages_for_users_name_public_things_only():
    rooms = "|".join(path.name for path in (ROOT / "src/eyas").iterdir() if path.is_dir())
    private = re.compile(rf"(?<!group `)\beyas\.(?:{rooms})\b")  # a group of entry points
    pages = [*PAGES, *ROOT.glob("docs/**/*.ipynb"), *ROOT.glob("examples/*.py")]
    found = {
        f"{page.relative_to(ROOT)}: {line.strip()}"
        for page in pages
        if page.name not in INSIDE and not {"decisions", "reference"} & set(page.parts)
        for line in page.read_text().splitlines()
        if private.search(line)
    }
    assert not {each for each in found if not each.startswith("docs/maps/plan.md")}


def _is_there(path):
    """Return whether a file or folder lies where its path says, or somewhere in the package."""
    roots = (ROOT, ROOT / "src", ROOT / "src/eyas", ROOT / "docs", ROOT / "tests")
    return any((root / path).exists() for root in roots) or any(ROOT.glob(f"src/eyas/**/{path}"))


def _is_known(name):
    """Return whether a name is a module of Eyas, or of something that its module mentions."""
    place, parts = ROOT / "src", name.split(".")
    for index, part in enumerate(parts):
        if (place / part).is_dir():
            place /= part
            continue
        module = place / f"{part}.py"
        rest = parts[index + 1 :]
        if not module.is_file():
            module, rest = place / "__init__.py", parts[index:]
        text = module.read_text()
        return all(re.search(rf"\b{each}\b", text) for each in rest[:1])
    return True
