"""Tables of names for what can be chosen: maps, trackers, rewards, writers.

An object is found by its name in the table, or by its path `package.module:attribute`, so that a
user's own needs no entry anywhere. Nothing is imported before it is asked for.
"""

import sys
from collections.abc import Iterable, Mapping
from importlib import import_module
from importlib.util import find_spec
from typing import Generic, TypeVar

from eyas.core.errors import ConfigError, NotInThisVersionError, UnknownNameError, nearest

__all__ = ["Registry"]

T = TypeVar("T")


class Registry(Generic[T]):
    """Objects of one kind by name: those of Eyas, of installed packages, and a user's own.

    Attributes:
        built_in: Names of those that come with Eyas, in the order of the table.

    Args:
        setting: The setting that names one of them, for messages; for example `world.map`.
        kind: Class of the objects, or a protocol that can be checked at run time.
        built_in: Those that come with Eyas, each as `package.module:attribute`.
        group: Name of the entry points with which installed packages add theirs; None: they cannot.
        later: Names of what a later version will have; to ask for them is an error of its own.
    """

    def __init__(
        self,
        setting: str,
        kind: type[T],
        built_in: Mapping[str, str],
        *,
        group: str | None = None,
        later: Iterable[str] = (),
    ) -> None:
        self.built_in = tuple(built_in)
        self.later = tuple(later)
        self._setting, self._kind, self._group = setting, kind, group
        self._table: dict[str, T | str] = dict(built_in)
        self._loaded: dict[str, T] = {}

    def register(self, name: str, what: T | str) -> None:
        """Add an object under a name, for this process.

        Args:
            name: A name that is not taken, without a colon.
            what: The object, or its path `package.module:attribute`.

        Raises:
            ConfigError: The name is taken by something else, or is none.
        """
        if not name or ":" in name:
            raise ConfigError(
                f"{self._setting}: {name!r} is no name; allowed: text without a colon"
            )
        taken = self._table.get(name, what)
        same = taken is what or (isinstance(taken, str) and taken == what)
        if name in self.later or not same:
            raise ConfigError(f"{self._setting}: the name {name!r} is taken; choose another")
        self._table[name] = what

    def names(self) -> tuple[str, ...]:
        """Return all names: of Eyas, then a user's own, then those of installed packages.

        Raises:
            ConfigError: Two packages use one name.
        """
        return tuple({**self._table, **self._installed()})

    def get(self, name: str) -> T:
        """Return the object with a name or path.

        Raises:
            UnknownNameError: There is no such name.
            NotInThisVersionError: A later version will have it.
            ConfigError: There is no such path, it leads to something else, or two packages use
                the name.
        """
        if name not in self._loaded:
            self._loaded[name] = self._checked(name, self._found(name))
        return self._loaded[name]

    def _found(self, name: str) -> T | str:
        """Return what the table has for a name: an object, or a path to it."""
        if name in self._table:
            return self._table[name]
        if ":" in name:
            return name
        if name in self.later:
            have = ", ".join(sorted(self.names()))
            raise NotInThisVersionError(
                f"{self._setting}: '{name}' is not in this version; there is: {have}"
            )
        installed = self._installed()
        if name not in installed:
            known = (*self._table, *installed, *self.later)
            raise UnknownNameError(self._setting, name, known)
        return installed[name]

    def _installed(self) -> dict[str, str]:
        """Return name and path of what installed packages add."""
        from importlib.metadata import entry_points  # takes a while, and is seldom needed

        found: dict[str, str] = {}
        for point in entry_points(group=self._group) if self._group else ():
            taken = found.get(point.name, self._table.get(point.name, point.value))
            if point.name in self.later or taken != point.value:
                package = point.dist.name if point.dist else point.value
                raise ConfigError(
                    f"{self._setting}: the package '{package}' adds {point.name!r}, "
                    "but that name is taken; remove the package, or rename it there"
                )
            found[point.name] = point.value
        return found

    def _checked(self, name: str, found: T | str) -> T:
        """Return what was found, imported if it is a path."""
        what = self._imported(found) if isinstance(found, str) else found
        if not isinstance(what, self._kind):
            raise ConfigError(
                f"{self._setting}: {name!r} is a {type(what).__name__}, not a {self._kind.__name__}"
            )
        return what

    def _imported(self, path: str) -> object:
        """Return the object at a path; an error within its module is the module's own."""
        name, _, attribute = path.partition(":")
        if not name or not attribute.isidentifier():
            raise ConfigError(
                f"{self._setting}: {path!r} is no path; allowed: package.module:attribute"
            )
        if not _exists(name):
            raise ConfigError(f"{self._setting}: {path!r}: there is no module '{name}'")
        module = import_module(name)
        if not hasattr(module, attribute):
            raise ConfigError(
                f"{self._setting}: {path!r}: the module '{name}' has no '{attribute}'"
                f"{nearest(attribute, vars(module))}"
            )
        return getattr(module, attribute)


def _exists(module: str) -> bool:
    if module in sys.modules:
        return True
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # one of its parents is missing
        return False
