"""Writers of bags of ROS 2: a folder for each episode that `ros2 bag` plays."""

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.writer import Episode, EpisodeWriter, Files, Run, Summary, Writer
from eyas.robotics.ros.messages import Messages, nanoseconds
from eyas.robotics.ros.storage import McapStorage, SqliteStorage, Storage, Topic, described_bag
from eyas.robotics.ros.types import message_types

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_DESCRIPTION = "metadata.yaml"


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
