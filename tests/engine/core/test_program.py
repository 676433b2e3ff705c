"""What identifies what Eyas makes: nothing too much, nothing too little."""

import functools
import json
import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import eyas
from eyas.engine.core.identity import build as builds
from eyas.engine.core.identity.build import WORLD, this_build
from eyas.engine.core.identity.program import UnknownCodeError, closure_of, code_of, definitions_in
from eyas.lanes import jit

pytestmark = pytest.mark.slow  # what its tests share takes long to make

PACKAGE = Path(eyas.__file__).parent

SILENT = [
    ("engine/task/reward.py", '"""', '"""Says the same. '),
    ("engine/task/reward.py", "\nfrom", "\n# a comment\nfrom"),
    ("engine/render/bake/ambient.py", "\n_LOWEST = 1.5", "\n# Tuned.\n_LOWEST = 1.5"),
    ("engine/world/weather.py", "\nimport", "\n# light\nimport"),
    ("engine/world/maps/recipe.py", "is not allowed; allowed: words", "is wrong; allowed: words"),
    ("engine/targets/vehicles/rig.py", '"""', '"""Other words: '),
    ("engine/render/kernels/surface/shade.py", "SHARP = f4(0.004)", "# a why\nSHARP = f4(0.004)"),
    ("cli/main.py", '"""', '"""Another text. '),
    ("cli/app.py", "import typer", "import typer as typer"),
    ("engine/sim/README.md", "", "What only people read.\n"),
]
EDITS = {
    "silent": SILENT,
    "demo": [("demo/server.py", "\nfrom", "\nNEW = 1\nfrom")],
    "film": [("engine/video/folder.py", "\nfrom", "\nNEW = 1\nfrom")],
    "data": [("dat/settings/defaults.json", "1", "2")],
    "reward": [("engine/task/reward.py", "_FARTHEST = 1e12", "_FARTHEST = 1e11")],
    "ambient": [("engine/render/bake/ambient.py", "_LOWEST = 1.5", "_LOWEST = 15.0")],
    "texture": [("maps/textures/shipped.py", 'SHA256 = "', 'SHA256 = "0')],
    "cars": [("engine/targets/vehicles/rig.py", "np.sqrt(", "1.0 * np.sqrt(")],
    "shapes": [("engine/targets/shapes.py", 'SHA256 = "', 'SHA256 = "0')],
    "parked": [("maps/street/parked_cars.py", 'SHA256 = "', 'SHA256 = "0')],
    "sun": [
        ("engine/world/weather.py", "sun_colour=(1.56, 1.49, 1.32)", "sun_colour=(1.56, 0.1, 0.1)")
    ],
    "shading": [
        ("engine/render/kernels/surface/shade.py", "SHARP = f4(0.004)", "SHARP = f4(0.005)")
    ],
    "downtown": [("maps/downtown/plan.py", "_TAXIS = 0.2", "_TAXIS = 0.3")],
    "exact": [("lanes/exact.py", "def length(", "def length(unused=0, *,")],
    "kernels": [("lanes/elementary/__init__.py", "\nfrom", "\nNEW = 1\nfrom")],
    "recorder": [("engine/traffic/record.py", "WARM_UP = 60.0", "WARM_UP = 61.0")],
}
"""Edits by name, each of some files: (file, text, new text)."""


