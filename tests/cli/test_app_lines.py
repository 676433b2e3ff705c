"""Lines of the log on a terminal and in a file."""

import io
import logging

from eyas.cli.app import _Line, _Lines

PASSING = {"passing": "houses"}


class Terminal(io.StringIO):
    def isatty(self):
        return True


def written(stream):
    handler = _Lines(stream)
    handler.setFormatter(_Line())
    log = logging.Logger("eyas")
    log.addHandler(handler)
    for seconds in (5, 4):
        log.info("making %s, %d s left", "houses", seconds, extra=PASSING)
        log.info("", extra=PASSING)
    log.info("done")
    return stream.getvalue()


def test_what_passes_is_one_line_that_changes_on_a_terminal():
    making, clear = "\x1b[2Keyas: making houses, {} s left\r", "\x1b[2K\r"
    shown = f"{making.format(5)}{clear}{making.format(4)}{clear}\x1b[2Keyas: done\n"
    assert written(Terminal()) == shown


def test_elsewhere_each_stage_that_passes_is_one_line():
    assert written(io.StringIO()) == "eyas: making houses, 5 s left\neyas: done\n"
