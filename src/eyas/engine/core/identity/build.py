"""The build: what identifies the program, house by house, so that a refusal can name what differs.

It is the union of the houses that can change a result; of the engine each room counts by itself. It
covers their code by what it says (comments, docstrings and texts of errors say nothing) and the
data that come with them. Of libraries it tells those whose versions change what networks compute;
with all others that `pyproject.toml` admits, the bytes are the same (`docs/reproducibility.md`).
"""

import os
from collections.abc import Collection, Iterator, Mapping
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from eyas.engine.core.config import Config
from eyas.engine.core.doors import houses
from eyas.engine.core.identity.definitions import INDEX
from eyas.lanes.text_index import SUFFIX

WORLD = frozenset(
    "lanes maps engine/behaviours engine/camera engine/core engine/custom engine/mesh "
    "engine/render engine/sensors engine/sim engine/state engine/targets engine/task "
    "engine/trackers engine/traffic engine/world".split()
)
"""Houses, and rooms of the engine, that make what happens in an episode and what is seen of it."""

_ROOT = Path(__file__).parents[3]
_ENGINE = "engine"
# What sources say, once more, what their code makes (`MapRecipe.shipped_plan`), what people read.
_SILENT = (SUFFIX, ".eyl", ".md")
# It computes what the sources say, or is not used.
_CODE_OF_KERNELS = ("lanes/shipped/", "gpu/shipped/")
_LIBRARIES = ("onnxruntime", "torch")  # Their versions change what networks compute


class Build(Config):
    """A build of the program."""

    rooms: dict[str, str]
    """Digests of its houses, and of the rooms of its engine, `engine/sim`."""
    libraries: dict[str, str]
    """Versions of the libraries that networks use, if these are installed."""

    @property
    def id(self) -> str:
        """Twelve hexadecimal digits that differ between builds."""
        return self._id_of(self.rooms)

    @property
    def world(self) -> str:
        """Twelve hexadecimal digits that differ where episodes may differ, see `WORLD`."""
        return self._id_of([room for room in self.rooms if _lies_in(room, WORLD)])

    def id_without(self, names: Collection[str]) -> str:
        """Return twelve hexadecimal digits that differ where others than these do."""
        return self._id_of([room for room in self.rooms if not _lies_in(room, names)])

    def _id_of(self, names: Collection[str]) -> str:
        said = "\n".join(f"{room} {self.rooms[room]}" for room in sorted(names))
        return sha256(said.encode()).hexdigest()[:12]

    def difference(
        self,
        other: "Build",  # The other build
        *,
        without: Collection[str] = (),  # Rooms, and houses with all their rooms, that do not matter
        libraries: bool = False,  # Whether the libraries of networks matter
    ) -> str:
        """Return what differs from another build in words; nothing if nothing does."""
        rooms = sorted(self.rooms.keys() | other.rooms.keys())
        differ = [room for room in rooms if self.rooms.get(room) != other.rooms.get(room)]
        differences = [room for room in differ if not _lies_in(room, without)]
        for name in _LIBRARIES if libraries else ():
            one, two = (each.libraries.get(name, "none") for each in (self, other))
            if one != two:
                differences.append(f"{name} {one} and {two}")
        return ", ".join(f"{each:.40}" for each in differences[:12])


def houses_of_results() -> dict[str, Path]:
    """Return the folders of the houses that can change a result, by name."""
    return {name: _ROOT / name for name, house in houses().items() if house.results}


def rooms_of(houses: Mapping[str, Path]) -> dict[str, Path]:
    """Return folders of houses with those of the engine's rooms, by name, in order."""
    rooms = _packages(houses[_ENGINE]) if _ENGINE in houses else ()
    return dict(sorted([*houses.items(), *((f"{_ENGINE}/{room.name}", room) for room in rooms)]))


@cache
def this_build() -> Build:
    """Return the build that runs; reading all files of the package takes a tenth of a second."""
    rooms = rooms_of(houses_of_results())
    digests = {name: _digest_of(path, rooms.values()) for name, path in rooms.items()}
    INDEX.keep()
    return Build(rooms=digests, libraries=dict(_installed()))


def _packages(folder: Path) -> list[Path]:
    return [path for path in sorted(folder.iterdir()) if (path / "__init__.py").is_file()]


def _lies_in(room: str, names: Collection[str]) -> bool:
    return room in names or room.partition("/")[0] in names


def _installed() -> Iterator[tuple[str, str]]:
    for name in _LIBRARIES:
        try:
            yield name, version(name)
        except PackageNotFoundError:
            continue


def _digest_of(folder: Path, rooms: Collection[Path]) -> str:
    """Return a digest of the files in a folder, without those of rooms in it."""
    others, found = {str(room) for room in rooms}, list[str]()
    for at, inner, files in os.walk(folder):
        inner[:] = [n for n in inner if n != "__pycache__" and f"{at}/{n}" not in others]
        found += [f"{at}/{file}" for file in files if not file.endswith(_SILENT)]
    digest = sha256()
    for path in sorted(found):
        inside = path.removeprefix(f"{_ROOT}/")
        if not inside.startswith(_CODE_OF_KERNELS):
            content = Path(path).read_bytes()
            if path.endswith(".py"):
                content = INDEX.json_of(content)
            digest.update(f"{inside} {len(content)} ".encode() + content)
    return digest.hexdigest()[:8]
