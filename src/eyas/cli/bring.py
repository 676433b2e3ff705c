"""`eyas bring`: what files of others are, what is left out of them, and what makes them usable."""

import json
import pickletools
import shlex
import zipfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from eyas.engine.core.errors import DataFileError, EyasError
from eyas.engine.core.files import refuse_pointer
from eyas.engine.terminal.counts import many

Bounds = tuple[float, float, float, float]  # West, south, east, north [degrees]

_PACE = 9  # Of a car on a track without times [m/s]
_SIMPLER = 20_000  # Triangles to which larger shapes are simplified
_PICKLE = 64 << 20  # Largest pickle whose names are searched [bytes]
_OPERATIONS = 4 << 20  # Largest part of it whose operations are looked at [bytes]
_LEAST = 32  # Side of the smallest pictures that networks are thought to see [pixels]
_MOST = 200  # Files of a folder that are looked at
_AROUND = 300.0  # Streets around a ride on a large place [m]


class Brought(NamedTuple):
    """What a file is."""

    path: Path
    what: str
    notes: tuple[str, ...] = ()  # What is left out or assumed
    commands: tuple[str, ...] = ()  # What uses it
    settings: dict[str, Any] | None = None  # What `--out` writes
    area: Bounds | None = None  # Of a place, and of a track that lies on earth
    pace: str = ""  # Setting of the speed of a track without times


class Refused(NamedTuple):
    """Why a file cannot be used."""

    path: Path
    why: str


Finding = Brought | Refused


def bring(paths: list[Path]) -> list[Finding]:
    """Return what files and folders are; of a folder that is nothing itself, what is in it."""
    found: list[Finding] = []
    for path in paths:
        if not path.exists():
            found.append(Refused(path, f"{path}: cannot read: no such file"))
        elif path.is_dir():
            found += _of_folder(path)
        else:
            found.append(_of_file(path))
    return [*found, *_rides(found)]


def lines(findings: list[Finding]) -> Iterator[str]:
    """Yield findings as they are printed."""
    for one in findings:
        if isinstance(one, Refused):
            yield f"not usable: {one.why}"
            continue
        yield f"{one.path}: {one.what}"
        yield from (f"  note: {note}" for note in one.notes)
        yield from (f"  {command}" for command in one.commands)


def _of_folder(folder: Path) -> list[Finding]:
    from eyas.datasets.tracking.sequences import sequences_in

    quoted = _quoted(folder)
    if any((folder / name).is_file() for name in ("config.json", "dataset.json")):
        what = "a recording of Eyas" if (folder / "config.json").is_file() else "a data set of Eyas"
        uses = (f"eyas track {quoted} --tracker csrt", f"eyas export {quoted} --format coco")
        return [Brought(folder, what, (), uses)]
    try:
        clips = sequences_in(folder)
    except EyasError:
        clips = []
    if clips:
        frames, known = sum(map(len, clips)), sum(int(clip.visible.sum()) for clip in clips)
        what = f"{many(len(clips), 'sequence')} of a tracking benchmark, {frames:,} pictures"
        notes = () if known >= frames else (f"{frames - known:,} pictures without a box",)
        return [Brought(folder, what, notes, (f"eyas track {quoted} --tracker csrt",))]
    inside = sorted(path for path in folder.iterdir() if path.is_file())
    read = [path for path in inside if path.name.lower().endswith(_ENDINGS)]
    found: list[Finding] = [_of_file(path) for path in read[:_MOST]]
    if len(read) > _MOST:
        found.append(Refused(folder, f"{folder}: {len(read) - _MOST} more files are left out"))
    if len(read) < len(inside) or not inside:
        others = many(len(inside) - len(read), "file")
        found.append(Refused(folder, f"{folder}: {others} of no kind that is read"))
    return found