@pytest.fixture(scope="module")
def changed(tmp_path_factory):
    """Return what each edit of a copy of the package changes, by the name of the edit."""
    copy = tmp_path_factory.mktemp("copy") / "eyas"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__", "page"))
    program = Path(__file__).with_name("keys_after_edits.py")
    done = subprocess.run(
        [sys.executable, program, json.dumps(list(EDITS.values()))],
        env={**os.environ, "PYTHONPATH": str(copy.parent)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    first, *others = json.loads(done.stdout)
    return {
        name: {what for what in first if first[what] != now[what]}
        for name, now in zip(EDITS, others, strict=True)
    }


VEHICLES = {f"kind {name}" for name in ("passenger", "bus", "truck", "trailer", "motorcycle")}


@pytest.mark.parametrize(
    ("edit", "rooms", "things"),
    [
        ("silent", set(), set()),
        ("demo", set(), set()),
        ("film", {"engine/video"}, set()),
        ("data", {"dat"}, set()),
        ("reward", {"engine/task"}, set()),
        ("ambient", {"engine/render"}, {"ambient", "people"}),  # drones fly over what is high
        ("texture", {"maps"}, {"textures"}),
        ("cars", {"engine/targets"}, VEHICLES | {"people", "geometry"}),
        ("shapes", {"engine/targets"}, {"people", "geometry", "kind Quadrotor", "kind bird"}),
        ("parked", {"maps"}, {"citystreet", "downtown"}),
        ("sun", {"engine/world"}, set()),
        ("shading", {"engine/render"}, set()),
        ("downtown", {"maps"}, {"downtown"}),
        ("recorder", {"engine/traffic"}, {"recording"}),
    ],
)
def test_an_edit_changes_what_it_makes_and_nothing_else(changed, edit, rooms, things):
    told = {what for what in changed[edit] if what.startswith("room ")}
    assert told == {f"room {room}" for room in rooms}
    assert changed[edit] - told == things


def test_an_edit_of_the_language_of_kernels_changes_all_that_kernels_make(changed):
    kernels_make = {"geometry", "shadows", "ambient", "vehicles", "people", "sky"}
    assert changed["kernels"] >= kernels_make | {"room lanes"}


def test_an_edit_of_a_function_changes_what_calls_it_through_others(changed):
    assert changed["exact"] >= {"room lanes", "shadows", "citystreet"}
    assert not changed["exact"] & {"room engine/render", "recording", "textures"}


def names_in(text):
    found = definitions_in(textwrap.dedent(text).encode())
    return {name: said.digest for name, said in found.items()}


@pytest.mark.parametrize(
    "text",
    [
        'def f(x: float) -> int:\n    """Text."""\n    raise ValueError(f"{x}: wrong")\n',
        'def f(x):\n    raise ValueError("another text")  # a comment\n',
        'def f(x):\n    _LOG.info("x is %s", x)\n    raise ValueError\n',
    ],
)
def test_what_only_tells_something_is_no_part_of_a_definition(text):
    assert names_in(text)["f"] == names_in("def f(x):\n    raise ValueError()\n")["f"]


@pytest.mark.parametrize(
    "text",
    [
        "def f(x=1):\n    raise ValueError\n",
        "def f(y):\n    raise ValueError\n",
        "def f(x):\n    raise TypeError\n",
        "@cache\ndef f(x):\n    raise ValueError\n",
        "def f(x):\n    'text'.lower()\n    raise ValueError\n",
    ],
)
def test_what_does_something_is(text):
    assert names_in(text)["f"] != names_in("def f(x):\n    raise ValueError()\n")["f"]


def test_types_of_fields_are_part_of_a_class():
    first, second = ({**names_in(f"class A:\n    x: {kind}\n")} for kind in ("int", "float"))
    assert first != second


PARTS = {
    "__init__.py": "",
    "late.py": """
        def late():
            from parts_of_a_test.shapes import Ball
            return Ball().weight()
    """,
    "shapes.py": """
        from . import numbers
        class Base:
            def weight(self):
                return numbers.MASS
        class Ball(Base):
            pass
        UNUSED = 1
    """,
    "numbers.py": "MASS = 1.0\nOTHER = 2.0\n",
    "tables.py": """
        from .numbers import OTHER
        TABLE = {}
        def add(name, what):
            TABLE[name] = what
        def other():
            return OTHER
        add("other", other)
        def of_table(name):
            return TABLE[name]()
    """,
    "files/__init__.py": """
        from importlib import import_module
        def every(names):
            return [import_module(f"{__name__}.{name}").SIZE for name in names]
    """,
    "files/one.py": "SIZE = 1\n",
    "texts.py": """
        PLACES = {"late": "parts_of_a_test.late:late"}
        def by_name(name):
            return imported(PLACES[name])
    """,
    "foreign.py": """
        from eyas.lanes.exact import length
        from .numbers import OTHER
        def reach(at):
            return OTHER * length(at)
    """,
    "typed.py": """
        from typing import TYPE_CHECKING
        if TYPE_CHECKING:
            from .shapes import Ball
        def weigh(ball: "Ball | None"):
            return ball.weight()
    """,
}


@pytest.fixture
def parts(tmp_path, monkeypatch):
    """Return a package with each way in which one definition refers to another."""
    folder = tmp_path / "parts_of_a_test"
    folder.mkdir()
    for name, text in PARTS.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(textwrap.dedent(text))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "parts_of_a_test", raising=False)
    __import__("parts_of_a_test")
    return "parts_of_a_test"


MASS = {("shapes", "Base"), ("shapes", "Ball"), ("numbers", "MASS")}


@pytest.mark.parametrize(
    ("module", "name", "reached"),
    [
        ("late", "late", MASS | {("late", "late")}),
        ("files", "every", {("files", "every"), ("files.one", "SIZE")}),
        ("typed", "weigh", MASS | {("typed", "weigh")}),
        ("texts", "by_name", MASS | {("late", "late"), ("texts", "by_name"), ("texts", "PLACES")}),
        (
            *("tables", "of_table"),
            {("numbers", "OTHER"), *(("tables", n) for n in ("TABLE", "add", "other", "of_table"))},
        ),
    ],
)
def test_a_closure_holds_what_a_definition_refers_to(parts, module, name, reached):
    found = closure_of(f"{parts}.{module}", name)
    own = {(at.partition(".")[2], what) for at, what in found if at.startswith(parts)}
    assert own == reached


def test_a_closure_holds_code_of_a_foreign_package_and_of_eyas(parts):
    found = closure_of(f"{parts}.foreign", "reach")
    assert found >= {(f"{parts}.numbers", "OTHER"), ("eyas.lanes.exact", "length")}
    assert (parts, "") not in found


def test_kernels_stand_for_their_function_and_partials_for_theirs():
    def local(x):
        return x

    assert code_of(functools.partial(code_of, 1)) == code_of(code_of)
    assert code_of(local) == code_of(test_kernels_stand_for_their_function_and_partials_for_theirs)
    assert code_of(jit.kernel) != code_of(code_of)


def test_what_lies_nowhere_cannot_be_identified():
    with pytest.raises(UnknownCodeError, match="nowhere: its file is not found"):
        code_of(eval("lambda: 1", {"__name__": "nowhere"}))


def test_the_build_names_what_differs():
    build = this_build()
    assert build.difference(build, libraries=True) == ""
    other = build.model_copy(
        update={
            "rooms": build.rooms | {"engine/render": "0", "dat": "0", "new": "0"},
            "libraries": {"torch": "0.1"},
        }
    )
    assert build.difference(other) == "dat, engine/render, new"
    assert other.difference(build, without=("dat",)) == "engine/render, new"
    assert "torch" in build.difference(other, libraries=True)
    assert build.id != other.id
    assert build.world != other.world
    heard = build.model_copy(update={"rooms": build.rooms | {"dat": "0"}})
    assert (heard.id != build.id, heard.world != build.world) == (True, False)
    assert eyas.build_id == build.id
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = eyas.nothing


def test_what_makes_an_episode_are_rooms_of_the_build():
    assert this_build().rooms.keys() >= WORLD


STREET = {
    "engine/__init__.py": "ENGINE = 1",
    "engine/door.py": "RESULTS = True",
    "engine/sim/__init__.py": "",
    "engine/sim/deep/step.py": "STEP = 0.01",
    "engine/sim/table.json": "[1]",
    "engine/state/__init__.py": "",
    "maps/__init__.py": "",
    "maps/towns/plan.py": "TREES = 3",
}
"""A street of two houses."""


@pytest.fixture
def street(tmp_path, monkeypatch):
    """Return what makes the build of a street in which some files are others."""
    monkeypatch.setattr(builds, "_ROOT", tmp_path)

    def built(changes):
        for name, text in (STREET | changes).items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text)
        houses = {house: tmp_path / house for house in ("engine", "maps")}
        monkeypatch.setattr(builds, "houses_of_results", lambda: houses)
        return this_build.__wrapped__()

    return built


