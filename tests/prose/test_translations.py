"""The pages in Chinese are as new as those that they translate."""

import importlib
import shutil
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def translations():
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        return importlib.import_module("translations")
    finally:
        sys.path.pop(0)


def test_no_translation_is_stale(translations):
    assert translations.stale() == [], "read them, then `python tools/translations.py --done`"


def test_a_changed_page_names_its_translation(translations, tmp_path):
    for page in (translations.KNOWN, *translations.pairs(), *translations.pairs().values()):
        copy = tmp_path / page.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(page, copy)
    assert translations.stale(tmp_path) == []
    with (tmp_path / "docs/start.md").open("a") as page:
        page.write("\nOne more line.\n")
    (line,) = translations.stale(tmp_path)
    assert line.startswith("docs/zh/start.md: stale: docs/start.md has changed")


def test_a_table_that_a_tool_writes_leaves_its_translation_as_new(translations, tmp_path):
    test_a_changed_page_names_its_translation(translations, tmp_path)
    known = translations.stale(tmp_path)
    for name, cell in (("leaderboard", "| `fast` | pixels |"), ("evaluation", "| `hover` | 300 |")):
        page = tmp_path / f"docs/{name}.md"
        assert cell in page.read_text()
        page.write_text(page.read_text().replace(cell, "| `other` | 1 |"))
    assert translations.stale(tmp_path) == known


def test_a_command_that_differs_is_seen(translations, tmp_path):
    test_a_changed_page_names_its_translation(translations, tmp_path)
    page = tmp_path / "docs/zh/dat.md"
    page.write_text(page.read_text().replace("--preset dat-eval", "--preset easy"))
    assert "docs/zh/dat.md: has other commands than docs/tutorials/dat.md" in (
        translations.stale(tmp_path)
    )
