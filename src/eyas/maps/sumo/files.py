"""SUMO's files of others: networks, moved to the middle, and their traffic, from the start on."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from eyas.engine.core.decoding import gunzipped
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.traffic.net_file import SumoNet
from eyas.maps.sumo.projection import NetProjection, projection_of_net

_LARGEST = 512 << 20  # Largest file, packed and unpacked [bytes]

_FARTHEST = 1e8  # Largest coordinate, of whatever projection [m]

_SHAPES = ("shape", "customShape", "outlineShape")

_KEPT = ("vType", "vTypeDistribution", "route", "routeDistribution", "vehicle", "trip", "flow")
"""Elements of route files that are used; detectors would write files, and people walk by our own
rules."""

_BEGINS = ("depart", "begin", "end")  # Attributes that hold a time


class SumoFiles(NamedTuple):
    """The files of a simulation."""

    net: Path
    routes: tuple[Path, ...] = ()
    begin: float = 0.0  # [s]


def configured(path: Path) -> SumoFiles:
    """Return what a `.sumocfg` names.

    Raises:
        DataFileError: It is damaged, or names no network.
    """
    root = _root(path)
    values = {one.tag: one.get("value", one.get("v", "")) for one in root.iter()}
    net = values.get("net-file", values.get("net", ""))
    if root.tag not in ("configuration", "sumoConfiguration") or not net:
        raise DataFileError(f"{path}: not a configuration of SUMO with a net-file")
    named = f"{values.get('additional-files', '')},{values.get('route-files', '')}"
    routes = tuple(path.parent / one.strip() for one in named.split(",") if one.strip())
    return SumoFiles(path.parent / net, routes, seconds(values.get("begin", "0"), path))


def seconds(text: str, path: Path) -> float:
    """Return a time as SUMO writes it, in seconds or as `hours:minutes:seconds`."""
    try:
        parts = [float(part) for part in text.lstrip("-").split(":")]
        sign = -1.0 if text.startswith("-") else 1.0
        units = (1.0, 60.0, 3600.0)
        told = zip(reversed(parts[-3:]), units, strict=False)
        return sign * sum(part * unit for part, unit in told)
    except ValueError:
        raise DataFileError(f"{path}: {text!r:.40} is not a time") from None


class Place(NamedTuple):
    """Where a network lies, before it is moved."""

    middle: tuple[float, float]  # In the file's own metres
    size: tuple[float, float]  # Extent of its streets [m]
    projection: NetProjection | None  # To metres about its middle; None: it lies nowhere known


def place_of(xml: bytes, source: str) -> Place:
    """Return where the streets of a network lie.

    Raises:
        DataFileError: It is not a network of SUMO, or has no streets.
    """
    net = SumoNet(xml, source)
    try:
        lanes = [lane.points for edge in net.edges if edge.function is None for lane in edge.lanes]
        points = np.concatenate([line for line in lanes if len(line)] or [np.zeros((0, 2))])
        location = next(ElementTree.fromstring(xml).iter("location"), None)
    except (ValueError, IndexError) as error:
        raise net.error(f"a shape: {error}") from None
    if not len(points):
        raise DataFileError(f"{source}: has no streets")
    if not (np.abs(points) <= _FARTHEST).all():  # also what is no number: it is not
        raise net.error(f"a place beyond {_FARTHEST / 1000:g} km")
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = np.round(0.5 * (low + high), 2).tolist()
    width, height = (high - low).tolist()
    projection = None if location is None else projection_of_net(location.attrib, (x, y))
    return Place((x, y), (width, height), projection)


def moved(xml: bytes, by: tuple[float, float], source: str) -> bytes:
    """Return a network, from `place_of`, moved east and north [m]; nothing else is changed.

    Raises:
        DataFileError: One of its places is no number.
    """
    root = ElementTree.fromstring(xml)
    try:
        for one in root.iter():
            _move(one, by)
    except (ValueError, IndexError) as error:
        raise DataFileError(f"{source}: not a network of SUMO: a place: {error}") from None
    return bytes(ElementTree.tostring(root, encoding="utf-8")) + b"\n"


def _move(one: ElementTree.Element, by: tuple[float, float]) -> None:
    for name in _SHAPES:
        if name in one.attrib:
            one.set(name, " ".join(_moved(pair, by) for pair in one.attrib[name].split()))
    if one.tag == "junction" and "x" in one.attrib:
        for name, step in zip("xy", by, strict=True):
            one.set(name, f"{float(one.attrib.get(name, '')) + step:.3f}")
    if one.tag == "location":
        for name in ("netOffset", "convBoundary"):
            pairs = one.get(name, "").split(",")
            ends = [",".join(pairs[k : k + 2]) for k in range(0, len(pairs) - 1, 2)]
            one.set(name, ",".join(_moved(pair, by) for pair in ends))


def _moved(pair: str, by: tuple[float, float]) -> str:
    x, y, *height = pair.split(",")
    return ",".join([f"{float(x) + by[0]:.3f}", f"{float(y) + by[1]:.3f}", *height])


def demand_of(files: SumoFiles, left_out: Callable[[str], None]) -> bytes:
    """Return the vehicles of route files as one, their times counted from the beginning.

    Raises:
        DataFileError: A file is missing or damaged, or none has a vehicle.
    """
    whole = ElementTree.Element("routes")
    for path in files.routes:
        for one in _root(path):
            if one.tag in _KEPT:
                whole.append(one)
            else:
                left_out(f"<{one.tag}>")
    path = files.routes[0]
    enters = [one for one in whole if one.tag in ("vehicle", "trip", "flow")]
    if not enters:
        raise DataFileError(f"{path}: has no vehicles")
    starts = [_time(one, ("depart", "begin"), path) for one in enters]
    # A simulation that begins earlier waits for the first vehicle.
    begin = max(files.begin, min(starts))
    for one in whole.iter():
        for name in _BEGINS:
            if one.tag in ("vehicle", "trip", "flow") and _is_time(one.get(name, "")):
                one.set(name, f"{seconds(one.attrib[name], path) - begin:.2f}")
    starts = [_time(one, ("depart", "begin"), path) for one in enters]
    for one, start in zip(enters, starts, strict=True):
        gone = one.tag != "flow" and start < 0.0
        if gone or _time(one, ("end",), path, 1.0) <= 0.0:
            left_out("vehicles from before the beginning")
            whole.remove(one)
        elif start < 0.0:
            one.set("begin", "0.00")
    # SUMO leaves out what is not in the order of its times; classes and routes come first.
    whole[:] = sorted(whole, key=lambda one: _time(one, ("depart", "begin"), path, -1.0))
    return bytes(ElementTree.tostring(whole, encoding="utf-8"))


def _time(
    one: ElementTree.Element, names: tuple[str, ...], path: Path, usual: float = 0.0
) -> float:
    found = (one.get(name, "") for name in names)
    return next((seconds(text, path) for text in found if _is_time(text)), usual)


def _is_time(text: str) -> bool:
    return text.lstrip("-")[:1].isdigit()  # not `triggered`, nor absent


def _root(path: Path) -> ElementTree.Element:
    content = read_limited(path, _LARGEST)
    try:
        text = gunzipped(content, _LARGEST) if content[:2] == b"\x1f\x8b" else content
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise DataFileError(f"{path}: not a readable file of SUMO: {error}") from None
