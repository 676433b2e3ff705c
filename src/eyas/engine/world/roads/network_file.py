"""Files of road networks: small, and identical whenever the same network is written."""

import io
import zipfile
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from eyas.engine.core.decoding import decoded_arrays
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import write_atomic
from eyas.engine.state.roads import RoadNetwork, network_problems

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
    """Read a network that may come from anyone: indices are in range, numbers of a city's size.

    Raises:
        DataFileError: The file is missing, damaged, or holds something else.
    """
    arrays = decoded_arrays(path, _LARGEST, "a readable road network", _ARRAYS)
    values: dict[str, Any] = dict(arrays)
    for name in ("graph_hash", "builder"):
        values[name] = str(values[name])
    for name in ("edges", "edge_start", "edge_end", "junctions"):
        values[name] = tuple(values[name].tolist())
    network = RoadNetwork(**values)
    for problem in network_problems(network):
        raise DataFileError(f"{path}: not a readable road network: {problem}")
    return network


_LARGEST = 256 << 20  # Largest size of the arrays [bytes]

_ARRAYS = {
    "graph_hash": ("U", 0), "builder": ("U", 0),
    "lane_points": ("f", 2), "lane_first": ("i", 1), "lane_width": ("f", 1),
    "lane_speed": ("f", 1), "lane_edge": ("i", 1), "lane_index": ("i", 1),
    "edges": ("U", 1), "edge_start": ("U", 1), "edge_end": ("U", 1),
    "junction_points": ("f", 2), "junction_first": ("i", 1), "junctions": ("U", 1),
}  # fmt: skip
"""Kinds of elements and number of axes."""
