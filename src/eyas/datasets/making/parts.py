"""One part of a data set: recorded, counted, and put into the formats that the recipe asks for.

`part.json` in a part's folder says that it is complete; a part without it is continued.
"""

import hashlib
import logging
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

from eyas.datasets.plan import DatasetPart
from eyas.datasets.statistics import PartFacts, facts_of
from eyas.engine.core.config import validated
from eyas.engine.core.errors import DataFileError, EyasError, OutputError
from eyas.engine.core.files import read_limited, write_atomic
from eyas.engine.exports.checksums import CHECKSUMS
from eyas.engine.recordings.export import add_episodes, exports_folder
from eyas.engine.recordings.recording import load_part
from eyas.engine.settings.file import read_settings
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import together
from eyas.engine.video.run import recording_rules, run

PART_FILE = "part.json"  # File of a complete part with its `PartFacts`


def worlds_of(parts: Sequence[DatasetPart]) -> list[DatasetPart]:
    """Return one part for each world: each map with its traffic, targets and extras."""
    found: dict[object, DatasetPart] = {}
    for part in parts:
        config = part.config
        world, who = config.world, (config.target, config.extras, config.objects, config.custom)
        key = (world.map, world.seed, *who, config.traffic, config.same_target)
        known = found.setdefault(repr(key), part)
        if config.video.channels > known.config.video.channels:
            found[repr(key)] = part
    return list(found.values())


def check_part(part: DatasetPart) -> None:
    """Build the world of a part, and draw nothing.

    Raises:
        EyasError: It cannot be recorded; the line begins with its name.
    """
    try:
        config = recording_rules(part.config)
        with _hushed(), closing(build_simulation(config, together(config.video.channels))) as sim:
            sim.reset()  # raises if there are fewer targets than trackers
    except EyasError as error:
        raise _plain(error, f"{part.name}: ") from None


def record_part(part: DatasetPart, root: Path) -> PartFacts:
    """Record a part, or what is missing of it.

    Raises:
        EyasError: It cannot be recorded; the line begins with its name.
    """
    folder = root / part.folder
    try:
        with _hushed():
            run(part.config, folder, resume=True, quiet=True)
        facts = _facts(root, part)
        content = facts.model_dump_json().encode() + b"\n"
        write_atomic(folder / PART_FILE, content)
    except EyasError as error:
        raise _plain(error, f"{part.name}: ") from None
    return facts


def _plain(error: EyasError, begin: str = "") -> EyasError:
    """Return an error that can go from one process to another."""
    kind = OutputError if isinstance(error, OutputError) else EyasError
    return kind(f"{begin}{error}")


@contextmanager
def _hushed() -> Iterator[None]:
    """Keep back warnings, which would be the same for each part."""
    log = logging.getLogger("eyas")
    before = log.level
    log.setLevel(logging.ERROR)
    try:
        yield
    finally:
        log.setLevel(before)


def _facts(root: Path, part: DatasetPart) -> PartFacts:
    world = part.config.world
    place = {"map": world.map, "weather": world.weather, "variant": part.variant or "only"}
    place = {"split": part.split, **place}
    episodes = load_part(root, part.split, part.name)
    return facts_of(episodes, digest_of(root / part.folder), place)


def digest_of(folder: Path) -> str:
    """Return the SHA-256 of the checksums of a recording.

    Raises:
        DataFileError: It has none.
    """
    return hashlib.sha256(read_limited(folder / CHECKSUMS, 1 << 30)).hexdigest()


def read_facts(folder: Path) -> PartFacts | None:
    """Return what is known of a part; None if it is not complete."""
    path = folder / PART_FILE
    if not path.exists():
        return None
    facts = validated(PartFacts, read_settings(path))
    if facts.checksums != digest_of(folder):
        raise DataFileError(f"{path}: not of the recording beside it: other checksums")
    return facts


def export_part(part: DatasetPart, root: Path, dataset: str, formats: Sequence[str]) -> int:
    """Put the episodes of a part into the exports of the data set; return its frames.

    Raises:
        EyasError: A file cannot be read or written.
    """
    episodes = load_part(root, part.split, part.name)
    try:
        for name in formats:
            add_episodes(exports_folder(root, name, None), dataset, name, episodes)
    except EyasError as error:
        raise _plain(error) from None
    return sum(len(episode) for episode in episodes)
