"""The doors of the houses: what each folder of `eyas` brings to the engine, by name.

A house that brings something has a module `door.py` with one record, `HOUSE`. Doors are found by
looking into the folder of the package, so that the engine works where a house is not there, and
never imports one: a door names modules, and they are imported when somebody asks for what is in
them. Packages of others bring the same by entry points, in a group of the same name.
"""

import pkgutil
import sys
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import MappingProxyType
from typing import Any, Final, NamedTuple

STREET: Final = (
    "lanes",
    "engine",
    "maps",
    "gpu",
    "benchmark",
    "datasets",
    "learning",
    "robotics",
    "dat",
    "demo",
    "cli",
)
"""Houses in the order in which what they bring is listed: bytes of messages, of files of settings
(their sections) and of lists of maps depend on it."""


class House(NamedTuple):
    """A house."""

    results: bool  # True if a change of it can change a result: it is part of the build's id
    brings: Mapping[str, Mapping[str, str]] = MappingProxyType({})
    # by group: `package.module:attribute` by name, in the order in which they are listed


@cache
def houses() -> dict[str, House]:
    """Return the houses that are there, by name, in the order of the street."""
    found = {each.name for each in pkgutil.iter_modules(sys.modules["eyas"].__path__) if each.ispkg}
    ordered = [*(name for name in STREET if name in found), *sorted(found - {*STREET})]
    return {name: _house(name) for name in ordered}


def _house(name: str) -> House:
    if find_spec(f"eyas.{name}.door") is None:  # `lanes`, which imports nothing of Eyas
        return House(results=True)
    house: House = import_module(f"eyas.{name}.door").HOUSE
    return house


@cache
def brought(group: str) -> dict[str, str]:
    """Return what the houses bring to a group, by name: `package.module:attribute`."""
    return {
        name: place
        for house in houses().values()
        for name, place in house.brings.get(group, {}).items()
    }


@cache
def installed(group: str) -> dict[str, str]:
    """Return what packages of others bring to a group by entry points, as `brought` does."""
    from importlib.metadata import entry_points  # 0.04 s to import, and rarely needed

    return {point.name: point.value for point in entry_points(group=group)}


def brought_object(group: str, name: str) -> Any:  # noqa: ANN401  # each group has its own kind
    """Return the object that a house or a package brings to a group under a name; None if there is
    none.
    """
    place = brought(group).get(name) or installed(group).get(name)
    if place is None:
        return None
    module, _, attribute = place.partition(":")
    return getattr(import_module(module), attribute)


def first_brought(group: str) -> Any:  # noqa: ANN401  # each group has its own kind
    """Return the one object of a group that has room for one; None if no house brings it."""
    return next((brought_object(group, name) for name in brought(group)), None)
