"""Streets of OpenStreetMap through SUMO's netconvert, with its tables of road types."""

import subprocess
from pathlib import Path

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.scratch import scratch
from eyas.engine.traffic.network import without_comments
from eyas.engine.traffic.sumo_install import sumo_binary, sumo_environment

__all__ = ["OPTIONS", "osm_network"]

_TYPES = ("osmNetconvert.typ.xml", "osmNetconvertUrbanDe.typ.xml")
"""Lanes, speeds and users of each kind of road, in the folder `data/typemap` of SUMO."""

OPTIONS = (
    *("--offset.disable-normalization", "true"),
    # Streets for cars that hang together, with sidewalks as tagged.
    *("--keep-edges.by-vclass", "passenger"),
    *("--keep-edges.components", "1"),
    *("--osm.sidewalks", "true"),
    *("--walkingareas", "true"),
    # Crossings, with lights for those on foot, only where there are traffic lights.
    *("--crossings.guess", "true"),
    *("--crossings.guess.speed-threshold", "0"),
    # Bends are not junctions, and what is one crossing for drivers is one junction.
    *("--geometry.remove", "true"),
    *("--junctions.join", "true"),
    *("--max-join-ids", "3"),
    *("--roundabouts.guess", "true"),
    *("--tls.guess-signals", "true"),
    *("--tls.discard-simple", "true"),
    *("--tls.join", "true"),
    # As for the maps of recipes, see `eyas.engine.traffic.network`.
    *("--junctions.corner-detail", "8"),
    *("--junctions.internal-link-detail", "20"),
    *("--junctions.limit-turn-speed", "5.5"),
    *("--no-turnarounds.except-deadend", "true"),
    *("--output.street-names", "false"),
    *("--precision", "3"),
)
"""netconvert's options, except its files and the projection."""


def osm_network(streets: bytes, projection: str, source: str) -> bytes:
    """Return SUMO's network of streets.

    Args:
        streets: The streets as an OpenStreetMap file (XML).
        source: Name of the user's file, for the message.

    Raises:
        MissingExtraError: SUMO is not installed.
        DataFileError: netconvert makes no network of these streets.
    """
    program, environment = sumo_binary("netconvert"), sumo_environment()
    folder_of_types = Path(environment["SUMO_HOME"]) / "data" / "typemap"
    types = ",".join(str(folder_of_types / name) for name in _TYPES)
    with scratch() as folder:
        given, out = folder / "streets.osm", folder / "net.xml"
        given.write_bytes(streets)
        files = ("--osm-files", str(given), "--type-files", types, "-o", str(out))
        done = subprocess.run(
            [str(program), *files, "--proj", projection, *OPTIONS],
            env=environment,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        if done.returncode != 0 or not out.is_file():
            said = [line for line in done.stderr.splitlines() if line.startswith("Error")]
            reason = (said or ["it ended without a message"])[0].removeprefix("Error: ")
            raise DataFileError(f"{source}: netconvert makes no road network of it: {reason}")
        return without_comments(out.read_bytes())
