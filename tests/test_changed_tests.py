"""Which tests a change needs, see `tools/changed_tests.py`."""

import runpy
from pathlib import Path

import pytest

TOOL = runpy.run_path(str(Path(__file__).parents[1] / "tools/changed_tests.py"))


def folders(*paths) -> set[str]:
    tests, _ = TOOL["chosen"](paths)
    return {name.removeprefix("tests/") for name in tests.split() if not name.endswith(".py")}


@pytest.mark.parametrize(
    ("path", "run"),
    [
        ("src/eyas/robotics/loop.py", {"robotics", "cli"}),
        ("src/eyas/benchmark/api.py", {"benchmark", "learning", "datasets", "demo", "cli"}),
        ("src/eyas/maps/osm/file.py", {"maps", "dat", "cli", "art"}),
        ("src/eyas/cli/app.py", {"cli"}),
    ],
)
def test_a_change_in_a_house_runs_its_tests_and_those_of_houses_above(path, run):
    assert folders(path) == {*run, "hostile"}


def test_a_change_below_all_runs_all_houses():
    assert set(TOOL["imports"]()) - {"__main__"} <= folders("src/eyas/lanes/exact.py")


def test_what_draws_the_data_has_tests_of_its_own():
    assert TOOL["chosen"](["art/cars/body.py", "tests/art/test_bodies.py"]) == (
        "tests/art",
        TOOL["PROSE"],
    )


def test_tests_of_a_house_are_its_own_business():
    assert TOOL["chosen"](["tests/maps/test_osm.py"]) == ("tests/maps", "")


@pytest.mark.parametrize(
    "path", ["pyproject.toml", "tests/kit/frames.py", "tests/conftest.py", "src/eyas/__init__.py"]
)
def test_what_belongs_to_no_house_runs_everything(path):
    assert TOOL["chosen"]([path, "docs/start.md"]) == (TOOL["ALL"], TOOL["PROSE"])


def test_pages_run_the_tests_of_prose_only():
    changed = ["docs/start.md", "docs/images/targets.jpg", "src/eyas/maps/README.md"]
    changed += ["tests/prose/test_links.py"]
    assert TOOL["chosen"](changed) == ("", TOOL["PROSE"])


def test_golden_pictures_are_no_pages():
    assert TOOL["chosen"](["tests/engine/render/golden/day.png"]) == ("tests/engine", "")


def test_code_runs_the_tests_of_prose_too_since_pages_are_made_of_it():
    assert TOOL["chosen"](["src/eyas/cli/app.py"])[1] == TOOL["PROSE"]
