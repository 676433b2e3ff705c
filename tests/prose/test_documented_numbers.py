"""Numbers that the documentation tells of the code are those of the code."""

import re
from pathlib import Path

import numpy as np
import pytest

from eyas import ATTRIBUTES
from eyas.engine.sim.scenes import load_scene
from eyas.engine.targets.catalogue import KINDS, VEHICLE_KINDS, habit_of, kind_index
from eyas.engine.targets.config import TargetName
from eyas.engine.world.maps import MAPS
from eyas.maps.commands.info import figures_of

ROOT = Path(__file__).parents[2]


def text(page):
    return (ROOT / page).read_text()


def rows(page, heading):
    """Return the cells of the first table below a heading, without its two head rows."""
    below = f"\n{text(page)}".split(f"\n{heading}\n", 1)[1]
    table = re.search(r"(?:^\|.*\n)+", below, re.MULTILINE).group()
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()[2:]]


def number(cell):
    return float(re.match(r"[\d.,]+", cell).group().replace(",", ""))


FIGURES = {row[0]: row for row in rows("docs/maps/README.md", "## Figures")}


@pytest.mark.parametrize("name", [name for name in FIGURES if name != "simpleway"])
def test_the_figures_of_maps_are_those_that_eyas_tells(name):
    _, streets, between, _, buildings, _, height, _, trees, _ = FIGURES[name]
    figures = figures_of(load_scene(name))
    assert number(streets) == pytest.approx(figures.road, abs=0.006)
    assert number(between) == pytest.approx(figures.between, abs=0.006)
    assert int(number(buildings)) == figures.buildings
    assert int(number(trees)) == figures.trees
    if height:
        assert number(height) == pytest.approx(figures.height, abs=0.51)


def test_all_maps_that_come_with_eyas_have_their_figures():
    ours = {name.partition("-")[0] if "simpleway" in name else name for name in MAPS.built_in}
    assert set(FIGURES) == ours


def test_sizes_and_speeds_of_targets_are_those_of_the_catalogue():
    page = rows("docs/targets.md", "# Targets")
    told = {row[0].strip("`"): row for row in page if row[0].count("`") == 2}
    assert set(told) == {name.value for name in TargetName} - {"SUMO_VEHICLE"}
    for name, (_, models, size, motion) in told.items():
        kind = KINDS[kind_index(name)]
        sizes = np.array([model.size for model in kind.models])
        named = [float(side) for side in size.split(" x ")]
        # People are not all alike: the page tells about how large they are.
        allowed = 0.1 if len(sizes) > 1 else 0.06
        assert named == pytest.approx(np.median(sizes, axis=0).tolist(), rel=allowed, abs=0.1)
        if len(sizes) > 1:
            assert int(number(models)) == len(sizes)
        speed = re.search(r"([\d.]+) m/s", motion)
        assert float(speed.group(1)) == pytest.approx(habit_of(name).speed)
    vehicles = next(row for row in page if "passenger" in row[0])
    assert int(number(vehicles[1])) == sum(len(kind.models) for kind in VEHICLE_KINDS)


def test_the_machine_code_that_ships_is_as_large_as_told():
    shipped = ROOT / "src/eyas/lanes/shipped"
    libraries = list(shipped.glob("*.so"))
    assert len(libraries) == 3
    for library in libraries:
        told = re.search(rf"{library.name}` \| ([\d,]+) kB", text("docs/lanes.md"))
        size = float(told[1].replace(",", ""))
        assert size == pytest.approx(library.stat().st_size / 1000.0, rel=0.1)


def test_the_attributes_of_words_are_as_many_as_told():
    bodies = sum(name.startswith("body_") for name in ATTRIBUTES)
    words = text("docs/words.md")
    assert f"`eyas.ATTRIBUTES` names {len(ATTRIBUTES)} numbers" in words
    assert f"`body_robot` ({bodies})" in words
    assert f"`other_body_...` ({bodies})" in words
    for page in ("docs/words.md", "docs/evaluation.md"):
        assert set(re.findall(r"N x (\d\d)\b", text(page))) == {str(len(ATTRIBUTES))}
