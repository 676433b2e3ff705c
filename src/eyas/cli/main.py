"""The program `eyas`: its first and its last line."""

import os
import sys

from eyas.engine.terminal.interrupts import EndingSignals

_WORDS = {2: "interrupted", 15: "terminated", 1: "hung up"}
"""What the signals SIGINT, SIGTERM and SIGHUP have done."""


_NO_MEMORY = b"eyas: error: out of memory: free some, or raise the limit (ulimit -v)\n"


def main() -> None:
    """Run the command line: errors are one line on stderr and exit code 2, without a traceback.

    Ctrl-C, SIGTERM and SIGHUP are one line too, and exit code 130, 143 or 129.
    """
    signals, remarks = EndingSignals(), ""
    try:
        signals.take()
        _make_streams_usable()
        from eyas.cli.app import run  # heavy, so only after the signals are handled

        status = run()
        signals.close()
    except BaseException as error:
        interrupt = _interrupt_behind(error)
        if interrupt is None:
            # After a signal, what is left of its interrupt: pydantic turns one that is raised in a
            # class under way into an error of its own, without a cause.
            if signals.first is None:
                from eyas.engine.terminal.stderr import lacks_memory

                if not lacks_memory(error):
                    raise
                os.write(2, _NO_MEMORY)
                os._exit(2)  # what Python does at its end may need memory again
            interrupt = error
        status = 130
        # Python 3.12 and later add notes of their own, where it was raised in `__set_name__`.
        told = getattr(interrupt, "__notes__", ())
        notes = [note for note in told if not note.startswith("Error calling")]
        remarks = "".join(f"; {note}" for note in notes)
    signals.close()  # again, if a signal came before
    if signals.first is not None:
        status = 128 + signals.first
        from eyas.engine.terminal.stderr import say

        say(_WORDS[signals.first] + remarks)
    sys.exit(status)


def _interrupt_behind(error: BaseException | None) -> BaseException | None:
    """Return the interrupt that an error is or comes of.

    Where a class is made, Python 3.11 turns whatever is raised into a `RuntimeError`.
    """
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error


def _make_streams_usable() -> None:
    """Let anything be printed, wherever it goes.

    Without something in place of standard streams that the shell has closed, the next file that is
    opened would take their numbers, and get what libraries and other programs print.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))
        # In the language C, the dots of a name that is cut off could not be printed.
        getattr(sys, name).reconfigure(errors="backslashreplace" if name == "stderr" else "replace")


if __name__ == "__main__":
    main()
