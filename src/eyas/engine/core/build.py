"""The build: what identifies the program, room by room, so that a refusal can name what differs.

It covers all that can change a result: the code of every room, by what it says (comments,
docstrings and texts of errors say nothing), and the data that come with the package. The command
line and the modes are left out, except for `engine/video`, which decides what a recording holds. Of
libraries it tells those whose versions change what networks compute; with all others that
`pyproject.toml` admits, the bytes are the same (`docs/reproducibility.md`).
"""

from collections.abc import Collection, Iterator
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from eyas.engine.core.config import Config
from eyas.engine.core.program import INDEX, definitions_in

__all__ = ["WORLD", "Build", "this_build"]

WORLD = frozenset(
    "behaviours core custom lanes mesh render sensors sim state targets task trackers traffic "
    "world".split()
)
"""Rooms that make what happens in an episode and what is seen of it."""

_ROOT = Path(__file__).parents[2]

_APART = ("cli", "modes")
_VIDEO = "engine/video"

_CODE_OF_KERNELS = "lanes/shipped/"
"""Computes what the sources say, or is not used."""

_LIBRARIES = ("onnxruntime", "torch")


class Build(Config):
    """A build of the program."""

    rooms: dict[str, str]
    """Digests of its rooms."""
    libraries: dict[str, str]
    """Versions of the libraries that networks use, if these are installed."""

    @property
    def id(self) -> str:
        """Twelve hexadecimal digits that differ between builds."""
        return self._id_of(self.rooms)

    @property
    def world(self) -> str:
        """Twelve hexadecimal digits that differ where episodes may differ, see `WORLD`."""
        return self._id_of(WORLD)

    def id_without(self, rooms: Collection[str]) -> str:
        """Return twelve hexadecimal digits that differ where other rooms than these do."""
        return self._id_of(self.rooms.keys() - set(rooms))

    def _id_of(self, rooms: Collection[str]) -> str:
        said = [f"{room} {digest}" for room, digest in sorted(self.rooms.items()) if room in rooms]
        return sha256("\n".join(said).encode()).hexdigest()[:12]

    def difference(
        self, other: "Build", *, without: Collection[str] = (), libraries: bool = False
    ) -> str:
        """Return what differs from another build in words; nothing if nothing does.

        Args:
            other: The other build.
            without: Rooms that do not matter.
            libraries: Whether the libraries of networks matter.
        """
        matter = sorted((self.rooms.keys() | other.rooms.keys()) - set(without))
        told = [room for room in matter if self.rooms.get(room) != other.rooms.get(room)]
        for name in _LIBRARIES if libraries else ():
            one, two = (each.libraries.get(name, "none") for each in (self, other))
            if one != two:
                told.append(f"{name} {one} and {two}")
        return ", ".join(f"{each:.40}" for each in told[:12])


@cache
def this_build() -> Build:
    """Return the build that runs; reading all files of the package takes a tenth of a second."""
    folders = [path for path in sorted(_ROOT.iterdir()) if (path / "__init__.py").is_file()]
    rooms = {path.name: path for path in folders if path.name not in _APART}
    rooms[_VIDEO] = _ROOT / _VIDEO
    return Build(
        rooms={name: _digest_of(path) for name, path in sorted(rooms.items())},
        libraries=dict(_installed()),
    )


def _installed() -> Iterator[tuple[str, str]]:
    for name in _LIBRARIES:
        try:
            yield name, version(name)
        except PackageNotFoundError:
            continue


def _digest_of(room: Path) -> str:
    digest = sha256()
    for path in sorted(room.rglob("*")):
        inside = path.relative_to(_ROOT).as_posix()
        if not path.is_file() or "__pycache__" in path.parts or path == INDEX:
            continue
        if inside.startswith(_CODE_OF_KERNELS):
            continue
        content = path.read_bytes()
        if path.suffix == ".py":
            content = repr(definitions_in(content)).encode()
        digest.update(f"{inside} {len(content)} ".encode() + content)
    return digest.hexdigest()[:8]
