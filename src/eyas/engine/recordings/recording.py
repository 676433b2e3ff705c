"""Recordings and data sets, read: episodes, frames, pictures, the arrays of every label.

data = eyas.load("runs/first")
for episode in data:
boxes = episode.array("target_box")            # (T, 4)
for frame in episode:
frame.picture(), frame.label["target_words"]
"""

import io
import re
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.codecs.pyav import pyav
from eyas.engine.core.config import validated
from eyas.engine.core.decoding import decoded_arrays, decoded_picture, read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.core.folder_lock import LOCK
from eyas.engine.exports.checksums import CHECKSUMS, GROWING, read_checksums
from eyas.engine.exports.label import LABELS, Label, read_labels
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import read_settings
from eyas.engine.state.scene import ACTOR_OBJECT, LAST_PARKED

if TYPE_CHECKING:
    from torch.utils.data import Dataset

DATASET_FILE = "dataset.json"  # Contents of a data set, see `eyas.datasets.plan`
SPLITS = ("train", "val", "test")  # Folders of a data set, in the order of its episodes
MASK_OFFSET = ACTOR_OBJECT - 1
"""A mask's value and this make the `id` of what moves; this less the value, of what is parked."""

_LARGEST = 1 << 28  # Largest file of one frame [bytes]
OF_EPISODES = {"labels": LABELS, "mp4": "episode.mp4", "sensors": "sensors.csv"}
"""Files of an episode by their writers; other writers write a file for each frame."""

_EPISODE = re.compile(r"episode(\d+)")
_TRACKER = re.compile(r"(DRONE|CAR)(\d+)")


