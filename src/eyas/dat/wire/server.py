"""The server: gathers an action of each client, lets the trackers act, gives the answers."""

import logging
import time
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, NamedTuple

from eyas.dat.wire.announcements import Announcements
from eyas.dat.wire.client_session import AnswerFile, ClientSession
from eyas.dat.wire.config import WireConfig
from eyas.dat.wire.exchange import RESET, ExchangeFolders, Pause
from eyas.engine.core.errors import (
    ConfigError,
    DataFileError,
    EyasError,
    MissingExtraError,
    SpawnError,
)
from eyas.engine.sim.serving import Face, Orders
from eyas.engine.task.journal import Journal

if TYPE_CHECKING:
    from eyas.dat.wire.tracker_group import Answer, TrackerGroup

_LOG = logging.getLogger("eyas")

_LOOKS = 0.5  # Time between two looks at the settings' port [s]


class Service(NamedTuple):
    """What is served to agents that announce themselves."""

    config: WireConfig
    tracker: str  # Name of the trackers, such as `DRONE`
    build: Callable[[int], "TrackerGroup"]  # Returns the trackers, for a number of agents
    verbose: bool  # Whether all that is said and done is logged as by the original


class _Training(NamedTuple):
    """Agents that are served together, in a world of their own."""

    service: Service
    group: "TrackerGroup"
    journal: Journal
    sessions: list[ClientSession]


