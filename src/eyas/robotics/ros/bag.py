"""Writers of bags of ROS 2, without ROS: a folder for each episode that `ros2 bag` plays."""

import json
import sqlite3
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError, MissingExtraError
from eyas.engine.core.files import part_path, refusals, write_atomic
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.writer import Episode, EpisodeWriter, Files, Run, Summary, Writer
from eyas.robotics.ros.messages import Messages, nanoseconds
from eyas.robotics.ros.types import message_types

if TYPE_CHECKING:
    from mcap.writer import Writer as McapLibrary
    from rosbags.typesys.store import Typestore

_DESCRIPTION = "metadata.yaml"


_VERSION = 8  # Version of the description: the newest that all releases from Humble on read

_LATCHED = (
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    "  deadline: {sec: 9223372036, nsec: 854775807}\n"
    "  lifespan: {sec: 9223372036, nsec: 854775807}\n"
    "  liveliness: 1\n  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}\n"
    "  avoid_ros_namespace_conventions: false"
)
"""Quality of service of what is told once and kept for late listeners: keep the last one, reliable,
transient local."""

_TABLES = """
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(
  id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(
  id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
  serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL,
  type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(
  id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
  encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(
  id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
  data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
INSERT INTO schema(schema_version, ros_distro) VALUES (4, 'jazzy');
"""
"""Tables of rosbag2_storage_sqlite3, schema version 4."""


@dataclass(slots=True)
class Topic:
    """A topic of a bag."""

    name: str
    type: str  # Type of its messages, `package/msg/Name`
    definition: str  # Text of this type and of all types in it
    digest: str  # Hash of the type (REP 2016)
    latched: bool = False  # Whether it is told once and kept for late listeners
    times: list[int] = field(default_factory=list)  # Times of its messages [ns]

    @property
    def quality(self) -> str:
        """Its quality of service, as bags have it."""
        return _LATCHED if self.latched else ""


class Storage(Protocol):
    """The file of a bag, which has another name until it is complete; may raise `OSError`."""

    kind: str  # Name of this kind in descriptions of bags

    def __init__(self, path: Path, topics: Sequence[Topic]) -> None: ...

    def write(self, topic: int, time: int, data: bytes) -> None:
        """Append a message of a topic at a time [ns]."""

    def finish(self) -> None:
        """Complete the file."""

    def abandon(self) -> None:
        """Close the file and delete it."""


class SqliteStorage(Storage):
    """A database of SQLite."""

    kind = "sqlite3"

    def __init__(self, path: Path, topics: Sequence[Topic]) -> None:
        self._path, self._part = path, part_path(path)
        self._part.unlink(missing_ok=True)
        # A file under construction is deleted, not repaired, so it needs no journal. The thread of
        # an episode writes it, another one may abandon it.
        self._base = sqlite3.connect(self._part, isolation_level=None, check_same_thread=False)
        try:
            self._base.execute("PRAGMA journal_mode=OFF")
            self._base.execute("PRAGMA synchronous=OFF")
            self._base.executescript(f"BEGIN;{_TABLES}")
            self._describe(topics)
        except sqlite3.Error as error:
            self.abandon()
            raise OSError(str(error)) from error

    def _describe(self, topics: Sequence[Topic]) -> None:
        types = {each.type: (each.definition, each.digest) for each in topics}
        for name, (definition, digest) in types.items():
            self._insert("message_definitions", None, name, "ros2msg", definition, digest)
        for number, each in enumerate(topics, 1):
            self._insert("topics", number, each.name, each.type, "cdr", each.quality, each.digest)

    def _insert(self, table: str, *values: object) -> None:
        marks = ",".join("?" * len(values))
        self._base.execute(f"INSERT INTO {table} VALUES ({marks})", values)

    def write(self, topic: int, time: int, data: bytes) -> None:
        """Append a message."""
        try:
            self._insert("messages", None, topic + 1, time, data)
        except sqlite3.Error as error:
            raise OSError(str(error)) from error

    def finish(self) -> None:
        """Complete the file."""
        try:
            with closing(self._base):
                self._base.execute("COMMIT")
        except sqlite3.Error as error:
            raise OSError(str(error)) from error
        self._part.replace(self._path)

    def abandon(self) -> None:
        """Delete the file."""
        self._base.close()
        self._part.unlink(missing_ok=True)


class McapStorage(Storage):
    """A file of MCAP (https://mcap.dev), profile `ros2`, with checksums.

    Raises:
        MissingExtraError: The library `mcap` is not installed.
    """

    kind = "mcap"

    def __init__(self, path: Path, topics: Sequence[Topic]) -> None:
        try:
            from mcap import writer
        except ImportError as error:
            raise MissingExtraError("video.writers: 'rosbag-mcap'", "ros") from error
        self._path, self._part = path, part_path(path)
        self._sequence = [0] * len(topics)
        self._file = self._part.open("wb")
        none = writer.CompressionType.NONE  # most of it are pictures, which are compressed
        self._mcap: McapLibrary = writer.Writer(self._file, compression=none)
        self._mcap.start("ros2", "eyas")
        types = {each.type: each.definition.encode() for each in topics}
        schema = {
            name: self._mcap.register_schema(name, "ros2msg", definition)
            for name, definition in types.items()
        }
        self._channels = [
            self._mcap.register_channel(
                each.name, "cdr", schema[each.type], {"offered_qos_profiles": each.quality}
            )
            for each in topics
        ]

    def write(self, topic: int, time: int, data: bytes) -> None:
        """Append a message."""
        sequence = self._sequence[topic]
        self._mcap.add_message(self._channels[topic], time, data, time, sequence)
        self._sequence[topic] += 1

    def finish(self) -> None:
        """Complete the file."""
        self._mcap.finish()
        self._file.close()
        self._part.replace(self._path)

    def abandon(self) -> None:
        """Delete the file."""
        self._file.close()
        self._part.unlink(missing_ok=True)