@dataclass(frozen=True, slots=True)
class RecordedFrame:
    """One frame of an episode; arrays are read from their files at each call."""

    episode: "RecordedEpisode"
    number: int
    """Number in its episode, from 0."""
    label: Label
    """See docs/labels.md."""

    def picture(self) -> NDArray[np.uint8]:
        """Return the picture, sRGB, shape (H, W, 3)."""
        return self._image(self.episode.picture_file(self.number), np.uint8, colours=3)

    def masks(self) -> NDArray[np.int32]:
        """Return for each pixel the label's `id` of the object that it shows, 0 where it shows
        none, shape (H, W).
        """
        path = self.file("masks")
        masks = self._image(path, np.int32)
        parked = masks >= MASK_OFFSET - LAST_PARKED
        np.add(masks, MASK_OFFSET, out=masks, where=(masks != 0) & ~parked)
        np.subtract(MASK_OFFSET, masks, out=masks, where=parked)
        for number, (left, top, right, bottom) in _visible_boxes(self.label):
            if not (masks[top:bottom, left:right] == number).any():
                raise DataFileError(f"{path}: shows nothing of {number}, though its label does")
        return masks

    def classes(self) -> NDArray[np.uint8]:
        """Return the `ObjectClass` of each pixel, shape (H, W)."""
        return self._image(self.file("classes"), np.uint8)

    def depth(self) -> NDArray[np.float32]:
        """Return the distance of each pixel along the optical axis [m], infinity for the sky and
        for what is too far for the file, shape (H, W).
        """
        levels = self._image(self.file("depth"), np.float32)
        unit = np.float32(self.episode.config.video.depth_unit)
        return np.where(levels > 0, levels * unit, np.float32(np.inf))

    def flow(self) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """Return the motion of each pixel to the next frame, right and down [pixels], shape
        (H, W, 2), and whether it is known: where the point is in view there, shape (H, W).
        """
        stored = self._flow_levels(self.file("flow"))
        values = stored.astype(np.float32)
        return (values[..., :2] - 32768.0) / 64.0, stored[..., 2] > 0

    def normals(self) -> NDArray[np.float32]:
        """Return the unit normal of the surface in each pixel, in the camera's frame, shape
        (H, W, 3).
        """
        levels: NDArray[np.float32] = self._image(self.file("normals"), np.float32, colours=3)
        return levels / np.float32(127.5) - np.float32(1)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the lossless arrays: `depth`, `object_id`, `class_id`, each of shape (H, W)."""
        shape = self.episode.size[::-1]
        kinds = {"depth": ("f", 2), "object_id": ("iu", 2), "class_id": ("iu", 2)}
        arrays = decoded_arrays(self.file("arrays"), _LARGEST, "arrays of a frame", kinds)
        for name, array in arrays.items():
            if array.shape != shape:
                raise DataFileError(f"{self.file('arrays')}: '{name}' has shape {array.shape}")
        return arrays

    def file(self, output: str) -> Path:
        """Return the path of one of the frame's files.

        Args:
            output: `jpeg`, `png`, `masks`, `classes`, `depth`, `flow`, `normals` or `arrays`.
        """
        return self.episode.file(output, self.number)

    def _image(self, path: Path, kind: Any, colours: int = 1) -> NDArray[Any]:  # noqa: ANN401
        return decoded_picture(path, _LARGEST, self.episode.size, colours).astype(kind)

    def _flow_levels(self, path: Path) -> NDArray[np.uint16]:
        """Return a PNG of 16 bits and three colours, which Pillow does not read."""
        av = pyav("flow")
        content = read_limited(path, _LARGEST)
        # The size in its header, before FFmpeg makes a picture of it.
        width, height = self.episode.size
        head = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + struct.pack(">II", width, height)
        if not content.startswith(head):
            raise DataFileError(f"{path}: cannot read: not a PNG of {width}x{height} pixels")
        try:
            with av.open(io.BytesIO(content), mode="r", format="png_pipe") as container:
                picture = next(container.decode(video=0))
                stored: NDArray[np.uint16] = picture.to_ndarray(format="rgb48le")
        except (av.error.FFmpegError, OSError, ValueError, EOFError, StopIteration) as error:
            reason = getattr(error, "strerror", None) or error
            raise DataFileError(f"{path}: cannot read: {reason}") from error
        if stored.shape[1::-1] != self.episode.size:
            raise DataFileError(f"{path}: has another size than its header tells")
        return stored


class RecordedEpisode(Sequence[RecordedFrame]):
    """One episode of one tracker.

    Attributes:
        name: `DRONE0-episode0`; in a data set with the part's name before it.
        folder: Its folder.
        split: `train`, `val` or `test`; empty outside of a data set.
        tracker: `DRONE0`, `DRONE1`, ...
        number: Number among the episodes of its tracker.
        config: The settings of its recording.
    """

    def __init__(self, name: str, folder: Path, split: str, config: EyasConfig) -> None:
        self.name, self.folder, self.split, self.config = name, folder, split, config
        self.tracker, self.number = folder.parent.name, int(folder.name.removeprefix("episode"))

    @cached_property
    def labels(self) -> list[Label]:
        """The label of each frame, see docs/labels.md."""
        path = self.folder / LABELS
        labels = read_labels(path)
        if not labels:
            raise DataFileError(f"{path}: has no frames")
        for number, label in enumerate(labels, 1):
            _require_fitting(label, self.size, f"{path}: line {number}")
        return labels

    @property
    def fps(self) -> float:
        """Pictures per second of simulated time [Hz]."""
        return self.config.video.fps

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures [pixels]."""
        return self.config.camera.width, self.config.camera.height

    @cached_property
    def frame_count(self) -> int:
        """Number of frames, without reading the labels."""
        return len(read_limited(self.folder / LABELS, 1 << 30).splitlines())

    def __len__(self) -> int:
        return self.frame_count

    def __getitem__(self, number: Any) -> Any:  # noqa: ANN401  # an index or a slice
        if isinstance(number, slice):
            return [self[one] for one in range(*number.indices(len(self)))]
        if not -len(self) <= number < len(self):
            raise IndexError(number)
        label = self.labels[number]
        return RecordedFrame(self, label["frame"], label)

    def __iter__(self) -> Iterator[RecordedFrame]:
        return (RecordedFrame(self, label["frame"], label) for label in self.labels)

    def array(self, key: str) -> NDArray[Any]:
        """Return a field of all labels as one array; what is null is NaN, shape (T, ...).

        Args:
            key: Name of a field that all labels have.

        Raises:
            DataFileError: The labels have no such field, or it has no fixed shape.
        """
        try:
            values = [label[key] for label in self.labels]
        except KeyError:
            raise DataFileError(f"{self.folder / LABELS}: not all labels have '{key}'") from None
        array = np.array(values)
        return array.astype(np.float64) if array.dtype == object else array

    def file(self, output: str, number: int) -> Path:
        """Return the path of a file of a frame; `output` is the name of its writer."""
        if output in ("jpeg", "png"):
            return self.folder / f"{number:06d}.{output}"
        ending = "npz" if output == "arrays" else "png"
        return self.folder / output / f"{number:06d}.{ending}"

    @cached_property
    def picture_kind(self) -> str:
        """The writer of its pictures: `png` if they were recorded without loss, else `jpeg`.

        Raises:
            DataFileError: It has no pictures.
        """
        for kind in ("png", "jpeg"):
            if self.file(kind, 0).exists():
                return kind
        raise DataFileError(f"{self.folder}: has no pictures; record it with the writer 'jpeg'")

    def picture_file(self, number: int) -> Path:
        """Return the path of the picture of a frame."""
        return self.file(self.picture_kind, number)

    def has(self, output: str) -> bool:
        """Return whether the writer of this name has recorded the episode."""
        if output in OF_EPISODES:
            return (self.folder / OF_EPISODES[output]).exists()
        return self.file(output, 0).exists()


