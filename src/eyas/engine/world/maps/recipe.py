"""The definition of a map, one object for each."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from hashlib import blake2b
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.files import require_sum
from eyas.engine.core.identity.program import code_of, definitions_in
from eyas.engine.core.registry import OWN
from eyas.engine.core.rng import TEST_SEEDS
from eyas.engine.state.lighting import Lighting
from eyas.engine.world.maps.planner import planner
from eyas.engine.world.weather import WEATHERS, Season, Weather, unchanged
from eyas.lanes.container import unpacked

if TYPE_CHECKING:  # maps load with `eyas`; the scene modules only when a scene is built
    from eyas.engine.state.roads import RoadGraph, RoadNetwork

ATTRIBUTION_FILE = "ATTRIBUTION.txt"
"""File in a map's folder that names those whose data it is made of."""

PLAN_FILE = "map.plan.json"  # File in the folder of an imported map with its plan
PLAN_SUFFIXES = (".plan.json", ".plan.json.gz")  # Endings of the names of files with plans
NETWORK_FILE = "network.npz"  # File in a map's package with the processed roads of its seed 0
MADE_PLAN_SUFFIX = ".eyl"  # Ending of the file in a map's package with the plan of its seed 0
TRAFFIC_FILE = "traffic.npz"  # File in a map's package with the canonical recording of its traffic


MIXED_FILE = "traffic-mixed.npz"
"""File in a city's package with the canonical recording of all classes of vehicles."""


DENSE_FILE = "traffic-dense.npz"
"""File in a city's package with the same classes in dense traffic, eight times as many."""

DENSE_TEST_FILE = "traffic-dense-test.npz"  # The same of a seed that is kept for tests

SIGNALS_TRAFFIC_FILE = "traffic-signals.npz"
"""File in a map's package with the canonical recording of drivers who obey its traffic lights."""

SIGNALS_FILE = "signals.npz"  # File in a map's package with what these lights show
TEST_TOWNS = (TEST_SEEDS + 1, TEST_SEEDS + 2)
"""Seeds of the maps that ship for tests, see `TEST_SEEDS`."""


def network_file(map_seed: int) -> str:
    """Return the file in a map's package with the processed roads of a seed."""
    return f"network-{map_seed}.npz" if map_seed else NETWORK_FILE


def town_traffic_file(map_seed: int, traffic_seed: int) -> str:
    """Return the file in a map's package with traffic for tests."""
    town = f"-{map_seed}" if map_seed else ""
    return f"traffic{town}-seed-{traffic_seed}.npz"


def drivers_file(
    drivers: str,  # How they behave, a value of `traffic.drivers`
    traffic_seed: int | None = None,  # One kept for tests; None: the canonical one
) -> str:
    """Return the file in a map's package with the traffic of drivers who want to be lost."""
    seed = "" if traffic_seed is None else f"-seed-{traffic_seed}"
    return f"traffic-{drivers}{seed}.npz"


def respawn_file(group_size: int) -> str:
    """Return the file in a map's package with the canonical traffic of groups of a size."""
    return f"traffic-groups-of-{group_size}.npz"


