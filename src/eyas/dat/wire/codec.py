"""The text of actions and packets, one line each, as the original's client writes and reads it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ActionError

_FASTEST = 1e4  # Largest number in an action, as for the speeds of the environments' actions


class Action(NamedTuple):
    """What a client asks for."""

    command: tuple[float, float, float, float]
    """Forward [m/s], left [m/s], up [m per 2 ms], yaw rate, counter-clockwise [rad/s]."""
    reset: bool  # Whether it asks for a new episode instead


HOVER = Action((0.0, 0.0, 0.0, 0.0), reset=False)
RESET = HOVER._replace(reset=True)  # What clients send first


def parse_action(line: bytes) -> Action:
    r"""Return the action of a line `a0,a1,a2,a3,r`, without its line break.

    Args:
        line: Four numbers, and 1 for a reset or 0.

    Raises:
        ActionError: It is something else.
    """
    try:
        *command, reset = map(float, line.decode("ascii").split(","))
    except ValueError:
        command, reset = [], math.nan
    forward, left, up, turn, *more = [*command, *[math.nan] * 4]
    known = len(more) == 4 and reset in (0.0, 1.0)
    if not known or not all(abs(number) <= _FASTEST for number in command):
        raise ActionError(
            f"action line {line[:60]!r} is not allowed: four numbers from -{_FASTEST:g} to "
            f"{_FASTEST:g} and 0 or 1 (reset), separated by commas"
        )
    return Action((forward, left, up, turn), reset=reset == 1.0)


def packet_line(numbers: NDArray[np.float64], *words: str) -> bytes:
    """Return a packet as a line.

    Every number reads back to the same double; the original rounds to six digits. As there, whole
    numbers have no decimal point.

    Args:
        numbers: The numbers of a packet, shape (P,).
        words: What follows them.
    """
    # Of a list as a whole: a call for each number takes four times as long.
    text = repr(numbers.tolist())[1:-1].replace(" ", "") + ","
    return (text.replace(".0,", ",") + ",".join(words)).rstrip(",").encode() + b"\n"