def _of_file(path: Path) -> Finding:
    name = path.name.lower()
    for endings, look in _KINDS:
        if name.endswith(endings):
            try:
                refuse_pointer(path)
                return look(path)
            except EyasError as error:
                return Refused(path, str(error))
    return Refused(path, f"{path}: of no kind that is read: {', '.join(sorted(_ENDINGS))}")


def _map(path: Path) -> Brought:
    from eyas.maps.osm.driving_side import tagged_side, usual_side
    from eyas.maps.osm.importing import LARGEST, middle_of
    from eyas.maps.osm.reader import covered, no_streets, read_osm
    from eyas.maps.osm.streets import is_street

    data = read_osm(path)
    streets = sum(is_street(way.tags) for way in data.ways.values())
    houses = sum("building" in way.tags for way in data.ways.values())
    if not streets:
        raise no_streets(data, str(path))
    area = west, south, east, north = covered(data, None, str(path))
    what = (
        f"a place of OpenStreetMap, {many(streets, 'street')}, {many(houses, 'building')}, "
        f"about latitude {0.5 * (south + north):.4f}, longitude {0.5 * (west + east):.4f}"
    )
    side = tagged_side(data) or usual_side(0.5 * (west + east), 0.5 * (south + north))
    notes, command = [f"traffic keeps {side}"], f"eyas maps import {_quoted(path)}"
    if max(_metres(area)) > LARGEST:
        notes.append(f"larger than {LARGEST / 1000:g} km: a part is imported, such as its middle")
        command += f" --bbox={middle_of(data, area)}"
    uses = (command, f"eyas video --map {_map_name(path)}")
    return Brought(path, what, tuple(notes), uses, area=area)


def _metres(area: Bounds) -> tuple[float, float]:
    """Return width and height of an area [m]."""
    from eyas.engine.world.projection import Projection

    west, south, east, north = area
    middle = Projection(0.5 * (west + east), 0.5 * (south + north))
    (x0, y0), (x1, y1) = middle.metres([(west, south), (east, north)]).tolist()
    return x1 - x0, y1 - y0


def _map_name(path: Path) -> str:
    return path.name.partition(".osm")[0].partition(".pbf")[0]


def _net(path: Path) -> Brought:
    from eyas.maps.files import roads_in
    from eyas.maps.sumo.files import configured, place_of

    net = configured(path).net if path.name.endswith(".sumocfg") else path
    width, height = place_of(roads_in(net), str(net)).size
    what = f"a road network of SUMO, {width:.0f} x {height:.0f} m"
    routes = "its vehicles: --routes FILE.rou.xml, or import its .sumocfg"
    notes = () if net != path else (routes,)
    command = f"eyas maps import {_quoted(path)}"
    name = path.name.split(".")[0]
    return Brought(path, what, notes, (command, f"eyas video --map {name}"))


def _track(path: Path) -> Brought:
    from eyas.engine.custom.tracks import tracks_in
    from eyas.maps.traffic.tables import form_of

    if path.suffix == ".csv" and form_of(path):
        return _vehicles(path)
    tracks = [track for track in tracks_in(path) if len(track.place) > 1]
    if not tracks:
        raise DataFileError(f"{path}: no track of two points or more")
    area: Bounds | None = None
    points = sum(len(track.place) for track in tracks)
    first = tracks[0]
    notes = []
    pace = ""
    if first.time is None:
        notes.append("without times: it goes at custom.speed")
        long, pace = "", f', "speed": {_PACE}'
    else:
        long = f", {float(first.time[-1] - first.time[0]):.0f} s"
    where = "in metres, as they are"
    at = ""
    if first.on_earth:
        whole = np.concatenate([track.place[:, :2] for track in tracks])
        (x, y), (right, top) = whole.min(axis=0).tolist(), whole.max(axis=0).tolist()
        area = x, y, right, top
        east, north = (float(each) for each in first.place[:, :2].mean(axis=0))
        where = f"about latitude {north:.4f}, longitude {east:.4f}"
        notes.append("its map must lie there; elsewhere custom.at puts the first point")
        at = ', "at": [0, 0, 0]'
        if not np.isnan(first.place[:, 2]).all():
            notes.append("altitudes are left out: a target stays on the ground")
    what = f"{many(len(tracks), 'track')}, {many(points, 'point')}{long}, {where}"
    custom = f'{{"trajectory": {json.dumps(str(path))}{at}, "body": "passenger"{pace}}}'
    uses = (
        f"eyas video --set custom={shlex.quote(custom)} --set same_target=true",
        f"eyas video --set video.flight={_quoted(path)} --set video.channels=1"
        + (" --set video.flight_at=[0,0,0]" if at else ""),
    )
    return Brought(path, what, tuple(notes), uses, area=area, pace=pace)


