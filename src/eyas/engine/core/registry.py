"""Tables of named objects that settings choose from: maps, trackers, rewards, writers.

An object is found by its name in the table, or by its path `package.module:attribute`, so that a
user-defined object needs no entry in a table. An object is imported when it is first used.
"""

from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from eyas.engine.core.doors import brought, first_brought
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.own_code import imported

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

OWN = "package.module:attribute"  # Notation of the path of an object of a user

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


class FileObjects(Protocol[T_co]):
    """Objects that are made of files, wherever these lie."""

    form: str  # Notation of the path of such a file, for messages

    def names(self) -> tuple[str, ...]:
        """Return the names of all objects."""
        ...

    def get(self, name: str) -> T_co | None:
        """Return the object with a name or at a path; None if there is none."""
        ...


class Registry(Generic[T]):
    """Objects of one kind by name: built-in, from installed packages, and user-defined.

    Attributes:
        built_in: Names of the objects of the engine and of the houses, in the order of the table.

    Args:
        setting: The setting that names an object, for messages; for example `world.map`.
        kind: Class of the objects, or a protocol that can be checked at run time.
        built_in: The engine's own objects, each as `package.module:attribute` or itself.
        group: Group of the doors of houses (`eyas.engine.core.doors`) and of the entry points with
            which installed packages add objects; None: nobody else can.
        files: Group of the doors of houses with objects that are made of files (`Found`).
    """

    def __init__(  # one argument for each place where objects are found
        self,
        setting: str,
        kind: type[T],
        built_in: Mapping[str, T | str] = MappingProxyType({}),
        *,
        group: str | None = None,
        files: str | None = None,
    ) -> None:
        table = {**built_in, **(brought(group) if group else {})}
        self.built_in = tuple(table)
        self._setting, self._kind, self._group, self._file_group = setting, kind, group, files
        self._table: dict[str, T | str] = dict(table)
        self._loaded: dict[str, T] = {}

    def register(self, name: str, what: T | str) -> None:
        """Add an object under a name, for this process.

        Args:
            name: A name that is not taken, without a colon.
            what: The object, or its path `package.module:attribute`.

        Raises:
            ConfigError: The name is taken by another object, or is not valid.
        """
        if not name or ":" in name:
            raise ConfigError(
                f"{self._setting}: {name!r} is not a name; allowed: text without a colon"
            )
        taken = self._table.get(name, what)
        same = taken is what or (isinstance(taken, str) and taken == what)
        if not same:
            raise ConfigError(f"{self._setting}: the name {name!r} is taken; choose another")
        self._table[name] = what

    def names(self) -> tuple[str, ...]:
        """Return all names: built-in, user-defined, of installed packages, of files.

        Raises:
            ConfigError: Two packages use the same name.
        """
        names = (*self._table, *self._installed(), *self.of_files())
        return tuple(dict.fromkeys(names))

    def get(self, name: str) -> T:
        """Return the object with a name or path.

        Raises:
            UnknownNameError: There is no such name.
            ConfigError: There is no such path, its object is of another kind, or two packages use
                the name.
        """
        if name not in self._loaded:
            self._loaded[name] = self._checked(name, self._found(name))
        return self._loaded[name]

    def path(self, name: str) -> str | None:
        """Return the path of an object that is a user's own or of an installed package; None if it
        is built in, of a file, or not there. Nothing is imported.
        """
        if ":" in name:
            return name
        found = None if name in self.built_in else (self._table | self._installed()).get(name)
        return found if isinstance(found, str) else None

    def forget(self) -> None:
        """Look all objects up again when they are next asked for: a file of one has changed."""
        self._loaded.clear()

    def _found(self, name: str) -> T | str:
        """Return the table's entry for a name: an object, or a path to it."""
        if name in self._table:
            return self._table[name]
        kept = self._files.get(name) if self._files else None
        if kept is not None:
            return kept
        if ":" in name:
            return name
        installed = self._installed()
        if name not in installed:
            known = (*self._table, *installed, *self.of_files())
            others = f"{self._files.form} or {OWN}" if self._files else OWN
            raise UnknownNameError(self._setting, name, known, others=others)
        return installed[name]

    @cached_property
    def _files(self) -> FileObjects[T] | None:
        """Objects that are made of files; asked for late, as they may need the table itself."""
        found: FileObjects[T] | None = first_brought(self._file_group) if self._file_group else None
        return found

    def of_files(self) -> tuple[str, ...]:
        """Return the names of the objects that are made of files."""
        return self._files.names() if self._files else ()

    def _installed(self) -> dict[str, str]:
        """Return the names and paths of the objects that installed packages add."""
        found: dict[str, str] = {}
        for point in self._points:
            taken = found.get(point.name, self._table.get(point.name, point.value))
            if taken != point.value:
                package = point.dist.name if point.dist else point.value
                raise ConfigError(
                    f"{self._setting}: the package '{package}' adds {point.name!r}, "
                    "but that name is taken; remove the package, or rename it there"
                )
            found[point.name] = point.value
        return found

    @cached_property
    def _points(self) -> "tuple[EntryPoint, ...]":
        """Entry points of installed packages; reading them takes 5 ms."""
        from importlib.metadata import entry_points  # slow to import, and rarely needed

        return tuple(entry_points(group=self._group)) if self._group else ()

    def _checked(self, name: str, found: T | str) -> T:
        """Return the object that was found, imported if it is a path."""
        what = imported(found, self._setting) if isinstance(found, str) else found
        if not isinstance(what, self._kind):
            raise ConfigError(
                f"{self._setting}: {name!r} is a {type(what).__name__}, not a {self._kind.__name__}"
            )
        return what
