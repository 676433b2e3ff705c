"""Sequences of others: folders of pictures and films, with the boxes that were drawn by hand.

A benchmark is known by where its boxes lie, not by its name:

| boxes | pictures | of |
|---|---|---|
| `S/groundtruth.txt` | `S/`, `S/img/`, `S/imgs/`, `S/color/` | GOT-10k, LaSOT, VOT, TNL2K |
| `S/groundtruth_rect.txt`, `S/groundtruth_rect.2.txt` | `S/img/` | OTB, DTB70 |
| `S/gt/gt.txt` | the `imDir` of `S/seqinfo.ini`, or `S/img1/` | MOTChallenge |
| `<folder>/S.txt`, `S_gt.txt`, `S_gt_whole.txt` | the folder `S` | UAV123, UAVDT, VisDrone, ... |

A row is left, top, width, height [pixels]; or a polygon of four corners; or VOT's mask; or frame,
id, left, top, width, height and more: then each object is a sequence. Numbers are taken as they are
written, as the tools of these benchmarks do, although some count pixels from 1.
"""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from configparser import ConfigParser, Error
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from eyas.datasets.tracking.clip import Clip, Floats, Mask, Picture, by_sizes
from eyas.engine.core.codecs.pyav import pyav
from eyas.engine.core.decoding import any_picture
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import read_limited, refusals

