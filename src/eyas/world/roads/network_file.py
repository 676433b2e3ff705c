"""Files of road networks: small, and identical whenever the same network is written."""

import io
import zipfile
import zlib
from dataclasses import fields
from pathlib import Path

import numpy as np

from eyas.core.errors import DataFileError
from eyas.core.files import write_atomic
from eyas.state.roads import RoadNetwork

__all__ = ["load_network", "save_network"]

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Timestamp of every member of the zip file, so that it does not differ from run to run."""


def save_network(path: Path, network: RoadNetwork) -> None:
    """Write a network as npz with fixed timestamps.

    Raises:
        OutputError: The file cannot be written.
    """
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for field in fields(RoadNetwork):
            member = io.BytesIO()
            np.lib.format.write_array(
                member, np.asarray(getattr(network, field.name)), version=(1, 0)
            )
            info = zipfile.ZipInfo(f"{field.name}.npy", _EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, member.getvalue())
    write_atomic(path, buffer.getvalue())


def load_network(path: Path) -> RoadNetwork:
    """Read a network.

    Raises:
        DataFileError: The file is missing, truncated or of another kind.
    """
    try:
        with path.open("rb") as file, np.load(file) as archive:
            values = {field.name: archive[field.name] for field in fields(RoadNetwork)}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise DataFileError(f"{path}: not a readable road network: {error}") from error
    for name in ("graph_hash", "builder"):
        values[name] = str(values[name])
    for name in ("edges", "edge_start", "edge_end", "junctions"):
        values[name] = tuple(str(entry) for entry in values[name])
    return RoadNetwork(**values)
