"""Holds each house, and `art`, to its budget: lines of its source and of its tests in
`tools/budgets.json`.

A house may grow by 3 % over the file. More needs a new line in the section "Growth" of
`CHANGELOG.md` that names the house and says why: `- engine: ...`. `--accept` writes today's
numbers, after which the next growth needs its own line. Seconds of tests are typed into the file,
from `pytest tests/<house> --durations=0` on two quiet cores; null is not measured. They are told,
not checked: a busy machine would fail them.
"""

import argparse
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
BUDGETS = "tools/budgets.json"

GROWTH = 0.03  # Share that needs no reason: about a week of small mending in a house of 5,000 lines

KINDS = {"lines": ("src/eyas", "lines"), "test_lines": ("tests", "lines of tests")}
"""Folder, and words for messages, of each number that is checked."""


def measured(root: Path) -> dict[str, dict[str, int]]:
    """Return the lines of each house, and how many reasons for growth the changelog has."""
    folders = sorted(path.parent for path in (root / KINDS["lines"][0]).glob("*/__init__.py"))
    folders += [art] if (art := root / "art").is_dir() else []
    reasons = growth_lines((root / "CHANGELOG.md").read_text(encoding="utf-8"))
    return {
        folder.name: {
            "lines": lines_below(folder),
            "test_lines": lines_below(root / KINDS["test_lines"][0] / folder.name),
            "reasons": reasons.count(folder.name),
        }
        for folder in folders
    }


def lines_below(folder: Path) -> int:
    """Return the number of lines of all Python files in a folder."""
    return sum(path.read_bytes().count(b"\n") for path in folder.rglob("*.py"))


def growth_lines(changelog: str) -> list[str]:
    """Return the houses that the sections "Growth" name, one for each line."""
    houses, inside = [], False
    for line in changelog.splitlines():
        if line.startswith("#"):
            inside = line.strip("# ") == "Growth"
        elif inside and (named := re.match(r"- `?(\w+)`?: \S", line)):
            houses.append(named[1])
    return houses


def problems(now: dict[str, dict[str, int]], budgets: dict[str, dict[str, int]]) -> list[str]:
    """Return one line for each budget that is exceeded without a reason."""
    found = [f"{house}: is no more; run with --accept" for house in sorted({*budgets} - {*now})]
    for house, numbers in now.items():
        budget = budgets.get(house)
        if budget is None:
            found.append(f"{house}: has no budget; run with --accept")
        elif numbers["reasons"] <= budget["reasons"]:
            found += [
                f"{house}: {numbers[kind]:,} {KINDS[kind][1]}, budget {budget[kind]:,} "
                f'and 3 %: make it smaller, or say why in CHANGELOG.md under "Growth"'
                for kind in KINDS
                if numbers[kind] > budget[kind] * (1.0 + GROWTH)
            ]
    return found


def main(arguments: list[str] | None = None, root: Path = ROOT) -> int:
    """Check the budgets, or accept today's numbers; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--accept", action="store_true", help="write today's numbers")
    options = parser.parse_args(arguments)
    now, file = measured(root), root / BUDGETS
    budgets = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    if options.accept:
        seconds = {house: budgets.get(house, {}).get("test_seconds") for house in now}
        rows = {
            house: {**numbers, "test_seconds": seconds[house]} for house, numbers in now.items()
        }
        lines = ",\n".join(
            f"  {json.dumps(house)}: {json.dumps(row)}" for house, row in rows.items()
        )
        file.write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")
        return 0
    found = problems(now, budgets)
    print("\n".join(found) if found else f"{len(now)} houses are within their budgets")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
