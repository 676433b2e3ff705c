"""The roads of a map for other programs: SUMO's network with its traffic, and OpenDRIVE."""

import re
import subprocess
from collections.abc import Mapping
from pathlib import Path

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.core.scratch import scratch
from eyas.engine.traffic.config import Signals, TrafficConfig
from eyas.engine.traffic.fleet import ROOMS, fleet_of
from eyas.engine.traffic.library import CANONICAL_SEED, STANDARD_DURATION
from eyas.engine.traffic.network import network_xml
from eyas.engine.traffic.record import resolved
from eyas.engine.traffic.sumo import RATE, departures_and_types, options
from eyas.engine.traffic.sumo_install import sumo_binary, sumo_environment
from eyas.engine.world.maps import MAPS


def _files_of_network(
    name: str, network: bytes, config: TrafficConfig, duration: float, *, town: bool
) -> Mapping[str, bytes]:
    """Return what `sumo -c NAME.sumocfg` needs for the traffic of a map, by names of files."""
    room = ROOMS[1] if town else None
    types, departures = departures_and_types(network, config, fleet_of(config, duration, room=room))
    lines = ["<routes>", types]
    for number, each in enumerate(departures):
        edges = " ".join(each.route)
        lines.append(
            f'<vehicle id="{number}" type="{each.vehicle_type.value}" depart="{each.time:.3f}" '
            f'departLane="best" departPos="{each.place}" departSpeed="{each.speed}">'
            f'<route edges="{edges}"/></vehicle>'
        )
    lines += ["</routes>", ""]
    roads, routes = f"{name}.net.xml", f"{name}.rou.xml"
    told = [
        ("net-file", roads),
        ("route-files", routes),
        ("begin", "0"),
        ("end", f"{duration:g}"),
        ("step-length", f"{1 / RATE:g}"),
        ("seed", str(config.seed)),
        *_pairs(options(config, town=town)),
    ]
    settings = "\n".join(f'<{key} value="{value}"/>' for key, value in told)
    return {
        roads: network,
        routes: "\n".join(lines).encode(),
        f"{name}.sumocfg": f"<configuration>\n{settings}\n</configuration>\n".encode(),
    }


def _pairs(options: tuple[str, ...]) -> list[tuple[str, str]]:
    names = [option.removeprefix("--") for option in options[::2]]
    return list(zip(names, options[1::2], strict=True))


def opendrive_xml(
    name: str,  # Name of the map
    network: bytes,  # SUMO's network file
) -> bytes:
    """Return a network as OpenDRIVE 1.4, by netconvert; the same network gives the same bytes.

    Raises:
        MissingExtraError: SUMO is not installed.
        DataFileError: netconvert refuses the network.
    """
    program = sumo_binary("netconvert")
    with scratch() as folder:
        given, out = folder / "net.xml", folder / "roads.xodr"
        given.write_bytes(network)
        files = ("--sumo-net-file", str(given), "--opendrive-output", str(out))
        done = subprocess.run(
            [str(program), *files],
            env=sumo_environment(),
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        if done.returncode != 0 or not out.is_file():
            reason = (done.stderr.strip().splitlines() or ["it ended without a message"])[0]
            raise DataFileError(f"{name}: netconvert makes no OpenDRIVE of its roads: {reason}")
        text = out.read_text(encoding="utf-8")
    # When and where it was made are not of the map.
    text = re.sub(r"<!--.*?-->\n*", "", text, count=1, flags=re.DOTALL)
    text = re.sub(r'(<header [^>]*) date="[^"]*"', r'\1 date="1970-01-01T00:00:00"', text, count=1)
    return text.replace('<header revMajor="1" revMinor="4" name=""', _head(name), 1).encode()


def _head(name: str) -> str:
    return f'<header revMajor="1" revMinor="4" name="{name}"'


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
    town = bool(MAPS.get(name).roads(seed).finished)
    return _files_of_network(stem, _network(name, seed), config, STANDARD_DURATION, town=town)


def write_opendrive(name: str, seed: int, path: Path) -> None:
    """Write the roads of a map, with their traffic lights, as OpenDRIVE.

    Raises:
        EyasError: SUMO is not installed, or the file cannot be written.
    """
    recipe = MAPS.get(name)
    write_atomic(path, opendrive_xml(recipe.name, _network(name, seed)))


def _network(name: str, seed: int) -> bytes:
    return network_xml(MAPS.get(name).roads(seed), signals=True)
