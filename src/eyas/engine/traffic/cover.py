"""Cover: the parts of lanes that something stands over, where a car cannot be seen from above."""

import hashlib
import json
from typing import NamedTuple


class Stretch(NamedTuple):
    """A part of a lane from end to end of which a car is out of sight."""

    lane: str  # SUMO's name of the lane: that of its edge, and its number there from the right
    start: float  # Where it begins along the lane [m]
    end: float  # Where it ends along the lane [m]


Cover = tuple[Stretch, ...]  # All of a map, in the order of the lanes


def cover_hash(cover: Cover) -> str:
    """Return the SHA-256 of what drivers know of a map; nothing where they know nothing."""
    return hashlib.sha256(json.dumps(cover).encode()).hexdigest() if cover else ""
