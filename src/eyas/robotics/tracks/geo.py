"""Tracks of receivers and of maps: GPX, KML, KMZ, GeoJSON.

GPX 1.1 (topografix.com/GPX/1/1): `trk` with `trkseg`, else `rte`, else `wpt`, in that order. KML
2.2 with Google's `gx:Track` (`when`, `gx:coord`), else `LineString`. GeoJSON (RFC 7946):
`LineString` and `MultiLineString`, with times in `coordTimes` or `times` where a converter has kept
them.
"""

import io
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from eyas.engine.core.decoding import decoded_json, decoded_xml
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.custom.trajectory import Track, datetime_seconds

_LARGEST = 64 << 20  # Largest file, and largest content of a KMZ [bytes]

Point = tuple[float, float, float, float]  # Longitude, latitude [degrees], altitude [m], time [s]
_NAN = float("nan")


def read_gpx(path: Path) -> list[Track]:
    """Return the tracks of a GPX file; its routes or its waypoints, if it has none."""
    root = _xml(path, read_limited(path, _LARGEST), "gpx")
    tracks = []
    for each in _all(root, "trk"):
        tracks += _track(path, map(_gpx_point, _all(each, "trkpt")), _text(each, "name"))
    for each in [] if tracks else _all(root, "rte"):
        tracks += _track(path, map(_gpx_point, _all(each, "rtept")), _text(each, "name"))
    if not tracks:
        tracks = _track(path, map(_gpx_point, _all(root, "wpt")), "")
    return _some(path, tracks, "no track, route or waypoints")


def read_kml(path: Path) -> list[Track]:
    """Return the tracks of a KML or KMZ file; its lines, if it has none."""
    content = read_limited(path, _LARGEST)
    if content[:4] == b"PK\3\4":
        content = _unzipped(path, content)
    root = _xml(path, content, "kml")
    tracks = []
    for each in _all(root, "Track"):
        when = [(one.text or "").strip() for one in _all(each, "when")]
        places = [(one.text or "").split() for one in _all(each, "coord")]
        if not when:  # Google's history of places has a span of time instead
            when = [""] * len(places)
        if len(when) != len(places):
            raise DataFileError(f"{path}: {len(when)} times for {len(places)} places in a Track")
        points = (_point([*place, *["nan"] * (3 - len(place))], time)
                  for place, time in zip(places, when, strict=True))  # fmt: skip
        tracks += _track(path, points, "")
    for each in [] if tracks else _all(root, "LineString"):
        rows = [cell.split(",") for cell in _text(each, "coordinates").split()]
        points = (_point([*row, *["nan"] * (3 - len(row))], "") for row in rows)
        tracks += _track(path, points, "")
    return _some(path, tracks, "neither gx:Track nor LineString")


def read_geojson(path: Path) -> list[Track]:
    """Return the lines of a GeoJSON file as tracks."""
    try:
        whole = decoded_json(read_limited(path, _LARGEST))
    except ValueError as error:
        raise DataFileError(f"{path}: not GeoJSON: {error}") from None
    tracks: list[Track] = []
    for geometry, facts in _geometries(whole):
        lines = geometry.get("coordinates")
        times = facts.get("coordTimes") or facts.get("times")
        if geometry.get("type") == "LineString":
            lines, times = [lines], [times]
        elif geometry.get("type") != "MultiLineString":
            continue
        for number, line in enumerate(lines if isinstance(lines, list) else []):
            when = times[number] if isinstance(times, list) and number < len(times) else None
            told = when if isinstance(when, list) and len(when) == len(line or ()) else None
            if not isinstance(line, list) or not all(isinstance(row, list) for row in line):
                raise DataFileError(f"{path}: a LineString whose coordinates are no lists")
            points = (
                _point([*row[:3], *["nan"] * (3 - len(row))], told[k] if told else "")
                for k, row in enumerate(line)
            )
            tracks += _track(path, points, "")
    return _some(path, tracks, "no LineString")


def _geometries(whole: Any) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:  # noqa: ANN401
    """Yield the geometries of a GeoJSON object, with the properties of their features."""
    if not isinstance(whole, dict):
        return
    features = whole.get("features") if whole.get("type") == "FeatureCollection" else [whole]
    for feature in features if isinstance(features, list) else []:
        if not isinstance(feature, dict):
            continue
        geometry = feature.get("geometry") if feature.get("type") == "Feature" else feature
        facts = feature.get("properties")
        if isinstance(geometry, dict):
            yield geometry, facts if isinstance(facts, dict) else {}


def _xml(path: Path, content: bytes, root: str) -> ElementTree.Element:
    try:
        found = decoded_xml(content)
    except ValueError as error:
        raise DataFileError(f"{path}: {error}") from None
    if _name(found) != root:
        raise DataFileError(f"{path}: its content is <{_name(found):.40}>, not <{root}>")
    return found


def _name(element: ElementTree.Element) -> str:
    return str(element.tag).rpartition("}")[2]


def _all(element: ElementTree.Element, name: str) -> Iterator[ElementTree.Element]:
    return (each for each in element.iter() if _name(each) == name)


def _text(element: ElementTree.Element, name: str) -> str:
    return next(((each.text or "").strip() for each in element if _name(each) == name), "")


def _gpx_point(element: ElementTree.Element) -> Point:
    place = element.get("lon", ""), element.get("lat", ""), _text(element, "ele") or "nan"
    return _point(place, _text(element, "time"))


def _point(place: Any, time: Any) -> Point:  # noqa: ANN401  # cells of any file
    """Return a point of a longitude, a latitude, an altitude and a time.

    Raises:
        ValueError, TypeError: One is no number, or no time.
    """
    longitude, latitude, altitude = (float(cell) for cell in place)
    return longitude, latitude, altitude, datetime_seconds(time) if time else _NAN


def _track(path: Path, points: Iterator[Point], name: str) -> list[Track]:
    """Return the track of some points; none if there are not two."""
    try:
        table = np.array(list(points), np.float64).reshape(-1, 4)
    except (ValueError, TypeError, OverflowError) as error:
        raise DataFileError(f"{path}: a point is no place with a time: {error!s:.120}") from None
    if len(table) < 2:
        return []
    on_earth = (np.abs(table[:, 0]) <= 180.0) & (np.abs(table[:, 1]) <= 90.0)
    if not on_earth.all():
        k = int(np.argmin(on_earth))
        raise DataFileError(
            f"{path}: point {k + 1}: longitude {table[k, 0]:.6g}, latitude {table[k, 1]:.6g} is "
            "nowhere on earth"
        )
    if np.isnan(table[:, 3]).any():
        return [Track(None, table[:, :3], on_earth=True, name=name)]
    return [Track(table[:, 3], table[:, :3], on_earth=True, name=name)]


def _some(path: Path, tracks: list[Track], lacks: str) -> list[Track]:
    if not tracks:
        raise DataFileError(f"{path}: has {lacks} of two points or more")
    return tracks


def _unzipped(path: Path, content: bytes) -> bytes:
    """Return the first `.kml` of a KMZ."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            name = next((each for each in archive.namelist() if each.endswith(".kml")), None)
            if name is None:
                raise DataFileError(f"{path}: holds no .kml")
            with archive.open(name) as file:
                inside = file.read(_LARGEST + 1)
    except (zipfile.BadZipFile, zlib.error, OSError, EOFError, ValueError, RuntimeError) as error:
        raise DataFileError(f"{path}: cannot read: {error}") from None
    if len(inside) > _LARGEST:
        raise DataFileError(f"{path}: unpacks to more than {_LARGEST >> 20} MiB")
    return inside