class Recording(Sequence[RecordedEpisode]):
    """All episodes of a recording, or of all recordings of a data set.

    Attributes:
        folder: Its folder.
        episodes: In the order of splits, parts, trackers, numbers.
    """

    def __init__(self, folder: Path, episodes: Sequence[RecordedEpisode]) -> None:
        self.folder, self.episodes = folder, tuple(episodes)

    def __len__(self) -> int:
        return len(self.episodes)

    def __getitem__(self, number: Any) -> Any:  # noqa: ANN401  # an index or a slice
        return self.episodes[number]

    @property
    def frame_count(self) -> int:
        """Number of frames of all episodes."""
        return sum(len(episode) for episode in self.episodes)

    def frames(self) -> Iterator[RecordedFrame]:
        """Yield the frames of all episodes; the labels of one episode are held at a time."""
        for episode in self.episodes:
            fresh = RecordedEpisode(episode.name, episode.folder, episode.split, episode.config)
            yield from fresh

    def split(self, name: str) -> "Recording":
        """Return the episodes of a split: `train`, `val` or `test`."""
        chosen = [episode for episode in self.episodes if episode.split == name]
        return Recording(self.folder, chosen)

    def as_torch(self, *outputs: str) -> "Dataset[dict[str, Any]]":
        """Return a PyTorch data set of all frames, see `eyas.engine.recordings.torch_frames`
        (PyTorch must be installed).

        Args:
            outputs: What each item holds beside `picture` and `label`: `masks`, `depth`, ...
        """
        from eyas.engine.recordings.torch_frames import TorchFrames

        return TorchFrames(self, outputs)


def load(folder: Path | str) -> Recording:
    """Return a recording of `eyas video`, or a data set of `eyas dataset make`.

    Raises:
        DataFileError: The folder holds neither, or a recording that is not complete; one line.
        ConfigError: Its settings are not those of this Eyas; one line.
    """
    root = Path(folder)
    try:
        if (root / DATASET_FILE).is_file():
            return Recording(root, [each for part in _parts(root) for each in part])
        return Recording(root, _episodes(root, "", ""))
    except (OSError, ValueError) as error:  # a name that no file can have
        reason = getattr(error, "strerror", None) or error
        raise DataFileError(f"{root!s:.300}: cannot read: {reason}") from error


def _parts(root: Path) -> Iterator[list[RecordedEpisode]]:
    for part in _table(root / DATASET_FILE, "parts"):
        yield load_part(root, part["split"], part["name"])


def load_part(root: Path, split: str, name: str) -> list[RecordedEpisode]:
    """Return the episodes of one part of a data set.

    Raises:
        DataFileError: It is not a complete recording.
    """
    return _episodes(root / "parts" / split / name, f"{name}-", split)


def _table(path: Path, key: str) -> list[dict[str, Any]]:
    try:
        table: list[dict[str, Any]] = read_json(path, 1 << 28, "a description of a data set")[key]
        for row in table:
            if row["split"] not in SPLITS or not re.fullmatch(r"\w[\w.-]*", row["name"]):
                raise ValueError(f"{key}: {row!r:.200}")
    except (ValueError, TypeError, LookupError) as error:
        raise DataFileError(f"{path}: not a description of a data set: {error}") from None
    return table


def _episodes(folder: Path, prefix: str, split: str) -> list[RecordedEpisode]:
    """Return the episodes of a complete recording, in the order of trackers and numbers."""
    _require_complete(folder)
    config = validated(EyasConfig, read_settings(folder / "config.json"))
    try:
        folders = [
            (int(tracker[2]), int(number[1]), found)
            for found in folder.glob("*/episode*")
            if (number := _EPISODE.fullmatch(found.name))
            and (tracker := _TRACKER.fullmatch(found.parent.name))
        ]
    except OSError as error:
        raise DataFileError(f"{folder}: cannot read: {error.strerror or error}") from error
    return [
        RecordedEpisode(f"{prefix}{found.parent.name}-{found.name}", found, split, config)
        for _, _, found in sorted(folders)
    ]


def _require_complete(folder: Path) -> None:
    if not (folder / "config.json").is_file():
        raise DataFileError(f"{folder}: not a recording: it has no config.json")
    if (folder / LOCK).exists() or (folder / GROWING).exists():
        raise DataFileError(f"{folder}: the recording is in progress, or was interrupted: continue "
                            "it with eyas video --resume")  # fmt: skip
    if not (folder / CHECKSUMS).is_file():
        raise DataFileError(f"{folder}: the recording is not complete: it has no {CHECKSUMS}")
    for name in read_checksums(folder / CHECKSUMS):
        if not (folder / name).is_file():
            raise DataFileError(f"{folder / name}: missing, though {CHECKSUMS} names it")


def _visible_boxes(label: Label) -> Iterator[tuple[int, list[int]]]:
    """Yield id and box of the visible pixels of each object that a label calls visible."""
    if label["visible_fraction"] > 0.0:
        yield label["target_id"], label["target_visible_box"]
    yield from ((other["id"], other["visible_box"]) for other in label["others"])


def _require_fitting(label: Label, size: tuple[int, int], where: str) -> None:
    """Refuse a label of another picture's size, or with a box that is not inside the picture."""
    if (label["width"], label["height"]) != size:
        raise DataFileError(f"{where}: its picture is not {size[0]}x{size[1]} pixels")
    boxes = [label["target_box"], label["target_visible_box"]]
    for other in label["others"]:
        boxes += other["box"], other["visible_box"]
    for box in boxes:
        left, top, right, bottom = box
        if not (left <= right <= size[0] and top <= bottom <= size[1]):
            raise DataFileError(f"{where}: the box {box} is not inside the picture")


def from_first_sight(episode: RecordedEpisode) -> RecordedEpisode | None:
    """Return the rest of an episode, whose frames count from 0 again; None if its target is never
    visible.
    """
    for label in episode.labels:
        if label["visible_fraction"] > 0.0:
            return _TrimmedEpisode(episode, label["frame"]) if label["frame"] else episode
    return None


class _TrimmedEpisode(RecordedEpisode):
    """An episode without its first frames."""

    def __init__(self, whole: RecordedEpisode, skipped: int) -> None:
        super().__init__(whole.name, whole.folder, whole.split, whole.config)
        self._whole, self._skipped = whole, skipped

    @cached_property
    def labels(self) -> list[Label]:
        left = self._whole.labels[self._skipped :]
        return [{**label, "frame": number} for number, label in enumerate(left)]

    @cached_property
    def frame_count(self) -> int:
        return self._whole.frame_count - self._skipped

    def file(self, output: str, number: int) -> Path:
        return self._whole.file(output, number + self._skipped)
