"""The files by which a tracker and its client talk: each is written by one side and deleted by the
other.
"""

import os
import time
from pathlib import Path
from typing import NamedTuple

_PAUSE = 0.0005  # Between two looks at a file [s]


class Request(NamedTuple):
    """What a client asks for."""

    command: tuple[float, float, float, float]
    """Forward [m/s], left [m/s], up [m per 2 ms], counter-clockwise [rad/s]."""
    reset: bool


def parsed(line: str) -> Request:
    """Return the request of a line `a0,a1,a2,a3,r`."""
    forward, left, up, turn, reset = map(float, line.split(","))
    return Request((forward, left, up, turn), reset == 1.0)


class Exchange:
    """The files of one tracker.

    Args:
        folder: The project's `Files2Alg`.
        name: Of the tracker, such as `DRONE0`.
    """

    def __init__(self, folder: Path, name: str) -> None:
        self._action = folder / f"{name}_AlgAction.txt"
        self._answers = [
            folder / f"{name}_{part}"
            for part in ("Ctrl2Global.txt", "RewardParams.txt", "PointCloud.txt")
        ]
        self.picture = folder / f"{name}_VideoFrame.jpeg"

    def request(self) -> Request:
        """Wait for the client's action; take it."""
        while True:
            try:
                text = self._action.read_text(encoding="ascii")
            except FileNotFoundError:
                text = ""
            if text.endswith("\n"):  # else it is being written
                self._action.unlink()
                return parsed(text)
            time.sleep(_PAUSE)

    def answer(self, lines: list[str | None]) -> None:
        """Give the basic, the reward and the radar packet, as far as there are any, each after the
        one before was read.
        """
        for path, line in zip(self._answers, lines, strict=True):
            if line is not None:
                part = path.with_suffix(".part")
                part.write_text(line + "\n", encoding="ascii")
                _given(part, path)

    def show(self, part: Path) -> None:
        """Give the picture that a file holds."""
        _given(part, self.picture)


def _given(part: Path, path: Path) -> None:
    while path.exists():
        time.sleep(_PAUSE)
    os.replace(part, path)
    while path.exists():
        time.sleep(_PAUSE)
