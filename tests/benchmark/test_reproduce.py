"""`eyas reproduce`."""

import json
from pathlib import Path

import pytest

from eyas.benchmark.plan.plan import EvaluationPlan, check
from eyas.benchmark.policies.shipped import shipped_names
from eyas.benchmark.report.reproduce import run as reproduce
from eyas.benchmark.report.reproduce import tables
from eyas.benchmark.report.reproduce.run import _rows_of, made, markdown, run
from eyas.benchmark.report.reproduce.tables import (
    TABLES,
    Expected,
    Row,
    Table,
    expected,
    flown_of,
    flown_with,
)
from eyas.engine.core.errors import UnknownNameError

DOCS = Path(__file__).parents[2] / "docs"

SMALL = Table(
    "small",
    "evaluation.md",
    "Two that see nothing",
    ("cr", "tsr"),
    (
        Row("`hover`", EvaluationPlan(policy="hover", episodes=2)),
        Row("`follow`", EvaluationPlan(policy="follow", episodes=2)),
    ),
)


@pytest.fixture
def small(monkeypatch):
    """The small table among the others; yields what sets its figures in the documents."""
    monkeypatch.setattr(tables, "TABLES", {"small": SMALL})
    said = {}

    def of(name):
        return said.get(name)

    monkeypatch.setattr(reproduce, "expected", of)
    return said


def test_a_table_that_is_equal_says_so(small, tmp_path, capsys):
    small["small"] = made(SMALL, tmp_path / "made", quiet=True)
    assert run(("small",), tmp_path / "again", quiet=True)
    said = capsys.readouterr().out
    assert "| `hover` | 8 |" in said
    assert "small: equal to the documents, every printed digit" in said


@pytest.mark.slow
def test_rows_of_two_starts_are_one_evaluation(tmp_path):
    plan = EvaluationPlan(policy="hover", protocol="flown", episodes=1, seeds=(60_000_000,))
    rows = tuple(Row(f"`hover`, {part}", plan, part) for part in ("at-speed", "at-rest"))
    found = made(Table("starts", "none.md", "Starts", ("tsr",), rows), tmp_path, quiet=True)
    assert [row.n for row in found.rows] == [4, 4]
    assert found.rows[0].cells["tsr"] < found.rows[1].cells["tsr"]  # 0.1 and 0.2
    assert [path.name for path in tmp_path.iterdir()] == ["hover"]


def test_a_digit_that_differs_is_named_with_the_build_that_made_it(small, tmp_path, capsys):
    right = made(SMALL, tmp_path / "made", quiet=True)
    forged = json.loads(right.model_dump_json())
    forged["rows"][1]["cells"]["tsr"] = "0.999 [0.9, 1.0]"
    forged |= {"build_id": "0123456789ab", "world": "no such one"}
    small["small"] = Expected.model_validate(forged)
    assert not run(("small",), tmp_path / "made", quiet=True)  # continues: nothing is flown again
    said = capsys.readouterr().out
    assert "small: `follow`, tsr: 1.000" in said
    assert "here, 0.999 [0.9, 1.0] in the documents" in said
    assert "another world" in said
    assert "build 0123456789ab" in said


def test_an_unknown_table_is_refused_with_the_nearest_name(tmp_path):
    with pytest.raises(UnknownNameError, match="did you mean 'baselines'"):
        run(("baseline",), tmp_path)


@pytest.mark.parametrize("name", TABLES)
def test_a_table_that_other_networks_or_protocols_have_flown_is_marked(name):
    said = expected(name)
    assert said is not None
    today = said.flown_with == flown_with(TABLES[name])
    assert ("Flown before a change of" in markdown(TABLES[name], said)) != today


def test_a_row_or_a_part_of_the_episodes_is_flown_and_compared(small, tmp_path, capsys):
    small["small"] = made(SMALL, tmp_path / "made", quiet=True)
    capsys.readouterr()
    assert run(("small",), tmp_path / "row", row="follow", quiet=True)
    assert [path.name for path in (tmp_path / "row" / "small").iterdir()] == ["follow"]
    run(("small",), tmp_path / "part", share=0.5, quiet=True)
    assert "means of the documents lie in the intervals" in capsys.readouterr().out
    with pytest.raises(UnknownNameError, match="--row"):
        run(("small",), tmp_path, row="nothing")


@pytest.mark.parametrize(
    ("table", "asked", "labels"),
    [
        ("standard", "fast downtown", ["`fast`, downtown by day"]),
        ("targets", "eyas, citystreet", []),
        ("targets", "eyas-flown late", ["`eyas-flown`, citystreet, 40 ms late"]),
        ("unseen", "eyas", ["`eyas`"]),
        ("evade", "hov", ["`hover`"]),
        ("evade", "`", ["`hover`", "`sighted`", "`constant-velocity`", "`eyas`"]),
    ],
)
def test_rows_are_named_by_words_of_their_labels(table, asked, labels):
    assert [row.label for row in _rows_of(TABLES[table], asked)] == labels


@pytest.mark.slow
@pytest.mark.parametrize(
    ("policy", "table"),
    [
        ("fast", "standard"),
        ("eyas", "standard"),
        ("eyas-flown", "targets"),
        # It listens for two minutes; tests/benchmark/test_referring.py has it fly for less.
        pytest.param("eyas-words", "referring-weathers", marks=pytest.mark.thorough),
    ],
)
def test_a_policy_repeats_a_row_of_its_card(policy, table, tmp_path):
    """Other processors may choose another action where two are as good to the last bit."""
    row, one, _ = flown_of(policy)[table][0]
    small = Table(table, "none.md", "One row", TABLES[table].columns, (row,))
    (found,) = made(small, tmp_path, quiet=True).rows
    assert found.n == one.n
    means = [tuple(float(cell.split()[0]) for cell in each.cells.values()) for each in (found, one)]
    assert means[0] == pytest.approx(means[1], rel=0.03, abs=0.08)


@pytest.mark.parametrize("name", TABLES)
def test_the_documents_hold_the_tables_as_they_are_expected(name):
    table, said = TABLES[name], expected(name)
    assert said is not None, "python tools/write_tables.py"
    assert [row.label for row in said.rows] == [row.label for row in table.rows]
    assert [row.n for row in said.rows] == [row.episodes for row in table.rows]
    assert markdown(table, said) in (DOCS / table.page).read_text()


def test_every_row_can_be_flown():
    for table in TABLES.values():
        for row in table.rows:
            check(row.plan)


@pytest.mark.parametrize("name", shipped_names())
def test_a_policy_has_a_model_card_with_what_a_reader_needs(name):
    card = (DOCS / "policies" / f"{name}.md").read_text()
    for chapter in (
        "Intended use",
        "Trained on",
        "What it reaches",
        "Limits",
        "Other possible uses",
    ):
        assert chapter in card
    assert "SHA-256 `" in card
    seen = check(EvaluationPlan(policy=name)).entry_class
    assert f"| class of entry | `{seen}` |" in card
    assert card.count("\n- ") >= 3
