"""The server: gathers an action of each client, lets the trackers act, gives the answers."""

import logging
import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from eyas.dat.wire.announcements import Announcements
from eyas.dat.wire.client_session import AnswerFile, ClientSession
from eyas.dat.wire.codec import RESET
from eyas.dat.wire.config import WireConfig
from eyas.dat.wire.exchange import Exchange, Pause
from eyas.engine.core.errors import ConfigError, DataFileError, MissingExtraError, SpawnError
from eyas.engine.task.journal import Journal

if TYPE_CHECKING:
    from eyas.dat.wire.tracker_group import Answer, TrackerGroup

__all__ = ["Server", "Service"]

_LOG = logging.getLogger("eyas")

_LOOKS = 0.5
"""Time between two looks at the settings' port [s]."""


class Service(NamedTuple):
    """What is served to agents that announce themselves."""

    config: WireConfig
    tracker: str
    """Name of the trackers, such as `DRONE`."""
    build: Callable[[int], "TrackerGroup"]
    """Returns the trackers, for a number of agents."""
    verbose: bool
    """Whether all that is said and done is logged as by the original."""


class _Idle(Exception):  # noqa: N818  # an end, no error
    """There was no client for long."""


class Server:
    """Serves clients of the original's protocol, until it is interrupted.

    Args:
        exchange: The folder.
        ask: Returns what to serve, whenever agents announce themselves; the same object as long as
            nothing has changed.
        place: Returns the address and the port on which to listen, which may change.
        until_idle: Time without a client after which `run` ends [s].
    """

    def __init__(
        self,
        exchange: Exchange,
        ask: Callable[[], Service],
        place: Callable[[], tuple[str, int]],
        until_idle: float = math.inf,
    ) -> None:
        self._exchange = exchange
        self._until_idle, self._active = until_idle, time.monotonic()
        self._ask = ask
        self._place = place
        self._looked = time.monotonic()
        self._late: set[str] = set()

    def run(self) -> None:
        """Serve until there is no client for long; each change of their number begins a new world.

        Raises:
            EyasError: The folder or the port cannot be used.
        """
        address, port = self._place()
        announcements = Announcements(address, port)
        try:
            with self._exchange.opened(announcements.since) as removed:
                if removed:
                    _LOG.info(
                        "%s: deleted %d files of an earlier run; clients that were started "
                        "before now must be started again",
                        *(self._exchange.files, removed),
                    )
                _LOG.info("waiting for clients on UDP port %d of %s", port, address)
                count, begun = self._wait(announcements), frozenset[int]()
                while True:
                    count, begun = self._served(count, begun, announcements)
        except _Idle:
            _LOG.info("no client for %g s: ended", self._until_idle)
        finally:
            announcements.close()

    def _wait(self, announcements: Announcements) -> int:
        def meanwhile() -> None:
            announcements.move(*self._place())
            self._end_idle()

        count = announcements.wait(meanwhile)
        self._active = time.monotonic()
        return count

    def _end_idle(self) -> None:
        """End if there was no client for long.

        Raises:
            _Idle: There was none.
        """
        if time.monotonic() - self._active > self._until_idle:
            raise _Idle

    def _served(
        self, count: int, begun: frozenset[int], announcements: Announcements
    ) -> tuple[int, frozenset[int]]:
        """Do as `_serve`; agents that cannot be served are told of in a line, and others waited
        for.
        """
        _LOG.info("%d agent%s announced", count, "s" * (count > 1))
        service = self._ask()
        try:
            group = service.build(count)
            try:
                return self._serve(service, group, (count, begun), announcements)
            finally:
                group.close()
        except (ConfigError, DataFileError, MissingExtraError, SpawnError) as error:
            _LOG.error(
                "%d agent%s cannot be served: %s; their clients wait in vain: end them; waiting "
                "for the next",
                *(count, "s" * (count > 1), error),
            )
            announcements.poll()  # of the others of them
        return self._wait(announcements), frozenset()

    def _serve(
        self,
        service: Service,
        group: "TrackerGroup",
        agents: tuple[int, frozenset[int]],
        announcements: Announcements,
    ) -> tuple[int, frozenset[int]]:
        """Serve some agents until others are announced.

        Args:
            service: What is served.
            group: The trackers.
            agents: Number of agents, and those of them whose first reset has been taken already.
            announcements: Where others may be announced.

        Returns:
            The number of the others, and those whose first reset has been taken already.

        Raises:
            SpawnError: There are fewer targets than agents.
        """
        count, begun = agents
        names = [f"{service.tracker}{number}" for number in range(count)]
        with Journal(self._exchange.logs, names, verbose=service.verbose) as journal:
            sessions = [
                ClientSession(self._exchange.names(name), journal.hearer(number))
                for number, name in enumerate(names)
            ]
            for number in begun & set(range(count)):
                sessions[number].action = RESET
            _LOG.info("serving %s in %s", _named(names), self._exchange.files)
            self._late.clear()
            self._active = time.monotonic()  # making the world may have taken long
            while True:
                other = self._gather(service, sessions, announcements)
                if other is not None:
                    return other, _begun(sessions)
                self._play(service, group, sessions, journal)

    def _gather(
        self, service: Service, sessions: list[ClientSession], announcements: Announcements
    ) -> int | None:
        """Give all answers and wait for the next action of each client.

        Returns:
            The number of other agents, if such are announced; None when all actions are there.
        """
        pause = Pause()
        while any(session.action is None for session in sessions):
            happened = [session for session in sessions if session.poll()]
            if happened:
                self._welcome(happened)
                self._active = time.monotonic()
                pause.restart()
                continue
            if pause.long:
                self._look(announcements)
                other = announcements.poll()
                if other is not None and self._is_new(service, other, len(sessions)):
                    return other
                self._tell_late(sessions, service.config.patience)
                self._end_idle()
            pause.sleep()
        other = announcements.poll()
        return other if other is not None and self._is_new(service, other, len(sessions)) else None

    def _is_new(self, service: Service, announced: int, count: int) -> bool:
        """Return whether agents that are announced need a world of their own."""
        return announced != count or self._ask() is not service

    def _look(self, announcements: Announcements) -> None:
        """Follow the settings' port, twice a second."""
        now = time.monotonic()
        if now - self._looked > _LOOKS:
            self._looked = now
            announcements.move(*self._place())

    def _play(
        self,
        service: Service,
        group: "TrackerGroup",
        sessions: list[ClientSession],
        journal: Journal,
    ) -> None:
        actions = [session.action for session in sessions]
        given = [action for action in actions if action is not None]
        journal.actions([action.command for action in given])
        answers = group.play(given)
        journal.step(group.sim.snapshot)
        for session, answer in zip(sessions, answers, strict=True):
            session.answer(_answer_files(service, session, answer))

    def _tell_late(self, sessions: list[ClientSession], patience: float) -> None:
        """Report clients that do not go on, once."""
        since = time.monotonic() - patience
        late = [
            session.names.tracker
            for session in sessions
            if session.owes and session.waiting < since
        ]
        if set(late) - self._late:
            self._late |= set(late)
            _LOG.warning(
                "%s: nothing for %g s: the client is busy, stopped or dead; all others wait for "
                "it, and a new client can take its place",
                *(", ".join(late), patience),
            )

    def _welcome(self, sessions: list[ClientSession]) -> None:
        for session in sessions:
            if session.names.tracker in self._late:
                self._late.discard(session.names.tracker)
                _LOG.info("%s: goes on", session.names.tracker)


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