@dataclass(frozen=True, slots=True, kw_only=True)
class Original:
    """Figures of the map of the DAT benchmark that a map re-creates."""

    road: float  # Length of its roads [km]
    buildings: int = 0
    height: float = 0.0  # Median height of the buildings [m]; 0 if there are none
    trees: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class MapRecipe:
    """A map: its roads, its plan, and what is special about its weathers."""

    name: str
    """Words joined by hyphens; used in the names of folders and environments."""
    title: str
    """Name for people, a few words."""
    roads: Callable[[int], "RoadGraph"]
    """Returns the roads of a seed; seed 0 is the canonical map."""
    plan: Callable[["RoadNetwork", int], Any]
    """Returns the plan of all else around the processed roads of the same seed; what it leaves
    open is decided by `complete_plan`."""
    weather: Callable[[Weather], Weather] = unchanged
    """Returns how a weather is on this map, also one of a user's own."""
    without: tuple[str, ...] = ()
    """Names of the weathers that the map does not have."""
    seasons: bool = False
    """Whether the winter scene differs from that of summer: other trees, roofs or crops. Snow on an
    unchanged scene is part of the light (`Lighting.snow`) and needs no scene of its own. The leaves
    of autumn turn on every map."""
    package: str | None = None
    """Package that contains the map, mostly `__name__`: it may hold `NETWORK_FILE` and recordings
    (`traffic*.npz`), and a change of its code or data rebuilds the scene. None: nothing is shipped,
    and the scene is not cached between runs."""
    origin: tuple[float, float] | None = None
    """Longitude and latitude of the middle of the map [degrees]; None: it lies nowhere on earth."""
    home: Path | None = None
    """Folder of an imported map, which is not a package. It holds the same files."""
    checksums: Mapping[str, str] = field(default_factory=dict)
    """SHA-256 of files in it, by name."""
    left_hand: bool = False
    """Whether traffic keeps left, so that nothing of what the package ships is of it."""
    file: Path | None = None
    """File with the plan of a map that has neither."""
    notice: str = ""
    """Attribution wherever the map is shown, unless a file beside it has it."""
    original: Original | None = None
    """Figures of the map that it re-creates; None if there is none."""
    pedestrians: int = 0
    """Number of people on its pavements and crossings, unless the settings name others
    (`extras`)."""
    strollers: int = 0
    """Number of people who walk along the edges of its roads, where it has no pavements."""
    waiting: int = 0
    """Number of people who stand at its bus stops and cafes."""
    cyclists: int = 0
    """Number of people who ride bicycles."""

    def __post_init__(self) -> None:
        if not re.fullmatch(r"\w+(-\w+)*", self.name):
            raise ConfigError(
                f"MapRecipe.name: {self.name!r} is not allowed; allowed: words joined by hyphens"
            )

    @property
    def weathers(self) -> tuple[str, ...]:
        """Names of the weathers of the map."""
        return tuple(name for name in WEATHERS.names() if name not in self.without)

    def light(self, weather: str, hour: float | None = None, moon: float | None = None) -> Lighting:
        """Return light and air of a weather at an hour under a moon, see `Weather.light`.

        Raises:
            UnknownNameError: The map has no such weather.
        """
        return self.weather(self._known(weather)).light(hour, moon)

    def season(self, weather: str) -> Season:
        """Return the season of the scene in a weather; no winter on a map without seasons.

        Raises:
            UnknownNameError: The map has no such weather.
        """
        season = self._known(weather).season
        return season if self.seasons or season is Season.AUTUMN else Season.SUMMER

    @property
    def folder(self) -> Traversable | None:
        """Folder of the map's package, or of an imported map; None without either."""
        if self.package is None:
            return self.home
        from importlib.resources import files  # not needed to describe a map

        return files(self.package)

    def shipped(self, file: str) -> Traversable | None:
        """Return a file that comes with the map's package; None if there is none."""
        path = self.folder / file if self.folder is not None and not self.left_hand else None
        return path if path is not None and path.is_file() else None

    def shipped_traffic(self) -> tuple[Traversable, ...]:
        """Return the recordings that come with the map's package, the canonical ones first."""
        files = () if self.folder is None or self.left_hand else self.folder.iterdir()
        found = [file for file in files if re.fullmatch(r"traffic.*\.npz", file.name)]
        usual = {TRAFFIC_FILE, SIGNALS_TRAFFIC_FILE}
        return tuple(sorted(found, key=lambda file: (file.name not in usual, file.name)))

    def keeping_left(self) -> "MapRecipe":
        """Return the map with traffic that keeps left."""
        from eyas.engine.state.roads import LEFT_ENDING

        return replace(
            self,
            name=f"{self.name}{LEFT_ENDING}",
            title=f"{self.title}, traffic keeps left",
            roads=partial(_kept_left, self.roads),
            left_hand=True,
        )

    def data_hash(self) -> str | None:
        """Return a digest of a plan in a file, or of what a folder holds beside code of Eyas, roads
        and recordings.

        None without both: then nobody knows what the map is made of.
        """
        if self.file is not None:
            return _digest_of([self.file])
        if self.folder is None:
            return None
        if self.package is None:
            return _digest_of([self.folder / PLAN_FILE])
        foreign = self.package.partition(".")[0] != __name__.partition(".")[0]
        return _digest_of(_files_in(self.folder, sources=foreign))

    def attribution(self) -> str:
        """Return what must be said wherever the map or data made from it is shown, or nothing."""
        file = self.shipped(ATTRIBUTION_FILE)
        return file.read_text(encoding="utf-8") if file is not None else self.notice

    def complete_plan(self, network: "RoadNetwork", seed: int) -> Any:  # noqa: ANN401  # a plan
        """Return the plan of a seed, with all that it leaves open decided."""
        return planner().complete(self.plan(network, seed), network)

    def shipped_network(self, seed: int = 0) -> "RoadNetwork | None":
        """Return the processed roads of a seed that come with the package, if there are any.

        Raises:
            DataFileError: The installation is damaged.
        """
        from importlib.resources import as_file

        from eyas.engine.world.roads.network_file import load_network

        found = self.shipped(network_file(seed))
        if found is None:
            return None
        with as_file(found) as path:
            require_sum(path, self.checksums)
            return load_network(path)

    def shipped_plan(self, seed: int) -> bytes | None:
        """Return the text of the plan of a seed, if today's code has made the one that ships."""
        file = self.shipped(f"{self.name}{MADE_PLAN_SUFFIX}") if seed == 0 else None
        if file is None:
            return None
        import lzma  # not needed to describe a map

        made_by, (text,) = unpacked(lzma.decompress(file.read_bytes()))
        return bytes(text) if made_by == self.plan_code() else None

    def plan_code(self) -> str:
        """Return what identifies all that the plan of seed 0 is made of."""
        makers = self.plan, planner().complete, planner().text_of
        roads = self.shipped(NETWORK_FILE)
        data = "" if roads is None else _digest_of([roads])
        return f"{data} {self.data_hash()} {' '.join(code_of(m, libraries=False) for m in makers)}"

    def _known(self, name: str) -> Weather:
        here = f"on the map '{self.name}'"
        try:
            weather = WEATHERS.get(name)
        except UnknownNameError:
            raise UnknownNameError("world.weather", name, self.weathers, here, OWN) from None
        if weather.name in self.without:
            raise UnknownNameError("world.weather", name, self.weathers, here)
        return weather


def _kept_left(roads: Callable[[int], "RoadGraph"], seed: int) -> "RoadGraph":
    from eyas.engine.state.roads import kept_left

    return kept_left(roads(seed))


def _files_in(folder: Traversable, *, sources: bool) -> Iterator[Traversable]:
    for path in sorted(folder.iterdir(), key=lambda path: path.name):
        if path.is_dir():
            if path.name != "__pycache__":  # which comes with the first start
                yield from _files_in(path, sources=sources)
        elif not path.name.endswith((".npz", MADE_PLAN_SUFFIX, *([] if sources else [".py"]))):
            yield path


def _digest_of(files: Iterable[Traversable]) -> str:
    """Return a digest of files; of sources what they say, since a foreign one may do anything."""
    digest = blake2b(digest_size=16)
    for path in files:
        content = path.read_bytes() if path.is_file() else b""
        if path.name.endswith(".py"):
            content = repr(definitions_in(content)).encode()
        digest.update(f"{path.name} {len(content)} ".encode() + content)
    return digest.hexdigest()
