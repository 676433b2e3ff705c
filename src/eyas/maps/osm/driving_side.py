"""On which side of the road one drives, by the tags of a file, or else by the place."""

from collections import Counter
from pathlib import Path

import numpy as np

from eyas.maps.osm.reader import OsmData, Tags

SIDES = ("left", "right")

_KEYS = ("driving_side", "drive_on")


def tagged_side(data: OsmData) -> str:
    """Return the side that most streets, or else the boundaries, of a file name; empty: none."""
    streets = [way.tags for way in data.ways.values() if "highway" in way.tags]
    for some in (streets, [relation.tags for relation in data.relations]):
        counted = Counter(side for tags in some if (side := _side_of(tags)))
        if counted:
            return max(counted, key=lambda side: counted[side])
    return ""


def _side_of(tags: Tags) -> str:
    return next((tags[key] for key in _KEYS if tags.get(key) in SIDES), "")


def usual_side(longitude: float, latitude: float) -> str:
    """Return the side on which one drives at a place, in degrees."""
    x, y = (longitude + 180.0) % 360.0 - 180.0, latitude
    inside = False
    for ring in _LEFT.read_text(encoding="utf-8").split("\n\n")[1:]:
        ax, ay = np.array([pair.split(",") for pair in ring.split()], np.float64).T
        bx, by = np.roll(ax, -1), np.roll(ay, -1)
        spans = (ay > y) != (by > y)
        # How far east an edge that spans the latitude is; the others are not looked at.
        east = ax + (y - ay) / np.where(spans, by - ay, 1.0) * (bx - ax) > x
        inside ^= bool((spans & east).sum() % 2)
    return SIDES[0] if inside else SIDES[1]


_LEFT = Path(__file__).with_name("left_hand.txt")
"""Where traffic keeps left: outlines in degrees, after what they are made of; a place within an odd
number of them is inside."""