class Server(Face):
    """The original's protocol; each change of the number of clients begins a new world.

    Args:
        ask: Returns what to serve, whenever agents announce themselves; the same object as long as
            nothing has changed.
        place: Returns the address and the port on which to listen, which may change.
    """

    speed = 0.0  # in lock-step

    def __init__(
        self,
        exchange: ExchangeFolders,
        ask: Callable[[], Service],
        place: Callable[[], tuple[str, int]],
    ) -> None:
        self._exchange, self._ask, self._place = exchange, ask, place
        self._open, self._serving = ExitStack(), ExitStack()
        self._training: _Training | None = None
        self._looked = time.monotonic()
        self._pause = Pause()
        self._late: set[str] = set()
        self._count = 0  # of agents that are served, or about to be

    def open(self) -> None:
        """Listen, and keep the folder.

        Raises:
            EyasError: The folder or the port cannot be used.
        """
        address, port = self._place()
        self._announcements = Announcements(address, port)
        self._open.callback(self._announcements.close)
        removed = self._open.enter_context(self._exchange.opened(self._announcements.since))
        if removed:
            _LOG.info(
                "%s: deleted %d files of an earlier run; clients that were started before now must "
                "be started again",
                self._exchange.files,
                removed,
            )
        _LOG.info("waiting for clients on UDP port %d of %s", port, address)

    def close(self) -> None:
        """End, and leave the folder."""
        with self._open:
            self._end()

    def receive(self, wait: float) -> Iterable[tuple[str, Any]]:
        """Go on by a file with each client that has; or hear agents that are announced."""
        training, end = self._training, time.monotonic() + wait
        if training is None:
            self._look()
            count = self._announcements.wait(wait)
            if count is None:
                return []
            self._begin(count)
            return [("agents", None)]
        while True:
            happened = [session for session in training.sessions if session.poll()]
            complete = all(session.action is not None for session in training.sessions)
            if self._pause.long:
                self._look()
            if (complete or self._pause.long) and self._others_begin(training):
                return [("agents", None)]
            if happened:
                self._pause.restart()
                return [(session.names.tracker, session) for session in happened]
            if complete or time.monotonic() > end:
                return []
            self._pause.sleep()

    def take(self, message: ClientSession | None) -> None:
        """Note that a client goes on."""
        if message is not None and message.names.tracker in self._late:
            self._late.discard(message.names.tracker)
            _LOG.info("%s: goes on", message.names.tracker)

    def orders(self) -> Orders | None:
        """Return the actions of all clients, when all are there."""
        training = self._training
        if training is None:
            return None
        actions = [session.action for session in training.sessions if session.action is not None]
        if len(actions) < len(training.sessions):
            return None
        training.journal.actions([action.command for action in actions])
        return training.group.orders(actions)

    def answer(self, *, late: bool) -> None:
        """Give each client its answer."""
        training = self._training
        assert training is not None  # there were orders
        answers = training.group.answers()
        training.journal.step(training.group.sim.snapshot)
        for session, answer in zip(training.sessions, answers, strict=True):
            session.answer(_answer_files(training.service, session, answer))
        self._pause.restart()

    def idle(self, stood: float) -> None:
        """Report clients that do not go on, once."""
        if self._training is None:
            return
        patience = self._training.service.config.patience
        since = time.monotonic() - patience
        late = [
            session.names.tracker
            for session in self._training.sessions
            if session.owes and session.waiting < since
        ]
        if set(late) - self._late:
            self._late |= set(late)
            _LOG.warning(
                "%s: nothing for %g s: the client is busy, stopped or dead; all others wait for "
                "it, and a new client can take its place",
                ", ".join(late),
                patience,
            )

    def fail(self, error: EyasError) -> None:
        """Tell of agents that cannot be served in a line, and wait for others."""
        if self._count == 0 or not isinstance(
            error, ConfigError | DataFileError | MissingExtraError | SpawnError
        ):
            raise error
        count = self._count
        self._end()
        _LOG.error(
            "%d agent%s cannot be served: %s; their clients wait in vain: end them; waiting for "
            "the next",
            count,
            "s" * (count > 1),
            error,
        )
        self._announcements.poll()  # of the others of them

    def _begin(self, count: int, begun: frozenset[int] = frozenset()) -> None:
        """Make a world for agents that have announced themselves."""
        self._count = count
        _LOG.info("%d agent%s announced", count, "s" * (count > 1))
        service = self._ask()
        group = service.build(count)
        self._serving.callback(group.close)
        names = [f"{service.tracker}{number}" for number in range(count)]
        journal = Journal(self._exchange.logs, names, verbose=service.verbose)
        self._serving.enter_context(journal)
        sessions = [
            ClientSession(self._exchange.names(name), journal.hearer(number))
            for number, name in enumerate(names)
        ]
        for number in begun & set(range(count)):
            sessions[number].action = RESET
        _LOG.info("serving %s in %s", _named(names), self._exchange.files)
        self._training = _Training(service, group, journal, sessions)
        self.simulation = group.sim
        self._late.clear()
        self._pause.restart()

    def _end(self) -> None:
        """End the world."""
        self._training, self._count = None, 0
        self._serving.close()

    def _others_begin(self, training: _Training) -> bool:
        """Begin anew if agents are announced that need a world of their own."""
        count = self._announcements.poll()
        if count is None:
            return False
        if count == len(training.sessions) and self._ask() is training.service:
            return False
        begun = _begun(training.sessions)
        self._end()
        self._begin(count, begun)
        return True

    def _look(self) -> None:
        """Follow the settings' port, twice a second."""
        now = time.monotonic()
        if now - self._looked > _LOOKS:
            self._looked = now
            self._announcements.move(*self._place())


def _answer_files(service: Service, session: ClientSession, answer: "Answer") -> list[AnswerFile]:
    """Return the files of an answer, in the original's order."""
    names, picture = session.names, answer.picture
    parts = [AnswerFile(names.state, lambda: answer.state)]
    if service.config.reward_packet:
        parts.append(AnswerFile(names.reward, lambda: answer.reward))
    radar = answer.radar
    if radar is not None:
        parts.append(AnswerFile(names.radar, lambda: radar))
    drawn = AnswerFile(names.picture, lambda: picture.result() if picture.done() else None)
    return [*parts, drawn]


def _begun(sessions: list[ClientSession]) -> frozenset[int]:
    """Withdraw all answers; return the agents that have begun a new training.

    New clients announce themselves first, but may be heard of after their first resets.
    """
    for session in sessions:
        session.withdraw()
    resets = [session.action is not None and session.action.reset for session in sessions]
    return frozenset(number for number, reset in enumerate(resets) if reset)


def _named(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{names[0]} to {names[-1]} ({len(names)})"