def _vehicles(path: Path) -> Brought:
    from eyas.maps.traffic.tables import read_tracks

    table = read_tracks(path)
    last = max(float(vehicle.time[-1]) for vehicle in table.vehicles)
    count = many(len(table.vehicles), "recorded vehicle")
    notes = [f"left out: {count} {what}" for what, count in table.left_out.items()]
    if table.origin is None:
        notes.append("it lies nowhere on earth: --at says where on the map")
    quoted, made = _quoted(path), _quoted(path.with_suffix(".traffic.npz"))
    uses = (
        f"eyas traffic import {quoted} --map MAP",
        f"eyas video --map MAP --set traffic.recording={made}",
    )
    return Brought(path, f"{count} of a table {table.form}, {last:.0f} s", tuple(notes), uses)


def _shape(path: Path) -> Brought:
    from eyas.cli.targets.check import check
    from eyas.engine.custom.config import CustomConfig

    told, usable = check(str(path), CustomConfig(path="-"), "citystreet")
    more: dict[str, int] = {}
    if not usable and "most_triangles" in " ".join(told):
        more = {"most_triangles": _SIMPLER}
        told, usable = check(str(path), CustomConfig(path="-", **more), "citystreet")
    if not usable:
        why = next(line for line in told if line.startswith("not usable"))
        raise DataFileError(f"{path}: {why.partition(': ')[2].removeprefix(f'{path}: ')}")
    notes = tuple(line.partition(": ")[2] for line in told if line.startswith("note"))
    custom = json.dumps({"mesh": str(path), "behaviour": "wander", **more})
    fewer = f" --most-triangles {_SIMPLER}" if more else ""
    uses = (
        f"eyas video --set custom={shlex.quote(custom)}",
        f"eyas targets show {_quoted(path)}{fewer}",
    )
    return Brought(path, "a shape for a target", notes, uses)


def _network(path: Path) -> Brought:
    if "nanotrack" in path.name.lower():
        raise DataFileError(
            f"{path}: a part of the tracker NanoTrack, which is 'eyas track FOLDER --tracker nano' "
            f"where EYAS_NANOTRACK={_quoted(path.parent)}"
        )
    from eyas.benchmark.policies.onnx import load_onnx

    policy = load_onnx(path, {}, sampled=False)
    what = "a detector, which flies as a box tracker" if "box" in policy.told else "a policy"
    notes = (assumed,) if (assumed := getattr(policy, "assumed", "")) else ()
    uses = [f"eyas evaluate --policy {_quoted(path)}"]
    if "detector" in what:
        uses.append(f"eyas track FOLDER --tracker {_quoted(path)}")
    if notes:
        uses.append(f"eyas policies adapt {_quoted(path)} --out ADAPTED.onnx --scale imagenet")
    return Brought(path, what, notes, tuple(uses))


def _pickle(path: Path) -> Brought:
    note = "it may hold code, which flying it runs: only from somebody whom you trust"
    command = f"eyas evaluate --policy {_quoted(path)}"
    return Brought(path, _what_policy(path), (note,), (command,))


