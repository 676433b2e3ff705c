"""Budgets of the houses: what is measured, what is refused, and what a reason allows."""

import json
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TOOL = runpy.run_path(str(ROOT / "tools/check_budgets.py"))
CHANGELOG = "# Changelog\n\n## 1.0\n\n- engine: not a reason here\n\n### Growth\n\n- dat: a shim\n"


@pytest.fixture
def street(tmp_path):
    """A copy of a street of two houses of 100 lines, whose budgets are today's numbers."""
    for house in ("engine", "dat"):
        for place in ("src/eyas", "tests"):
            (tmp_path / place / house).mkdir(parents=True)
            (tmp_path / place / house / "code.py").write_text("x = 1\n" * 100)
        (tmp_path / "src/eyas" / house / "__init__.py").touch()
    (tmp_path / "tools").mkdir()
    (tmp_path / "CHANGELOG.md").write_text(CHANGELOG)
    assert TOOL["main"](["--accept"], tmp_path) == 0
    return tmp_path


def grown(street, place, lines):
    (street / place / "code.py").write_text("x = 1\n" * lines)
    return TOOL["main"]([], street)


def test_houses_within_three_per_cent_pass(street, capsys):
    assert grown(street, "src/eyas/engine", 103) == 0
    assert capsys.readouterr().out == "2 houses are within their budgets\n"


@pytest.mark.parametrize(
    ("place", "told"), [("src/eyas/engine", "104 lines"), ("tests/engine", "104 lines of tests")]
)
def test_more_is_refused_in_one_line_that_names_the_house(street, capsys, place, told):
    assert grown(street, place, 104) == 1
    (line,) = capsys.readouterr().out.splitlines()
    assert line.startswith(f"engine: {told}, budget 100")


def test_a_line_in_the_section_growth_allows_it_until_it_is_accepted(street):
    assert grown(street, "src/eyas/engine", 150) == 1
    (street / "CHANGELOG.md").write_text(CHANGELOG + "- engine: a sensor\n")
    assert TOOL["main"]([], street) == 0
    assert TOOL["main"](["--accept"], street) == 0
    assert grown(street, "src/eyas/engine", 200) == 1


def test_another_house_s_reason_does_not_count(street):
    (street / "CHANGELOG.md").write_text(CHANGELOG + "- dat: once more\n")
    assert grown(street, "src/eyas/engine", 150) == 1


def test_a_new_house_and_one_that_is_gone_are_told(street, capsys):
    (street / "src/eyas/dat").rename(street / "src/eyas/post")
    assert TOOL["main"]([], street) == 1
    assert [line.partition(":")[0] for line in capsys.readouterr().out.splitlines()] == [
        "dat",
        "post",
    ]


def test_typed_seconds_survive(street):
    file = street / "tools/budgets.json"
    budgets = json.loads(file.read_text())
    budgets["dat"]["test_seconds"] = 12
    file.write_text(json.dumps(budgets))
    TOOL["main"](["--accept"], street)
    assert json.loads(file.read_text())["dat"]["test_seconds"] == 12


def test_all_houses_have_a_budget():
    now, budgets = TOOL["measured"](ROOT), json.loads((ROOT / "tools/budgets.json").read_text())
    assert [*now] == [*budgets]
