"""Messages of ROS 2 over DDS, to nodes that run: by Cyclone DDS, which is imported here only.

Names as ROS 2 maps them to DDS (design.ros2.org, "Topic and Service name mapping to DDS"): the
topic `/odom` is `rt/odom`, the type `nav_msgs/msg/Odometry` is `nav_msgs::msg::dds_::Odometry_`.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from eyas.engine.core.errors import ConfigError, MissingExtraError

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_WORDS = {**{"bool": bool, "string": str}, **{"octet": "uint8", "byte": "uint8", "char": "uint8"}}
"""Types of fields that have other names in Cyclone DDS."""
_LATCHED = "/tf_static"
_KEPT = 10  # Messages of a topic that are kept for slow listeners, as by ROS


class Bus:
    """Publishes and hears messages.

    Args:
        domain: Number of the domain, as `ROS_DOMAIN_ID` is for nodes.
        topics: Names and types of what is published.

    Raises:
        MissingExtraError: Cyclone DDS is not installed.
        ConfigError: There is no network for this domain.
    """

    def __init__(self, domain: int, types: "Typestore", topics: dict[str, str]) -> None:
        try:
            from cyclonedds.core import DDSException
            from cyclonedds.domain import DomainParticipant
        except ImportError as error:
            raise MissingExtraError("--ros", "ros-live") from error
        self._types, self._classes = types, dict[str, Any]()
        try:
            self._participant = DomainParticipant(domain)
        except DDSException as error:
            raise ConfigError(f"--ros {domain}: DDS does not start: {error.msg}") from None
        self._kinds = topics
        self._writers = {name: self._writer(name, kind) for name, kind in topics.items()}

    def publish(self, name: str, message: Any) -> None:  # noqa: ANN401  # made by `rosbags`
        """Send a message of `rosbags` to all who listen to a topic."""
        writer, kind = self._writers[name], self._kinds[name]
        sample = object.__new__(self._class(kind))
        data = bytes(self._types.serialize_cdr(message, kind))
        sample.serialize = lambda **_: data
        writer.write(sample)

    def listen(self, name: str, kind: str) -> Any:  # noqa: ANN401  # Cyclone's
        """Return a reader of a topic, for `heard`."""
        from cyclonedds.sub import DataReader

        # Best effort hears every writer; one that wants to be reliable would not hear the others.
        return DataReader(
            self._participant, self._topic(name, kind), qos=_quality(name, sure=False)
        )

    @staticmethod
    def heard(reader: Any) -> Iterable[Any]:  # noqa: ANN401  # Cyclone's
        """Return the messages that have come since the last call, the newest last."""
        return [sample for sample in reader.take(_KEPT) if sample.sample_info.valid_data]

    def _writer(self, name: str, kind: str) -> Any:  # noqa: ANN401  # Cyclone's
        from cyclonedds.pub import DataWriter

        return DataWriter(self._participant, self._topic(name, kind), qos=_quality(name))

    def _topic(self, name: str, kind: str) -> Any:  # noqa: ANN401  # Cyclone's
        from cyclonedds.topic import Topic

        return Topic(self._participant, f"rt{name}", self._class(kind), qos=_quality(name))

    def _class(self, kind: str) -> Any:  # noqa: ANN401  # made here
        """Return the class of Cyclone DDS of a type of messages."""
        if kind not in self._classes:
            from cyclonedds.idl import make_idl_struct

            package, _, name = kind.split("/")
            fields = {field: self._field(of) for field, of in self._types.fielddefs[kind][1]}
            told = f"{package}::msg::dds_::{name}_"
            self._classes[kind] = make_idl_struct(name, told, fields)
        return self._classes[kind]

    def _field(self, described: Any) -> Any:  # noqa: ANN401  # types of both libraries
        """Return Cyclone's type of a field that `rosbags` describes."""
        from cyclonedds.idl import types as idl
        from rosbags.interfaces import Nodetype

        kind, what = described
        if kind == Nodetype.BASE:
            found = _WORDS.get(what[0], what[0])
            return getattr(idl, found) if isinstance(found, str) else found
        if kind == Nodetype.NAME:
            return self._class(what)
        part, count = what
        own = self._field(part)
        if kind == Nodetype.ARRAY:
            return idl.array[own, count]
        return idl.sequence[own, count] if count else idl.sequence[own]


def _quality(name: str, *, sure: bool = True) -> Any:  # noqa: ANN401  # Cyclone's
    """Return the quality of service of a topic: reliable, so that every node may listen, unless it
    is not `sure`; what is told once is kept for late listeners.
    """
    from cyclonedds.qos import Policy, Qos
    from cyclonedds.util import duration

    late = Policy.Durability.TransientLocal if name == _LATCHED else Policy.Durability.Volatile
    reliable = Policy.Reliability.Reliable(duration(milliseconds=100))
    return Qos(
        reliable if sure else Policy.Reliability.BestEffort,
        late,
        Policy.History.KeepLast(_KEPT),
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )
