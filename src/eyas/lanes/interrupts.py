"""Signals that ask a program to end, held back from code that they would leave in pieces.

Python raises `KeyboardInterrupt` wherever the main thread happens to be, in LLVM too.
"""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_ENDING = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)

Handler = Callable[[int, FrameType | None], Any]


class _Shield:
    """Signals held back from the main thread."""

    def __init__(self) -> None:
        self.handlers: dict[int, Handler] = {}
        self.held: list[int] = []

    def hold(self, number: int, frame: FrameType | None) -> None:
        self.held.append(number)

    def let_in(self) -> None:
        while self.held:
            number = self.held.pop(0)
            self.handlers[number](number, None)


_shield: _Shield | None = None


@contextmanager
def shielded() -> Iterator[None]:
    """Hold signals that ask the program to end back until the block is left, or `let_in`.

    Only what raises in the main thread is held back; a signal without a handler in Python ends the
    process as ever.
    """
    global _shield
    if _shield is not None or threading.current_thread() is not threading.main_thread():
        yield
        return
    mine = _Shield()
    for number in _ENDING:
        handler = signal.getsignal(number)
        if callable(handler):
            mine.handlers[number] = handler
    try:
        _shield = mine
        for number in mine.handlers:
            signal.signal(number, mine.hold)
        yield
    finally:
        for number, handler in mine.handlers.items():
            signal.signal(number, handler)
        _shield = None
        mine.let_in()


def let_in() -> None:
    """Handle signals held back so far; for places where an exception does no harm."""
    if _shield is not None and threading.current_thread() is threading.main_thread():
        _shield.let_in()
