"""Signals that ask a program to end: Ctrl-C (SIGINT), SIGTERM and SIGHUP.

Python raises `KeyboardInterrupt` wherever the main thread happens to be; `EndingSignals` makes the
command line end once, in order; `interrupts_held` holds signals back while a process begins.
"""

import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_ENDING = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)

_PATIENCE = 10.0
"""Time for a program to end in order, after which a further signal ends it at once [s]."""

_AGAIN = 0.02  # Time until an interrupt is raised again that was lost in code that cannot raise [s]


class Interrupted(KeyboardInterrupt):
    """A signal asked the program to end."""


class EndingSignals:
    """Handlers of the signals that ask a program to end: the first one raises `Interrupted`.

    Those that were ignored when the program started stay ignored, as `nohup` and shells expect.

    Attributes:
        first: The first signal that came; None before.
    """

    def __init__(self) -> None:
        self.first: int | None = None
        self._since = 0.0
        self._taken: list[int] = []

    def take(self) -> None:
        """Handle the signals from now on."""
        sys.unraisablehook = self._lost
        for number in _ENDING:
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._handle)
                self._taken.append(number)

    def close(self) -> None:
        """Ignore signals from now on: the program has done its work, and only Python has to end,
        which gives all other signals their deadly defaults back.
        """
        for number in self._taken:
            signal.signal(number, signal.SIG_IGN)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self.first is None:
            self.first, self._since = number, time.monotonic()
            raise Interrupted
        if time.monotonic() - self._since > _PATIENCE:
            os._exit(128 + number)

    def _lost(self, lost: "sys.UnraisableHookArgs") -> None:
        """Raise an interrupt again that came in a callback or destructor, which cannot raise."""
        if self.first is None:
            sys.__unraisablehook__(lost)
        elif lost.exc_type is Interrupted:
            number, self.first = self.first, None
            again = threading.Timer(_AGAIN, os.kill, (os.getpid(), number))
            again.daemon = True
            again.start()


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Hold back signals that end the program while a process begins, which would tell of its half
    beginning; the process itself never hears of Ctrl-C: its parent ends it.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[tuple[int, FrameType | None]] = []
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    for number in before:
        signal.signal(number, lambda *what: came.append(what))
    masked = hasattr(signal, "pthread_sigmask")  # not on Windows
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}) if masked else set()
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if masked:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for sent, _ in came[:1]:
            signal.raise_signal(sent)
