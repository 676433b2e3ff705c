"""Road networks as files: small, with the same bytes each time."""

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
"""Time of every member: zip files hold one, and it must not differ from run to run."""


def save_network(path: Path, network: RoadNetwork) -> None:
    """Write a network as npz with fixed timestamps.

    Raises:
        OutputError: The file system refused.
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
        DataFileError: The file is missing, cut off or something else.
    """
    try:
        with np.load(path) as archive:
            values = {field.name: archive[field.name] for field in fields(RoadNetwork)}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise DataFileError(f"{path}: not a readable road network: {error}") from error
    for name in ("graph_hash", "builder"):
        values[name] = str(values[name])
    for name in ("edges", "edge_start", "edge_end", "junctions"):
        values[name] = tuple(str(entry) for entry in values[name])
    return RoadNetwork(**values)