def _what_policy(path: Path) -> str:
    """Return what a file of PyTorch is, by what is in it; nothing is unpickled."""
    names = {"data.pkl"}  # of old versions of PyTorch
    with path.open("rb") as file:
        module = file.read(_PICKLE)
    if zipfile.is_zipfile(path):
        try:
            with zipfile.ZipFile(path) as archive:
                inside = {name.rpartition("/")[2]: name for name in archive.namelist()}
                names = set(inside)
                pickle = inside.get("data.pkl")
                small = pickle and archive.getinfo(pickle).file_size < _PICKLE
                module = archive.read(pickle) if pickle and small else b""
        except (zipfile.BadZipFile, zlib.error, OSError, RuntimeError, ValueError) as error:
            raise DataFileError(f"{path}: a zip file that cannot be read: {error}") from None
    elif path.suffix == ".zip" or not module.startswith(b"\x80"):
        raise DataFileError(f"{path}: neither a zip file nor one of PyTorch")
    if {"data", "policy.pth"} <= names:
        return "a policy of stable-baselines3"
    numbers = _numbers_in(module)
    if numbers is not None:
        raise DataFileError(
            f"{path}: a network without convolutions whose layers take {numbers} numbers at most: "
            f"no picture of {_LEAST} x {_LEAST} or more goes in"
        )
    if names & {"constants.pkl", "archive_format", "archive_version"}:
        return "a policy of PyTorch"
    if "data.pkl" not in names:
        raise DataFileError(
            f"{path}: neither a policy of stable-baselines3 (it has no policy.pth) nor of PyTorch; "
            "unpack other archives"
        )
    if b"_modules" not in module:
        raise DataFileError(
            f"{path}: weights without their network do not fly; export it with torch.onnx.export"
        )
    return "a network of PyTorch"


def _numbers_in(pickle: bytes) -> int | None:
    """Return the largest input of the layers of a network in a pickle, which is not unpickled.

    None: one of them may take pictures, or none is found.
    """
    shapes: list[list[int]] = []
    found: list[int] | None = None  # Numbers since the last reference to a storage
    try:
        for code, value, _ in pickletools.genops(pickle[:_OPERATIONS]):
            if code.name == "BINPERSID":
                found = []
            elif found is not None and isinstance(value, int):
                found.append(value)
            elif found is not None and "TUPLE" in code.name:
                shapes.append(found[1:])  # behind the offset in the storage
                found = None
    except (ValueError, IndexError, UnicodeDecodeError, OverflowError):
        return None
    widest = max((shape[-1] for shape in shapes if len(shape) == 2), default=0)
    several = any(len(shape) > 3 for shape in shapes)
    return None if several or not 0 < widest < 3 * _LEAST**2 else widest


def _film(path: Path) -> Brought:
    from eyas.datasets.tracking.sequences import sequences_in

    (clip,) = sequences_in(path, box=(0.0, 0.0, 1.0, 1.0))
    width, height = clip.size
    rate = f", {clip.fps:g} a second" if clip.fps else ""
    what = f"a film of {len(clip)} pictures, {width} x {height}{rate}"
    command = f"eyas track {_quoted(path)} --tracker csrt --box LEFT,TOP,WIDTH,HEIGHT"
    return Brought(path, what, (), (command,))


def _camera(path: Path) -> Brought:
    from eyas.engine.camera.calibration import read_calibration
    from eyas.engine.camera.config import CameraConfig
    from eyas.engine.core.config import validated

    camera, notes = read_calibration(path)
    validated(CameraConfig, camera, f"{path}")
    model = camera["lens"].get("model", "pinhole")
    what = f"a calibrated camera, {camera['width']} x {camera['height']}, lens {model}"
    said = shlex.quote("camera.lens=" + json.dumps(camera["lens"]))
    sides = " ".join(f"--set camera.{key}={camera[key]}" for key in list(camera)[:3])
    return Brought(
        path, what, tuple(notes), (f"eyas video {sides} --set {said}",), {"camera": camera}
    )