@pytest.mark.parametrize(
    ("file", "text", "differs"),
    [
        ("engine/sim/deep/step.py", "STEP = 0.01  # [s]", ""),
        ("engine/README.md", "A page.", ""),
        ("engine/sim/deep/step.py", "STEP = 0.02", "engine/sim"),
        ("engine/sim/table.json", "[2]", "engine/sim"),
        ("engine/state/new.py", "NEW = 1", "engine/state"),
        ("engine/door.py", "RESULTS = False", "engine"),
        ("maps/towns/plan.py", "TREES = 4", "maps"),
        ("demo/page.py", "PAGE = 2", ""),
    ],
)
def test_a_build_names_houses_and_rooms_of_the_engine(street, file, text, differs):
    before, after = street({}), street({file: text})
    assert [*before.rooms] == ["engine", "engine/sim", "engine/state", "maps"]
    assert before.difference(after) == differs
    assert (before.id == after.id) == (differs == "")


def test_a_house_without_part_in_a_matter_is_left_out_with_all_its_rooms(street):
    before, after = street({}), street({"engine/sim/table.json": "[2]"})
    assert before.id_without(("engine",)) == after.id_without(("engine",))
    assert before.difference(after, without=("engine",)) == ""
    assert before.id_without(("engine/state", "maps")) != after.id_without(("engine/state", "maps"))
