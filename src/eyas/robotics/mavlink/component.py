"""What all components of a vehicle have in common: packets out, streams, commands and their
answers.
"""

import math
from collections.abc import Callable, Iterable
from enum import IntEnum
from typing import Any, NamedTuple

from eyas.robotics.mavlink.endpoint import Packer, dialect

Fields = dict[str, Any]  # The fields of a message, by name

FASTEST = 0.001  # Shortest interval that may be asked for [s]
SLOWEST = 2000.0  # Longest; messages hold not much more [s]


class Result(IntEnum):
    """MAVLink's `MAV_RESULT`."""

    ACCEPTED = 0
    TEMPORARILY_REJECTED = 1
    DENIED = 2
    UNSUPPORTED = 3
    FAILED = 4


class Command(NamedTuple):
    """A `COMMAND_LONG` or `COMMAND_INT`."""

    number: int  # `MAV_CMD`
    p: tuple[float, float, float, float, float, float, float]
    """Parameters 1 to 7; latitude and longitude, 5 and 6, in degrees."""
    sender: tuple[int, int]  # System and component id
    frame: int | None  # `MAV_FRAME` of a `COMMAND_INT`; None: none is told


Handler = Callable[[Command], Result]


class Component:
    """A component of a vehicle.

    Attributes:
        system: System id.
        id: Component id.
        name: Names of MAVLink's messages and constants.
        answers: What to do for a command, by the name of the command without `MAV_CMD_`.
        producers: Makers of the messages that may be asked for, by name; each gives the fields of
            as many as are sent at once.
        handlers: What to do for other messages, by their type.

    Args:
        system: As above.
        out: Takes packets.
    """

    def __init__(self, system: int, component: int, out: Callable[[bytes], None]) -> None:
        self.system, self.id = system, component
        self.names = dialect()
        self.answers: dict[str, Handler] = {}
        self.producers: dict[str, Callable[[], Iterable[Fields]]] = {}
        self.handlers: dict[str, Callable[[Any], None]] = {}
        self._packer, self._out = Packer(system, component), out
        self._due: dict[str, float] = {}
        self._usual: dict[str, float] = {}
        self._intervals: dict[str, float] = {}

    def send(self, message: str, /, **fields: Any) -> None:  # noqa: ANN401  # of any message
        """Send a message, such as `heartbeat`."""
        self._out(self._packer.pack(message, **fields))

    def tell(self, message: str) -> bool:
        """Send one of the messages that may be asked for; return whether it is one."""
        if message not in self.producers:
            return False
        for fields in self.producers[message]():
            self.send(message, **fields)
        return True

    def stream(self, message: str, rate: float) -> None:
        """Send a message so many times a second from now on [Hz], unless others are asked for."""
        self._usual[message] = self._intervals[message] = 1.0 / rate
        self._due[message] = 0.0

    def begin_stream(self, message: str, rate: float) -> None:
        """Begin a stream until `end_stream`, unless somebody has asked for another rate."""
        if message not in self._intervals:
            self.stream(message, rate)

    def end_stream(self, message: str) -> None:
        """End what `begin_stream` has begun."""
        if message in self._usual:
            for table in (self._usual, self._intervals, self._due):
                table.pop(message, None)

    def tick(self, now: float) -> None:
        """Send what is due at a time of the simulation [s]."""
        for message, due in self._due.items():
            if now + 1e-9 >= due:
                self.tell(message)
                later = due + self._intervals[message]
                self._due[message] = later if later > now else now + self._intervals[message]

    def take(self, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        """Take a message that is addressed to this component."""
        kind = message.get_type()
        if kind == "COMMAND_LONG":
            self._obey(_of_long(message), message)
        elif kind == "COMMAND_INT":
            self._obey(_of_int(message), message)
        elif kind in self.handlers:
            self.handlers[kind](message)

    def knows(self, number: int) -> bool:
        """Return whether a command is one of this component's own."""
        return self._name_of(number) in self.answers

    def _name_of(self, number: int) -> str:
        entry = self.names.enums["MAV_CMD"].get(number)
        return entry.name.removeprefix("MAV_CMD_") if entry is not None else ""

    def _obey(self, command: Command, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        """Carry out a command, and answer."""
        answer = self.answers.get(self._name_of(command.number)) or self._common(command.number)
        result = Result.UNSUPPORTED if answer is None else answer(command)
        self.send(
            "command_ack",
            command=command.number,
            result=int(result),
            target_system=message.get_srcSystem(),
            target_component=message.get_srcComponent(),
        )
        self._reply(command, result)

    def _common(self, number: int) -> Handler | None:
        return {
            "REQUEST_MESSAGE": self._can_tell,
            "SET_MESSAGE_INTERVAL": self._set_interval,
            "GET_MESSAGE_INTERVAL": self._can_tell,
        }.get(self._name_of(number))

    def _reply(self, command: Command, result: Result) -> None:
        """Send what was asked for, after the answer to the command."""
        if result is not Result.ACCEPTED:
            return
        match self._name_of(command.number):
            case "REQUEST_MESSAGE":
                self.tell(self._message(command.p[0]))
            case "GET_MESSAGE_INTERVAL":
                interval = self._intervals.get(self._message(command.p[0]), math.inf)
                self.send(
                    "message_interval",
                    message_id=int(command.p[0]),
                    interval_us=-1 if math.isinf(interval) else round(interval * 1e6),
                )

    def _message(self, number: float) -> str:
        """Return the name of a message by its number; empty if there is none."""
        found = self.names.mavlink_map.get(int(number)) if math.isfinite(number) else None
        return found.msgname.lower() if found is not None else ""

    def _can_tell(self, command: Command) -> Result:
        known = self._message(command.p[0]) in self.producers
        return Result.ACCEPTED if known else Result.UNSUPPORTED

    def _set_interval(self, command: Command) -> Result:
        message, interval = self._message(command.p[0]), command.p[1]
        if message not in self.producers:
            return Result.UNSUPPORTED
        if not math.isfinite(interval):
            return Result.DENIED
        if interval == 0.0:  # the usual one
            interval = 1e6 * self._usual.get(message, -1e-6)
        seconds = min(max(interval * 1e-6, FASTEST), SLOWEST)
        self._intervals[message] = seconds if interval > 0.0 else math.inf
        self._due[message] = 0.0 if interval > 0.0 else math.inf
        return Result.ACCEPTED


def _of_long(message: Any) -> Command:  # noqa: ANN401  # pymavlink's
    params = tuple(getattr(message, f"param{k}") for k in range(1, 8))
    sender = message.get_srcSystem(), message.get_srcComponent()
    return Command(message.command, params, sender, None)


def _of_int(message: Any) -> Command:  # noqa: ANN401  # pymavlink's
    first = (message.param1, message.param2, message.param3, message.param4)
    place = tuple(_degrees(at) for at in (message.x, message.y))
    sender = message.get_srcSystem(), message.get_srcComponent()
    return Command(message.command, (*first, *place, message.z), sender, message.frame)


def _degrees(at: int) -> float:
    """Return an angle in degrees; what is none, such as the largest number, is left free."""
    return at * 1e-7 if abs(at) <= 1_800_000_000 else math.nan