def described_bag(
    file: str,  # Name of the bag's file
    kind: str,
    topics: Sequence[Topic],  # All topics, with the times of their messages
    frames: int,  # Number of frames; ours, among the data that anyone may add
) -> bytes:
    """Return the content of `metadata.yaml`. It is JSON, which is YAML too."""
    times = [time for topic in topics for time in topic.times]
    first, last = min(times, default=0), max(times, default=0)
    span: dict[str, Any] = {
        "starting_time": {"nanoseconds_since_epoch": first},
        "duration": {"nanoseconds": last - first},
        "message_count": len(times),
    }
    told = {
        "version": _VERSION,
        "storage_identifier": kind,
        **span,
        "topics_with_message_count": [
            {"topic_metadata": _described_topic(topic), "message_count": len(topic.times)}
            for topic in topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file],
        "files": [{"path": file, **span}],
        "custom_data": {"eyas_frames": str(frames)},
        "ros_distro": "jazzy",
    }
    return (json.dumps({"rosbag2_bagfile_information": told}, indent=1) + "\n").encode()


def _described_topic(topic: Topic) -> dict[str, str]:
    return {
        "name": topic.name,
        "type": topic.type,
        "serialization_format": "cdr",
        "offered_qos_profiles": topic.quality,
        "type_description_hash": topic.digest,
    }


class RosbagWriter(Writer):
    """`rosbag/rosbag_0.db3` and `rosbag/metadata.yaml`: a bag stored by SQLite.

    Raises:
        MissingExtraError: The extra `ros` is not installed.
    """

    name: ClassVar[str] = "rosbag"
    ending: ClassVar[str] = "db3"
    storage: ClassVar[type[Storage]] = SqliteStorage
    wants = frozenset({"rgb", "others"})
    files = Files(episode=("rosbag/rosbag_0.db3", f"rosbag/{_DESCRIPTION}"))

    def __init__(self, run: Run) -> None:
        self._types = message_types(f"video.writers: '{self.name}'")  # before anything is recorded
        self._messages = Messages(self._types, run)

    def begin(self, episode: Episode) -> "_Bag":
        """Return the writer of an episode's bag."""
        path = self._path(episode.folder)
        with refusals(path):
            path.parent.mkdir(exist_ok=True)
            return _Bag(path, self.storage, self._types, self._messages)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of frames that the bag's description states."""
        path = self._path(folder)
        try:
            told = read_json(path.parent / _DESCRIPTION, 1 << 30)
            frames = int(told["rosbag2_bagfile_information"]["custom_data"]["eyas_frames"])
        except (DataFileError, ValueError, KeyError, TypeError):
            return None
        return Summary(frames) if path.is_file() else None

    def _path(self, folder: Path) -> Path:
        return folder / self.name / f"{self.name}_0.{self.ending}"


class RosbagMcapWriter(RosbagWriter):
    """`rosbag-mcap/rosbag-mcap_0.mcap` and `rosbag-mcap/metadata.yaml`: a bag stored as MCAP."""

    name = "rosbag-mcap"
    ending = "mcap"
    storage = McapStorage
    files = Files(episode=("rosbag-mcap/rosbag-mcap_0.mcap", f"rosbag-mcap/{_DESCRIPTION}"))


class _Bag(EpisodeWriter):
    """The bag of an episode. The description is written last, so a bag that has one is whole."""

    def __init__(
        self, path: Path, storage: type[Storage], types: "Typestore", messages: Messages
    ) -> None:
        self._path, self._types, self._messages = path, types, messages
        self._topics = [_topic(types, *topic) for topic in messages.topics.items()]
        self._number = {topic.name: number for number, topic in enumerate(self._topics)}
        self._storage = storage(path, self._topics)
        self._frames = 0

    def add(self, frame: Frame) -> None:
        """Append the messages of the next frame."""
        time = nanoseconds(frame)
        with refusals(self._path):
            for name, message in self._messages.of(frame):
                topic = self._topics[self._number[name]]
                data = bytes(self._types.serialize_cdr(message, topic.type))
                self._storage.write(self._number[name], time, data)
                topic.times.append(time)
        self._frames += 1

    def finish(self) -> None:
        """Complete the file, and describe the bag."""
        with refusals(self._path):
            self._storage.finish()
        told = described_bag(self._path.name, self._storage.kind, self._topics, self._frames)
        write_atomic(self._path.with_name(_DESCRIPTION), told)

    def abandon(self) -> None:
        """Delete the unfinished file."""
        with refusals(self._path):
            self._storage.abandon()


def _topic(types: "Typestore", name: str, type_: str) -> Topic:
    definition, _ = types.generate_msgdef(type_, ros_version=2)
    return Topic(name, type_, definition, types.hash_rihs01(type_), latched=name == "/tf_static")
