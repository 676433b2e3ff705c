"""The server: gathers an action of each client, lets the trackers act, gives the answers."""

import logging
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from eyas.task.journal import Journal
from eyas.wire.announcements import Announcements
from eyas.wire.codec import RESET
from eyas.wire.config import WireConfig
from eyas.wire.exchange import Exchange
from eyas.wire.pause import Pause
from eyas.wire.post import Part, Post

if TYPE_CHECKING:
    from eyas.wire.crew import Answer, Crew

__all__ = ["Server"]

_LOG = logging.getLogger("eyas")


class Server:
    """Serves clients of the original's protocol, until it is interrupted.

    Args:
        config: The settings.
        exchange: The folder.
        tracker: Name of the trackers, such as `DRONE`.
        build: Returns the trackers, for a number of agents.
        verbose: Whether all that is said and done is logged as by the original.
    """

    def __init__(
        self,
        config: WireConfig,
        exchange: Exchange,
        tracker: str,
        build: Callable[[int], "Crew"],
        *,
        verbose: bool,
    ) -> None:
        self._config = config
        self._exchange = exchange
        self._tracker = tracker
        self._build = build
        self._verbose = verbose
        self._late: set[str] = set()

    def run(self) -> None:
        """Serve; each change of the number of agents begins with a new world.

        Raises:
            EyasError: The folder or the port cannot be used, or nothing can be built.
        """
        address, port = self._config.address, self._config.port
        announcements = Announcements(address, port)
        try:
            with self._exchange.opened() as removed:
                if removed:
                    _LOG.info(
                        "%s: deleted %d files of an earlier run; clients that were started "
                        "before now must be started again",
                        *(self._exchange.files, removed),
                    )
                _LOG.info("waiting for clients on UDP port %d of %s", port, address)
                count, begun = announcements.wait(), frozenset[int]()
                while True:
                    count, begun = self._serve(count, begun, announcements)
        finally:
            announcements.close()

    def _serve(
        self, count: int, begun: frozenset[int], announcements: Announcements
    ) -> tuple[int, frozenset[int]]:
        """Serve some agents until another number of them is announced.

        Args:
            count: Number of agents.
            begun: Those of them whose first reset has been taken already.
            announcements: Where another number may be announced.

        Returns:
            Another number of agents, and those whose first reset has been taken already.
        """
        names = [f"{self._tracker}{number}" for number in range(count)]
        _LOG.info("%d agent%s announced", count, "s" * (count > 1))
        crew = self._build(count)
        try:
            with Journal(self._exchange.logs, names, verbose=self._verbose) as journal:
                posts = [
                    Post(self._exchange.names(name), journal.hearer(number))
                    for number, name in enumerate(names)
                ]
                for number in begun & set(range(count)):
                    posts[number].action = RESET
                _LOG.info("serving %s in %s", _named(names), self._exchange.files)
                self._late.clear()
                while True:
                    other = self._gather(posts, count, announcements)
                    if other is not None:
                        return other, _begun(posts)
                    self._play(crew, posts, journal)
        finally:
            crew.close()

    def _gather(self, posts: list[Post], count: int, announcements: Announcements) -> int | None:
        """Give all answers and wait for the next action of each client.

        Returns:
            Another number of agents, if one is announced; None when all actions are there.
        """
        pause = Pause()
        while any(post.action is None for post in posts):
            happened = [post for post in posts if post.poll()]
            if happened:
                self._welcome(happened)
                pause.restart()
                continue
            if pause.long:
                other = announcements.poll()
                if other not in (None, count):
                    return other
                self._tell_late(posts)
            pause.sleep()
        other = announcements.poll()
        return None if other == count else other

    def _play(self, crew: "Crew", posts: list[Post], journal: Journal) -> None:
        actions = [post.action for post in posts]
        answers = crew.play([action for action in actions if action is not None])
        journal.step(crew.sim.snapshot)
        for post, answer in zip(posts, answers, strict=True):
            post.answer(self._parts(post, answer))

    def _parts(self, post: Post, answer: "Answer") -> list[Part]:
        """Return the files of an answer, in the original's order."""
        names, picture = post.names, answer.picture
        parts = [Part(names.state, lambda: answer.state)]
        if self._config.reward_packet:
            parts.append(Part(names.reward, lambda: answer.reward))
        radar = answer.radar
        if radar is not None:
            parts.append(Part(names.radar, lambda: radar))
        drawn = Part(names.picture, lambda: picture.result() if picture.done() else None)
        return [*parts, drawn]

    def _tell_late(self, posts: list[Post]) -> None:
        """Report clients that do not go on, once."""
        since = time.monotonic() - self._config.patience
        late = [post.names.tracker for post in posts if post.owes and post.waiting < since]
        if set(late) - self._late:
            self._late |= set(late)
            _LOG.warning(
                "%s: nothing for %g s: the client is busy, stopped or dead; all others wait for "
                "it, and a new client can take its place",
                *(", ".join(late), self._config.patience),
            )

    def _welcome(self, posts: list[Post]) -> None:
        for post in posts:
            if post.names.tracker in self._late:
                self._late.discard(post.names.tracker)
                _LOG.info("%s: goes on", post.names.tracker)


def _begun(posts: list[Post]) -> frozenset[int]:
    """Withdraw all answers; return the agents that have begun a new training.

    New clients announce themselves first, but may be heard of after their first resets.
    """
    for post in posts:
        post.withdraw()
    resets = [post.action is not None and post.action.reset for post in posts]
    return frozenset(number for number, reset in enumerate(resets) if reset)


def _named(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{names[0]} to {names[-1]} ({len(names)})"
