"""The roads of a map for other programs: SUMO's network with its traffic, and OpenDRIVE."""

from collections.abc import Mapping
from pathlib import Path

from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.traffic.config import Signals, TrafficConfig
from eyas.engine.traffic.library import CANONICAL_SEED, STANDARD_DURATION
from eyas.engine.traffic.network import network_xml
from eyas.engine.traffic.record import resolved
from eyas.engine.traffic.road_files import opendrive_xml, sumo_files
from eyas.engine.world.maps import MAPS

__all__ = ["sumo_files_of", "write_opendrive", "write_sumo"]


def write_sumo(name: str, seed: int, folder: Path) -> list[Path]:
    """Write SUMO's network, routes and configuration of a map into a folder; return the files.

    Args:
        folder: The folder; made if it does not exist.

    Raises:
        EyasError: SUMO is not installed, or a file cannot be written.
    """
    files = sumo_files_of(name, seed, MAPS.get(name).name)
    with refusals(folder):
        folder.mkdir(parents=True, exist_ok=True)
    for file, content in files.items():
        write_atomic(folder / file, content)
    return [folder / file for file in files]


def sumo_files_of(name: str, seed: int, stem: str) -> Mapping[str, bytes]:
    """Return SUMO's network, routes and configuration of a map, by the names of the files.

    Args:
        stem: Of the names of the files.

    Raises:
        EyasError: SUMO is not installed.
    """
    config = resolved(TrafficConfig(signals=Signals.WORKING), CANONICAL_SEED)
    return sumo_files(stem, _network(name, seed), config, STANDARD_DURATION)


def write_opendrive(name: str, seed: int, path: Path) -> None:
    """Write the roads of a map, with their traffic lights, as OpenDRIVE.

    Raises:
        EyasError: SUMO is not installed, or the file cannot be written.
    """
    recipe = MAPS.get(name)
    write_atomic(path, opendrive_xml(recipe.name, _network(name, seed)))


def _network(name: str, seed: int) -> bytes:
    return network_xml(MAPS.get(name).roads(seed), signals=True)