def _json(path: Path) -> Brought:
    from eyas.engine.core.decoding import read_json
    from eyas.engine.settings.file import load_settings

    try:
        whole = read_json(path, 64 << 20)
    except DataFileError:
        whole = {}  # the original's files may have comments
    if isinstance(whole, dict) and whole.get("type") in ("FeatureCollection", "Feature"):
        return _track(path)
    if isinstance(whole, dict) and {"roads", "layers"} & whole.keys():
        command = f"eyas video --map {_quoted(path)}"
        return Brought(path, "a plan of a map", (), (f"eyas maps check {_quoted(path)}", command))
    if isinstance(whole, dict) and {"url", "model"} <= whole.keys():
        from eyas.benchmark.policies.table import open_policy

        open_policy(str(path), {})  # which sends nothing yet
        return Brought(
            path,
            "a model of language and vision behind an endpoint",
            (f"it is sent pictures: {whole['url']}",),
            (f"eyas evaluate --policy {_quoted(path)} --protocol referring",),
        )
    settings = load_settings(path, (), trust=True)
    notes = (f"map {settings.world.map}, weather {settings.world.weather}, "
             f"target {settings.target}",)  # fmt: skip
    return Brought(path, "settings", notes, (f"eyas video --config {_quoted(path)}",))


def _rides(findings: list[Finding]) -> Iterator[Brought]:
    """Yield the ride of each track that comes with the map of its place."""
    from eyas.maps.osm.importing import LARGEST

    brought = [one for one in findings if isinstance(one, Brought) and one.area is not None]
    maps = [one for one in brought if one.what.startswith("a place")]
    for place in maps:
        for one in brought:
            assert one.area is not None
            assert place.area is not None
            if one in maps or not _within(one.area, place.area):
                continue
            custom = f'{{"trajectory": {json.dumps(str(one.path))}, "body": "passenger"{one.pace}}}'
            large = max(_metres(place.area)) > LARGEST
            part = f" --bbox={_around(one.area)}" if large else ""
            uses = (
                f"eyas maps import {_quoted(place.path)}{part}",
                f"eyas video --map {_map_name(place.path)} --set custom={shlex.quote(custom)} "
                "--set same_target=true --set video.channels=1",
            )
            yield Brought(one.path, f"a ride on {place.path.name}", (), uses)


def _within(own: Bounds, area: Bounds) -> bool:
    """Return whether the middle of an area lies within another."""
    x, y = 0.5 * (own[0] + own[2]), 0.5 * (own[1] + own[3])
    return area[0] <= x <= area[2] and area[1] <= y <= area[3]


def _around(area: Bounds) -> str:
    """Return an area with the streets around it, as `--bbox` takes it."""
    from eyas.engine.world.projection import Projection

    west, south, east, north = area
    middle = Projection(0.5 * (west + east), 0.5 * (south + north))
    low, high = middle.metres([(west, south), (east, north)])
    corners = middle.degrees([low - _AROUND, high + _AROUND])
    return ",".join(f"{each:.5f}" for each in corners.ravel().tolist())


def _quoted(path: Path) -> str:
    return shlex.quote(str(path))


def _kinds() -> tuple[tuple[tuple[str, ...], Callable[[Path], Brought]], ...]:
    from eyas.datasets.tracking.sequences import FILMS
    from eyas.engine.custom.config import ENDINGS
    from eyas.engine.custom.tracks import endings

    return (
        ((".osm", ".osm.gz", ".osm.bz2", ".osm.pbf", ".pbf"), _map),
        ((".net.xml", ".net.xml.gz", ".sumocfg"), _net),
        (tuple(FILMS), _film),
        ((".onnx",), _network),
        ((".zip", ".pt", ".pth", ".pt2"), _pickle),
        (tuple(ENDINGS), _shape),
        (endings(), _track),
        ((".yaml", ".yml", ".xml"), _camera),
        ((".json",), _json),
    )


_KINDS = _kinds()
_ENDINGS = tuple(dict.fromkeys(ending for endings, _ in _KINDS for ending in endings))
