"""A format: one layout of files that other tools read.

    Format(job)                     once
      add(episode)                  for each episode; all files that are of it alone
      finish(episodes)              once: the files that are of several, from what `add` has kept

An export that was interrupted goes on: `add` is not called again for an episode that it has
finished. What `finish` needs of an episode is kept in a file (`ExportJob.keep`, `ExportJob.kept`).
"""

import json
import os
import shutil
from abc import abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Protocol

from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import atomic_path, refusals, write_atomic
from eyas.engine.core.registry import Registry
from eyas.engine.exports.label import FIELDS, Label
from eyas.engine.recordings.recording import RecordedEpisode, RecordedFrame
from eyas.engine.state.scene import ObjectClass

CLASS_NAMES = {
    ObjectClass.CAR: "car",
    ObjectClass.TRUCK: "truck",
    ObjectClass.BUS: "bus",
    ObjectClass.MOTORCYCLE: "motorcycle",
    ObjectClass.PERSON: "person",
    ObjectClass.ROBOT: "robot",
    ObjectClass.BICYCLE: "bicycle",
    ObjectClass.BOAT: "boat",
    ObjectClass.TRAIN: "train",
}
"""Names of the classes of labelled objects, in the order of the formats that number classes."""

KEPT = ".kept"  # Folder of what `add` keeps for `finish`, in the folder of the export


class Exported(NamedTuple):
    """An episode, as far as `Format.finish` knows it."""

    name: str
    split: str  # `train`, `val` or `test`; `train` outside of a data set
    frames: int


class SeenObject(NamedTuple):
    """A moving or parked object in a frame: the target, or another one."""

    label: Label  # By the names of the entries of `others`: `id`, `box`, `words`, ...
    is_target: bool

    @property
    def name(self) -> str:
        """Name of its class."""
        return CLASS_NAMES[ObjectClass(self.label["class_id"])]


def objects_of(frame: Label) -> Iterator[SeenObject]:
    """Yield the objects of which a pixel is visible, in the order of their ids."""
    target = {name: frame[key] for name, key in _TARGET_KEYS.items() if key in frame}
    seen = [SeenObject(other, is_target=False) for other in frame["others"]]
    if target["visible_fraction"] > 0.0:
        seen.append(SeenObject(target, is_target=True))
    yield from sorted(seen, key=lambda each: int(each.label["id"]))


_TARGET_KEYS = {field.others: field.key for field in FIELDS if field.others and field.key}
"""The name of each field of a moving object in `others`, and that of the target."""