PICTURES = frozenset({".jpg", ".jpeg", ".png", ".bmp", ".webp", ".tif", ".tiff"})
FILMS = frozenset({".mp4", ".avi", ".mov", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg"})

_DEEPEST = 7  # Folders below the one that is named; LaSOT in a folder of benchmarks has five
_MOST_ENTRIES = 8_000_000  # TrackingNet has 14 million pictures in 12 parts
_LARGEST = 1 << 28  # Largest file of a picture [bytes]
_LARGEST_TEXT = 1 << 26  # Largest file of boxes [bytes]; the densest of MOTChallenge has 30 MB
_MOST_ROWS = 2_000_000  # Of a file of boxes
_MOST_PIXELS = 100_000_000  # Of a frame of a film
_MOST_FRAMES = 1_000_000  # Of one sequence
_SHORTEST = 25  # Frames of an object of a file of many objects that make a sequence
_INSIDE = ("img", "imgs", "img1", "color", "frames", "images", "rgb", "")
"""Folders of pictures beside a file of boxes, in the order in which they are looked for."""

_STARTS = {"David": 300}
"""First frame of the boxes of OTB's sequences that have pictures before them, by its authors' list
(its others with fewer boxes than pictures begin with the first)."""


@dataclass(frozen=True)
class Truth:
    """Boxes of one object, frame by frame.

    Attributes:
        name: What tells it from other objects of the same pictures; empty: there is no other.
        first: Number of the first frame among the pictures, from 0.
        boxes: Left, top, width, height [pixels]; NaN where they are not known, shape (T, 4).
        visible: Visible share of it, NaN where it is not known, shape (T,).
    """

    name: str
    first: int
    boxes: Floats
    visible: Floats


@dataclass
class PictureSequence(Clip):
    """A sequence that lies in a folder, a picture a frame.

    Attributes:
        name: Name of its boxes' file in the results.
        files: The pictures, in their order.
        truth: The boxes; fewer than pictures: the rest is tracked and not scored.
        fps: Pictures a second [Hz]; None: not known.
    """

    name: str
    files: Sequence[Path]
    truth: Truth
    fps: float | None = None
    split: str = ""

    def __len__(self) -> int:
        return len(self.files)

    def pictures(self) -> Iterator[Picture]:
        """Yield the pictures, each uint8, shape (H, W, 3)."""
        for path in self.files:
            yield any_picture(path, _LARGEST)

    @cached_property
    def size(self) -> tuple[int, int]:
        """Width and height of the first picture [pixels]."""
        height, width = any_picture(self.files[0], _LARGEST).shape[:2]
        return width, height

    @cached_property
    def boxes(self) -> Floats:
        """Left, top, width, height [pixels]; NaN where they are not known, shape (T, 4)."""
        known = np.full((len(self), 4), np.nan)
        known[: len(self.truth.boxes)] = self.truth.boxes[: len(self)]
        return known

    @cached_property
    def visible(self) -> Mask:
        """Whether there is a box, and something of the target to see, shape (T,)."""
        sides = np.nan_to_num(self.boxes[:, 2:])
        seen: Mask = (sides > 0.0).all(axis=1) & ~(self._shares <= 0.0)
        return seen

    @cached_property
    def _shares(self) -> Floats:
        shares = np.full(len(self), np.nan)
        shares[: len(self.truth.visible)] = self.truth.visible[: len(self)]
        return shares

    def strata(self) -> Mapping[str, Mapping[str, Mask]]:
        """Return for each criterion its values, and which frames have each, shape (T,)."""
        shares = self._shares
        found = by_sizes(np.nan_to_num(self.boxes), self.fps)
        if np.isnan(shares).all():
            return found
        kinds = {
            "whole": shares >= 0.999,
            "half or more": (shares >= 0.5) & (shares < 0.999),
            "less than half": (shares > 0.0) & (shares < 0.5),
        }
        return {"visible": kinds, **found}


@dataclass
class Film(PictureSequence):
    """A film: `files` are `frames` times its path."""

    path: Path = field(default_factory=Path)

    def pictures(self) -> Iterator[Picture]:
        """Yield the pictures, each uint8, shape (H, W, 3)."""
        for number, frame in enumerate(_decoded(self.path)):
            if self.truth.first <= number < self.truth.first + len(self):
                yield frame.to_ndarray(format="rgb24")

    @cached_property
    def size(self) -> tuple[int, int]:
        """Width and height of its pictures [pixels]."""
        frame = next(iter(_decoded(self.path)))
        return frame.width, frame.height


def _decoded(path: Path) -> Iterator[Any]:
    av = pyav("a film as a sequence")
    try:
        with av.open(str(path), mode="r") as container:
            stream = container.streams.video[0]
            codec = stream.codec_context
            if codec is None:
                raise DataFileError(f"{path}: its codec is not known")
            if codec.width * codec.height > _MOST_PIXELS:
                raise DataFileError(f"{path}: has frames of {codec.width} x {codec.height}")
            yield from container.decode(stream)
    except (av.error.FFmpegError, OSError, ValueError, IndexError) as error:
        reason = getattr(error, "strerror", None) or error
        raise DataFileError(f"{path}: cannot read: {reason}") from error


def sequences_in(
    place: Path,  # A folder, or a film
    truth: Path | None = None,  # The file of its boxes, if it lies elsewhere
    box: Sequence[float] | None = None,  # The target's box in the first frame
) -> list[PictureSequence]:
    """Return the sequences of a folder or of a film.

    Raises:
        DataFileError: There is none, or a file of one is damaged; one line.
        ConfigError: `truth` and `box` are not those of one sequence.
    """
    if truth is not None and box is not None:
        raise ConfigError("--truth, --box: one of the two")
    if place.suffix.lower() in FILMS and place.is_file():
        return _named_film(place, truth, box)
    if truth is not None or box is not None:
        files = _pictures_of(place)
        if not files:
            raise DataFileError(f"{place}: has no pictures (and is no film), for --truth or --box")
        joined = _joined(place.resolve().name, files, _given(truth, box), place)
        if not joined:
            raise DataFileError(f"{truth}: no object lasts {_SHORTEST} frames")
        return joined
    return _found(place)


def _given(truth: Path | None, box: Sequence[float] | None) -> list[Truth]:
    if truth is not None:
        return read_truth(truth)
    if box is None:
        raise ConfigError("--truth or --box is needed for a film: which target is followed?")
    return [Truth("", 0, np.array([box], np.float64), np.full(1, np.nan))]


def _named_film(path: Path, truth: Path | None, box: Sequence[float] | None) -> list[Any]:
    known = _given(truth, box)
    count = 0
    for count, _ in enumerate(_decoded(path), 1):
        if count > _MOST_FRAMES:
            raise DataFileError(f"{path}: has more than {_MOST_FRAMES} frames")
    rate = _film_rate(path)
    films = []
    for each in known:
        length = count - each.first
        if truth is not None:
            length = min(length, len(each.boxes))
        if length > 1:
            name = "-".join(filter(None, (path.stem, each.name)))
            films.append(Film(name, [path] * length, each, rate, path=path))
    if not films:
        raise DataFileError(f"{truth or path}: no object that lasts {_SHORTEST} frames of the film")
    return films


def _film_rate(path: Path) -> float | None:
    with pyav("a film as a sequence").open(str(path), mode="r") as container:
        rate = container.streams.video[0].average_rate
    return float(rate) if rate else None


def _found(place: Path) -> list[PictureSequence]:
    """Return what a walk through the folder finds, in the order of names."""
    pictures, texts = _walked(place)
    parts = _uav123_parts(texts)
    by_name: dict[str, list[Path]] = {}
    for each in pictures:
        by_name.setdefault(each.name, []).append(each)
    sequences: list[PictureSequence] = []
    for text in texts:
        match = _pictures_for(text, pictures, by_name, parts)
        if match is None:
            continue
        name, inside, span = match
        files = _pictures_of(inside)[span]
        rate = _rate_of(text.parent.parent if text.parent.name == "gt" else text.parent)
        for sequence in _joined(name, files, read_truth(text), text):
            sequence.fps = rate
            folders = text.relative_to(place).parts
            sequence.split = next((f for f in folders if f in ("train", "val", "test")), "")
            sequences.append(sequence)
    if not sequences:
        advice = (
            "has pictures, but no boxes beside them (or of no object that lasts "
            f"{_SHORTEST} frames): name the folder that holds both, --truth or --box"
            if pictures
            else "neither a recording of Eyas (no config.json) nor a folder of sequences: "
            "docs/tracking-offline.md has the forms"
        )
        raise DataFileError(f"{place}: {advice}")
    return _unlike(sequences, place)


def _walked(place: Path) -> tuple[list[Path], list[Path]]:
    """Return the folders with two pictures or more, and the files of text, in order of names."""
    pictures, texts, entries = [], [], 0
    with refusals(place):
        for folder, inside, names in os.walk(place):
            here = Path(folder)
            inside.sort()
            if len(here.relative_to(place).parts) >= _DEEPEST:
                inside.clear()
            entries += len(names)
            if entries > _MOST_ENTRIES:
                raise DataFileError(f"{place}: more than {_MOST_ENTRIES} files; name a part of it")
            if sum(os.path.splitext(name)[1].lower() in PICTURES for name in names) > 1:
                pictures.append(here)
            texts += [here / name for name in sorted(names) if name.endswith((".txt", ".m"))]
    return pictures, texts


def _pictures_for(
    text: Path,
    pictures: Sequence[Path],
    by_name: Mapping[str, list[Path]],
    parts: Mapping[str, tuple[str, slice]],
) -> tuple[str, Path, slice] | None:
    """Return name, folder and range of the pictures whose boxes a file holds; None: none."""
    everything, stem = slice(None), text.stem
    if (text.parent.name, text.name) == ("gt", "gt.txt"):
        base = text.parent.parent
        inside = _facts(base / "seqinfo.ini").get("imdir", "img1")
        return (base.name, base / inside, everything) if base / inside in pictures else None
    if re.fullmatch(r"groundtruth(_rect)?(\.\d+)?", stem):
        base = text.parent
        number = stem.partition(".")[2]
        for inside in _INSIDE:
            if (base / inside) in pictures:
                return f"{base.name}{number and '-' + number}", base / inside, everything
        return None
    if text.suffix != ".txt":
        return None
    if stem.endswith("_gt") and f"{stem}_whole" in {each.stem for each in text.parent.iterdir()}:
        return None  # UAVDT has both; the whole one has what is hidden, too
    name = re.sub(r"_gt(_whole)?$", "", stem)
    folder, span = parts.get(name, (name, everything))
    beside = [each for each in by_name.get(folder, ()) if each != text.parent]
    return (name, beside[0], span) if len(beside) == 1 else None


def _uav123_parts(texts: Sequence[Path]) -> dict[str, tuple[str, slice]]:
    """Return UAV123's sequences that are parts of others, by the list that comes with it."""
    form = (
        r"'name',\s*'(\w+)'.*?data_seq[\\/]+\w+[\\/]+(\w+)[\\/]*'"
        r".*?'startFrame',\s*(\d+),\s*'endFrame',\s*(\d+)"
    )
    parts = {}
    for path in texts:
        if path.name == "configSeqs.m":
            content = read_limited(path, _LARGEST_TEXT).decode("latin-1")
            for name, folder, first, last in re.findall(form, content):
                parts[name] = (folder, slice(max(int(first[:9]) - 1, 0), int(last[:9])))
    return parts


def _pictures_of(folder: Path) -> list[Path]:
    """Return the pictures of a folder in the order of the numbers in their names."""
    with refusals(folder):
        names = [each.name for each in os.scandir(folder)] if folder.is_dir() else []
    chosen = [name for name in names if os.path.splitext(name)[1].lower() in PICTURES]
    if len(chosen) > _MOST_FRAMES:
        raise DataFileError(f"{folder}: has more than {_MOST_FRAMES} pictures")

    def in_order(name: str) -> tuple[list[int], str]:
        return [int(digits) for digits in re.findall(r"\d{1,18}", name)], name

    return [folder / name for name in sorted(chosen, key=in_order)]


def _joined(
    name: str, files: Sequence[Path], truths: Sequence[Truth], source: Path
) -> list[PictureSequence]:
    """Return the sequences of the objects in one folder of pictures."""
    joined = []
    for truth in truths:
        first = truth.first
        if len(truth.boxes) < len(files) and not truth.name:
            first = _STARTS.get(name, 1) - 1
        # One box only, as in the test sets whose truth is kept back: all is tracked.
        count = len(truth.boxes) if len(truth.boxes) > 1 else len(files)
        chosen = files[first : first + count]
        if len(chosen) > 1:
            whole = "-".join(filter(None, (name, truth.name)))
            joined.append(PictureSequence(whole, chosen, truth))
    if truths and not joined:
        raise DataFileError(f"{source}: no boxes for any two of the {len(files)} pictures")
    return joined


def _unlike(sequences: list[PictureSequence], place: Path) -> list[PictureSequence]:
    """Number the sequences that share a name."""
    seen: dict[str, int] = {}
    for sequence in sequences:
        seen[sequence.name] = count = seen.get(sequence.name, 0) + 1
        if count > 1:
            sequence.name += f"--{count}"
    return sequences


def read_truth(path: Path) -> list[Truth]:
    """Return the objects of a file of boxes.

    Raises:
        DataFileError: It cannot be read; one line with the number of the row.
    """
    rows = read_limited(path, _LARGEST_TEXT).decode("utf-8-sig", "replace").splitlines()
    while rows and not rows[-1].strip():
        rows.pop()
    if not 0 < len(rows) <= _MOST_ROWS:
        more = f"more than {_MOST_ROWS:,} rows" if rows else "no boxes"
        raise DataFileError(f"{path}: has {more}")
    values = [_numbers(row, f"{path}: line {number}") for number, row in enumerate(rows, 1)]
    width = max(map(len, values))
    if width >= 9 or path.name == "gt.txt":
        return _objects(path, values)
    boxes = np.array([_box(row) for row in values])
    if not (np.abs(boxes[~np.isnan(boxes)]) <= 1e7).all():
        raise DataFileError(f"{path}: has a box beyond 10,000,000 pixels")
    return [Truth("", 0, boxes, _shares_beside(path, len(boxes)))]


def _numbers(row: str, where: str) -> list[float]:
    if row.startswith("m"):  # a mask of VOT from 2020 on
        return _mask_box(row[1:], where)
    cells = re.split(r"[,;\s]+", row.strip().strip(",;"))
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        raise DataFileError(
            f"{where}: {row.strip()!r:.80} is not a box: left,top,width,height"
        ) from None


def _mask_box(row: str, where: str) -> list[float]:
    """Return the box of a mask: left, top, width, height, lengths of runs, an empty one first."""
    try:
        left, top, width, height, *runs = (int(cell) for cell in row.split(","))
        if not (0 <= width * height <= 1 << 26 and 0 <= sum(runs) <= width * height):
            raise ValueError
        if min((*runs, 0)) < 0 or max(abs(left), abs(top)) > 10_000_000:
            raise ValueError
    except ValueError:
        raise DataFileError(f"{where}: {row!r:.60} is not a mask of VOT") from None
    inside = np.zeros(width * height, np.bool_)
    inside[: sum(runs)] = np.repeat(np.arange(len(runs)) % 2 == 1, runs)
    rows, columns = np.nonzero(inside.reshape(height, width))
    if not len(rows):
        return [np.nan] * 4
    low = left + int(columns.min()), top + int(rows.min())
    return [*low, int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1]


def _box(row: Sequence[float]) -> list[float]:
    """Return left, top, width, height of a row; NaN for those that say that there is none."""
    if len(row) == 4:
        return list(row)
    if len(row) >= 6 and len(row) % 2 == 0:  # a polygon
        x, y = row[::2], row[1::2]
        return [min(x), min(y), max(x) - min(x), max(y) - min(y)]
    return [np.nan] * 4  # VOT's "0" to "4": a frame without a target


def _objects(path: Path, rows: Sequence[Sequence[float]]) -> list[Truth]:
    """Return those objects of MOTChallenge, VisDrone and UAVDT that count and last long enough."""
    length = min(map(len, rows))
    if length < 6:
        raise DataFileError(
            f"{path}: has rows of fewer than 6 numbers: frame,id,left,top,width,height"
        )
    table = np.array([row[:length] for row in rows], np.float64)
    numbers = table[:, :2]
    if not (np.abs(table[:, :6]) <= 1e7).all() or (numbers != np.round(numbers)).any():
        raise DataFileError(f"{path}: has frames or ids that are no whole numbers, or absurd boxes")
    if length >= 7:
        table = table[table[:, 6] != 0.0]  # 0: not counted
    table = table[(table[:, 0] >= 0) & (table[:, 0] <= _MOST_FRAMES)]
    # MOTChallenge ends in the visible share, VisDrone in 0, 1, 2: whole, half, less.
    last = table[:, -1]
    shares = np.full(len(table), np.nan)
    if length == 9 and ((last >= 0.0) & (last <= 1.0)).all():
        shares = last
    elif length == 10 and np.isin(last, (0.0, 1.0, 2.0)).all():
        shares = 1.0 - 0.4 * last
    origin = 0 if (table[:, 0] == 0).any() else 1
    objects = []
    for which in np.unique(table[:, 1]):
        mine = table[:, 1] == which
        frames = table[mine, 0].astype(np.int64) - origin
        first, count = int(frames.min()), int(np.ptp(frames)) + 1
        if mine.sum() < _SHORTEST:
            continue
        boxes, visible = np.full((count, 4), np.nan), np.full(count, np.nan)
        boxes[frames - first], visible[frames - first] = table[mine, 2:6], shares[mine]
        objects.append(Truth(f"{int(which)}", first, boxes, visible))
    return objects


def _shares_beside(path: Path, count: int) -> Floats:
    """Return the visible shares by the files beside one of boxes: GOT-10k's, LaSOT's, VOT's."""
    shares = np.full(count, np.nan)
    cover = _column(path.parent / "cover.label", count)
    if cover is not None:
        shares = cover / 8.0
    for name in ("absence.label", "full_occlusion.txt", "out_of_view.txt"):
        absent = _column(path.parent / name, count)
        if absent is not None:
            shares = np.where(absent > 0.0, 0.0, shares)
    return shares


def _column(path: Path, count: int) -> Floats | None:
    if not path.is_file():
        return None
    content = read_limited(path, _LARGEST_TEXT).decode("utf-8", "replace")
    try:
        values = np.array([float(cell) for cell in re.split(r"[,\s]+", content.strip())])
    except ValueError:
        raise DataFileError(f"{path}: has something that is no number") from None
    if len(values) != count:
        raise DataFileError(f"{path}: has {len(values)} numbers for {count} boxes")
    return values


def _facts(path: Path) -> Mapping[str, str]:
    if not path.is_file():
        return {}
    parser = ConfigParser(interpolation=None, strict=False)
    try:
        parser.read_string(read_limited(path, 1 << 20).decode("utf-8-sig", "replace"))
    except Error:
        return {}
    return {key: value for part in parser.sections() for key, value in parser[part].items()}


def _rate_of(folder: Path) -> float | None:
    """Return the pictures a second by what MOTChallenge, GOT-10k and VOT write beside them."""
    found = (_facts(folder / name) for name in ("seqinfo.ini", "meta_info.ini"))
    cells = [facts.get("framerate") or facts.get("anno_fps") for facts in found]
    sequence = folder / "sequence"
    if sequence.is_file():
        content = read_limited(sequence, 1 << 20).decode("utf-8", "replace")
        cells += re.findall(r"^fps=(.*)$", content, re.MULTILINE)
    for cell in cells:
        match = re.match(r"\d{1,4}(\.\d{1,9})?", (cell or "").strip())
        if match and float(match[0]) > 0.0:
            return float(match[0])
    return None
