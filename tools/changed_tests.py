"""Prints which tests a change needs: those of the houses that it touches, and of the houses above.

    python tools/changed_tests.py origin/main     # two lines for $GITHUB_OUTPUT: tests=, prose=

A house is above another if the contracts of import-linter in pyproject.toml let it import that one,
itself or through others. What belongs to no house, such as pyproject.toml or tests/kit, needs all.
Without a commit to compare with, everything is printed.
"""

import subprocess
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[1]

ALL = "tests --ignore=tests/prose"

PROSE = "tests/prose"

_ART = "art"  # The folder of what draws the data that ships; what it makes is in houses

_PICTURES = (".jpg", ".png", ".svg", ".webp", ".mp4", ".ipynb")  # In docs, beside the pages


def imports() -> dict[str, set[str]]:
    """Return for each house those that it may import, as the contracts say."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    layers: list[set[str]] = []
    may: dict[str, set[str]] = {}
    for contract in contracts["contracts"]:
        if contract["type"] == "layers" and contract["containers"] == ["eyas"]:
            layers = [{name.strip() for name in layer.split("|")} for layer in contract["layers"]]
    for height, layer in enumerate(layers):
        for house in layer:
            may[house] = set().union(*layers[height + 1 :])
    for contract in contracts["contracts"]:
        if contract["type"] == "forbidden":
            for source in contract["source_modules"]:
                may[_house(source)] -= {_house(each) for each in contract["forbidden_modules"]}
    return may


def _house(module: str) -> str:
    return module.removeprefix("eyas.").partition(".")[0]


def above(house: str) -> set[str]:
    """Return a house and all that may import it, itself or through others."""
    may, found = imports(), {house}
    while more := {each for each, own in may.items() if own & found} - found:
        found |= more
    return found


def chosen(paths: Iterable[str]) -> tuple[str, str]:
    """Return what pytest runs for changed paths: tests of the code, and of the prose; "" for none.

    Args:
        paths: Relative to the root of the repository, with `/`.
    """
    houses: set[str] = set()
    code = prose = False
    for path in paths:
        top, *inside = path.split("/")
        pictured = top == "docs" and path.endswith(_PICTURES)
        if path.endswith(".md") or pictured or path.startswith(f"{PROSE}/"):
            prose = True
        elif path.startswith("src/eyas/") and len(inside) > 2:
            houses |= above(inside[1])
            code = prose = True  # pages are made of the code, and name it
        elif top == "tests" and len(inside) > 1 and inside[0] in {*imports(), _ART}:
            houses.add(inside[0])
        elif top == _ART:
            houses.add(_ART)
            prose = True
        else:
            return ALL, PROSE
    if code and "maps" in houses:  # it imports `engine` and `maps`
        houses.add(_ART)
    folders = [f"tests/{house}" for house in sorted(houses) if (ROOT / "tests" / house).is_dir()]
    if code:  # what holds for all houses: public names, heads, readers that are fed anything
        folders += ["tests/hostile", *_of_all_houses()]
    return " ".join(folders), PROSE if prose else ""


def _of_all_houses() -> list[str]:
    return sorted(f"tests/{path.name}" for path in (ROOT / "tests").glob("test_*.py"))


def main() -> None:
    """Print the choice for the changes since a commit."""
    tests, prose = ALL, PROSE
    if len(sys.argv) > 1 and sys.argv[1]:
        told = ["git", "diff", "--name-only", "--no-renames", f"{sys.argv[1]}...HEAD"]
        done = subprocess.run(told, cwd=ROOT, capture_output=True, text=True, check=True)
        tests, prose = chosen(done.stdout.splitlines())
    print(f"tests={tests}\nprose={prose}")


if __name__ == "__main__":
    main()