@dataclass(frozen=True, slots=True)
class ExportJob:
    """An export: folder, name, and the options of its user.

    Attributes:
        folder: The folder of the export.
        name: Name of what is exported, for formats that ask for one: that of its folder.
        copies: Whether pictures are copied; else they are hard links to those of the recording.
        least_side: Objects whose box is narrower or lower are ignored: left out, or marked where
            the format has a mark for it [pixels].
        least_visible: The same for those of which a smaller share is visible.
        ignore_parked: Whether parked objects are ignored, too.
    """

    folder: Path
    name: str
    copies: bool = False
    least_side: int = 1
    least_visible: float = 0.0
    ignore_parked: bool = False

    def place(self, picture: Path, inside: str) -> None:
        """Put a picture of the recording into the export.

        Args:
            picture: The picture.
            inside: Its path in the export, with `/`.

        Raises:
            OutputError: It cannot be written.
        """
        path = self.folder / inside
        with refusals(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            if not self.copies:
                try:
                    path.unlink(missing_ok=True)
                    os.link(picture, path)
                except OSError:  # another file system, or one without hard links
                    pass
                else:
                    return
        with atomic_path(path) as part:
            shutil.copyfile(picture, part)

    def place_all(
        self,
        episode: RecordedEpisode,  # The episode
        folder: str,  # The folder's path in the export
        first: int,  # Number of the first picture
        digits: int,  # Digits of the numbers
        prefix: str = "",  # What stands before the numbers
    ) -> None:
        """Put the pictures of an episode into a folder of the export."""
        ending = picture_ending(episode)
        for frame in episode:
            name = f"{prefix}{numbered(frame, first, digits, ending)}"
            self.place(episode.picture_file(frame.number), f"{folder}/{name}")

    def write(self, inside: str, content: str | bytes) -> None:
        """Write a file of the export, completely or not at all; `inside`: its path in it.

        Raises:
            OutputError: It cannot be written.
        """
        path = self.folder / inside
        with refusals(path):
            path.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(path, content.encode() if isinstance(content, str) else content)

    def keep(self, episode: RecordedEpisode, what: Any) -> None:  # noqa: ANN401  # JSON
        """Keep what `finish` needs of an episode."""
        self.write(f"{KEPT}/{episode.name}.json", json.dumps(what, allow_nan=False))

    def kept(self, name: str) -> Any:  # noqa: ANN401  # JSON
        """Return what was kept of the episode with this name.

        Raises:
            DataFileError: It is not what was kept.
        """
        path = self.folder / KEPT / f"{name}.json"
        try:
            return read_json(path, 1 << 30, "what was kept")
        except DataFileError as error:
            raise DataFileError(f"{error}; start again with --overwrite") from None

    def settle(self, kept: str, inside: str) -> None:
        """Give a file that `add` has kept its final place; may be called twice.

        Args:
            kept: Its name among what is kept.
            inside: Its path in the export, with `/`.

        Raises:
            OutputError: It cannot be moved.
        """
        source, path = self.folder / KEPT / kept, self.folder / inside
        with refusals(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            if source.exists():  # else an interrupted run has moved it
                source.replace(path)

    def ignores(self, seen: SeenObject) -> bool:
        """Return whether an object does not count: it is too small, too much hidden, or parked."""
        if self.ignore_parked and "parked" in seen.label:
            return True
        left, top, right, bottom = seen.label["box"]
        small = min(right - left, bottom - top) < self.least_side
        return small or bool(seen.label["visible_fraction"] < self.least_visible)


class Format(Protocol):
    """One layout of files. A subclass may omit `__init__` and `finish`."""

    needs: ClassVar[AbstractSet[str]]
    """Names of the writers whose files it is made of; `jpeg` stands for pictures of any kind."""
    first_sight: ClassVar[bool] = False
    """Whether episodes begin with the first frame in which the target is visible, as one-pass
    trackers need it; an episode in which it never is is left out."""
    job: ExportJob
    """The export that is written."""

    def __init__(self, job: ExportJob) -> None:
        self.job = job

    @abstractmethod
    def add(self, episode: RecordedEpisode) -> None:
        """Write the files that are of one episode alone; may be called twice, if it was
        interrupted.
        """

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the files that are of several episodes."""
        return


def left_top_width_height(box: Sequence[int]) -> tuple[int, int, int, int]:
    """Return a box of the labels as left, top, width, height [pixels]."""
    left, top, right, bottom = box
    return left, top, right - left, bottom - top


def lines(values: Iterable[Any]) -> str:
    """Return a text with a line for each value; a sequence of several is joined by commas."""
    rows = (
        ",".join(map(str, value)) if isinstance(value, tuple | list) else str(value)
        for value in values
    )
    return "".join(f"{row}\n" for row in rows)


def by_split(episodes: Sequence[Exported]) -> dict[str, list[Exported]]:
    """Return the episodes of each split, in the order of the splits."""
    groups: dict[str, list[Exported]] = {}
    for episode in episodes:
        groups.setdefault(episode.split, []).append(episode)
    return groups


def picture_ending(episode: RecordedEpisode) -> str:
    """Return `jpg` or `png`, as the formats name the files of pictures."""
    return {"jpeg": "jpg", "png": "png"}[episode.picture_kind]


def split_of(episode: RecordedEpisode) -> str:
    """Return the split of an episode; `train` outside of a data set."""
    return episode.split or "train"


def numbered(frame: RecordedFrame, first: int, digits: int, ending: str) -> str:
    """Return a name of a frame's picture: its number, counted from `first`."""
    return f"{frame.number + first:0{digits}d}.{ending}"


SETTING = "--format"

FORMATS: Registry[type[Any]] = Registry(SETTING, type, group="eyas.formats")
"""All formats; a user's own is selected by its path, `my_package.module:Class`."""
