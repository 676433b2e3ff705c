"""Missions of ground stations: QGroundControl's `.plan`, and MAVLink's text format, `.waypoints`.

`.plan` (docs.qgroundcontrol.com, "Plan File Format"): simple items with `params`, of which 5 to 7
are latitude, longitude and altitude. `.waypoints`: "QGC WPL 110", twelve columns a line. Neither
has times: what follows one goes at `custom.speed`.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.custom.trajectory import Track

_LARGEST = 16 << 20  # Largest file [bytes]

_PLACES = frozenset({16, 17, 18, 19, 21, 22, 31, 82, 84, 85})
"""Commands of MAVLink that go somewhere: NAV_WAYPOINT, LOITER_*, LAND, TAKEOFF, SPLINE, VTOL_*."""


def read_plan(path: Path) -> list[Track]:
    """Return the way of a QGroundControl mission."""
    whole = read_json(path, _LARGEST)
    mission = whole.get("mission") if isinstance(whole, dict) else None
    items = mission.get("items") if isinstance(mission, dict) else None
    if not isinstance(items, list):
        raise DataFileError(f"{path}: has no mission.items: not a plan of QGroundControl")
    return _way(path, [place for item in items for place in _places(item)])


def _places(item: Any) -> Iterator[list[Any]]:  # noqa: ANN401  # JSON
    """Yield longitude, latitude and altitude of a mission's item; surveys have items within."""
    if not isinstance(item, dict):
        return
    inner = item.get("TransectStyleComplexItem")
    if isinstance(inner, dict) and isinstance(inner.get("Items"), list):
        for each in inner["Items"]:
            yield from _places({} if each is item else each)
    params = item.get("params")
    if item.get("command") in _PLACES and isinstance(params, list) and len(params) == 7:
        latitude, longitude, altitude = params[4:]
        if latitude or longitude:  # both 0 or null: here
            yield [longitude, latitude, altitude]


def read_waypoints(path: Path) -> list[Track]:
    """Return the way of a mission in MAVLink's text format."""
    lines = read_limited(path, _LARGEST).decode("utf-8-sig", "replace").splitlines()
    if not lines or not lines[0].startswith("QGC WPL"):
        raise DataFileError(f"{path}: line 1: not 'QGC WPL 110'")
    places: list[list[Any]] = []
    for number, line in enumerate(lines[1:], 2):
        cells = line.split()
        if not cells:
            continue
        if len(cells) != 12:
            raise DataFileError(f"{path}: line {number}: {len(cells)} columns, not 12")
        # The first item is home, where it is no waypoint of the way.
        if cells[3] in {str(each) for each in _PLACES} and number > 2:
            latitude, longitude, altitude = cells[8:11]
            if latitude.strip("0.-") or longitude.strip("0.-"):
                places.append([longitude, latitude, altitude])
    return _way(path, places)


def _way(path: Path, places: list[list[Any]]) -> list[Track]:
    try:
        table = np.array([[float(cell) for cell in place] for place in places], np.float64)
    except (TypeError, ValueError):
        raise DataFileError(f"{path}: a waypoint's place is no number") from None
    if len(table) < 2:
        raise DataFileError(f"{path}: {len(table)} waypoints with a place; a way has two or more")
    return [Track(None, table, on_earth=True)]
