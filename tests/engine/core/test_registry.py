"""Tables of names: looked up, added to, and told in one line when a name is wrong."""

import sys
from dataclasses import dataclass
from importlib.metadata import EntryPoint

import pytest

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.registry import Registry


@dataclass(frozen=True)
class Fruit:
    name: str


APPLE = Fruit("apple")
BUILT_IN = {"apple": "orchard.trees:APPLE", "pear": "orchard.trees:PEAR"}
SOURCE = """
from dataclasses import dataclass
from {here} import Fruit
APPLE, PEAR, FIG = Fruit("apple"), Fruit("pear"), Fruit("fig")
"""


@pytest.fixture
def orchard(tmp_path, monkeypatch):
    """A package that is imported only when it is asked for."""
    monkeypatch.setitem(sys.modules, "fruits_of_the_test", sys.modules[__name__])
    (tmp_path / "orchard").mkdir()
    (tmp_path / "orchard" / "__init__.py").write_text("")
    source = SOURCE.format(here="fruits_of_the_test")
    (tmp_path / "orchard" / "trees.py").write_text(source)
    (tmp_path / "orchard" / "rotten.py").write_text("import a_module_that_is_nowhere")
    monkeypatch.syspath_prepend(tmp_path)
    yield
    for name in [name for name in sys.modules if name.split(".")[0] == "orchard"]:
        del sys.modules[name]


def fruits(**more) -> Registry[Fruit]:
    return Registry("meal.fruit", Fruit, BUILT_IN, **more)


def installed(monkeypatch, **points):
    """Let installed packages add names."""
    found = [EntryPoint(name, path, "eyas.fruits") for name, path in points.items()]
    monkeypatch.setattr("importlib.metadata.entry_points", lambda group: found)


def refusal(ask) -> str:
    with pytest.raises(ConfigError) as caught:
        ask()
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_nothing_is_imported_before_it_is_asked_for(orchard):
    table = fruits()
    assert table.names() == table.built_in == ("apple", "pear")
    assert "orchard.trees" not in sys.modules
    assert table.get("pear") == Fruit("pear")
    assert table.get("pear") is table.get("pear")


def test_a_users_own_needs_no_entry_anywhere(orchard):
    assert fruits().get("orchard.trees:FIG") == Fruit("fig")
    assert fruits().names() == ("apple", "pear")


def test_a_users_own_can_be_given_a_name(orchard):
    table = fruits()
    table.register("fig", "orchard.trees:FIG")
    table.register("mine", APPLE)
    assert (table.get("fig"), table.get("mine")) == (Fruit("fig"), APPLE)
    assert table.names() == ("apple", "pear", "fig", "mine")
    assert table.built_in == ("apple", "pear")


def test_whose_an_object_is_can_be_told_without_importing_it(orchard, monkeypatch):
    installed(monkeypatch, fig="orchard.trees:FIG")
    table = fruits(group="eyas.fruits")
    table.register("mine", "orchard.trees:FIG")
    asked = ("fig", "mine", "orchard.rotten:X", "apple", "plum")
    assert [table.path(name) for name in asked] == [
        *("orchard.trees:FIG", "orchard.trees:FIG", "orchard.rotten:X", None, None)
    ]
    assert "orchard.trees" not in sys.modules


def test_a_table_may_hold_objects_themselves():
    table = Registry("meal.fruit", Fruit, {"apple": APPLE})
    assert table.get("apple") is APPLE
    assert table.built_in == table.names() == ("apple",)


def test_an_unknown_name_is_told_with_the_nearest_and_all_known_ones():
    with pytest.raises(UnknownNameError) as caught:
        fruits().get("appel")
    assert str(caught.value) == (
        "meal.fruit: 'appel' is not allowed; did you mean 'apple'?; known: apple, pear, "
        "or package.module:attribute"
    )


@pytest.mark.parametrize("name", ["apple", "mine", "a:b", ""])
def test_a_name_is_given_once(name):
    table = fruits()
    table.register("mine", APPLE)
    table.register("mine", APPLE)  # the same again is no harm: a module may be run twice
    assert refusal(lambda: table.register(name, Fruit("other"))).startswith("meal.fruit: ")


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("orhcard.trees:FIG", "there is no module 'orhcard.trees'"),
        ("orchard.treees:FIG", "there is no module 'orchard.treees'"),
        ("orchard.trees:FIGS", "the module 'orchard.trees' has no 'FIGS'; did you mean 'FIG'"),
        ("orchard.trees:", "allowed: package.module:attribute"),
        (":FIG", "allowed: package.module:attribute"),
        ("orchard.trees:dataclass", "is a function, not a Fruit"),
    ],
)
def test_a_path_that_leads_nowhere_is_told_in_one_line(orchard, path, line):
    said = refusal(lambda: fruits().get(path))
    assert said.startswith(f"meal.fruit: '{path}'")
    assert line in said


def test_an_error_in_a_users_module_is_not_hidden(orchard):
    with pytest.raises(ModuleNotFoundError, match="a_module_that_is_nowhere"):
        fruits().get("orchard.rotten:FIG")


def test_installed_packages_add_names(orchard, monkeypatch):
    installed(monkeypatch, fig="orchard.trees:FIG")
    table = fruits(group="eyas.fruits")
    assert table.names() == ("apple", "pear", "fig")
    assert table.get("fig") == Fruit("fig")
    assert "fig" in refusal(lambda: table.get("figg"))
    assert fruits().names() == ("apple", "pear")  # no group, no packages


@pytest.mark.parametrize("name", ["apple", "mine"])
def test_a_package_cannot_take_a_name_that_is_taken(orchard, monkeypatch, name):
    installed(monkeypatch, **{name: "orchard.trees:FIG"})
    table = fruits(group="eyas.fruits")
    table.register("mine", APPLE)
    assert f"'orchard.trees:FIG' adds '{name}'" in refusal(table.names)
    assert table.get("apple") == APPLE  # names of the table itself do not suffer


def test_asking_for_a_known_name_does_not_look_through_installed_packages(orchard, monkeypatch):
    monkeypatch.setattr("importlib.metadata.entry_points", None)
    assert fruits(group="eyas.fruits").get("apple") == Fruit("apple")
