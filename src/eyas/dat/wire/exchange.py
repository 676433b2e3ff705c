"""The folder in which simulator and clients exchange files, the lines in them, and the waiting."""

import math
import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ActionError, DataFileError, OutputError
from eyas.engine.core.files import PART_SUFFIX, refusals, write_atomic
from eyas.engine.core.folder_lock import folder_lock

_SHORTEST, _LONGEST = 0.0002, 0.02
"""Limits of a sleep [s]. Clients of the original look once in a millisecond themselves."""

RARE = 0.05  # Time without an event after which to look for what happens rarely, too [s]


class Pause:
    """Sleeps between two looks at something: a tenth of the time waited so far.

    So waiting for long costs next to nothing, and what comes is seen at most a tenth (and 20 ms)
    too late. Notifications of the file system are not used, as network folders have none.
    """

    def __init__(self) -> None:
        self._since = time.monotonic()

    @property
    def long(self) -> bool:
        """Whether nothing has happened for so long that rare things may have."""
        return time.monotonic() - self._since > RARE

    def restart(self) -> None:
        """Begin to wait anew, because something happened."""
        self._since = time.monotonic()

    def sleep(self) -> None:
        """Sleep once."""
        waited = time.monotonic() - self._since
        time.sleep(min(max(0.1 * waited, _SHORTEST), _LONGEST))


_SIMULATOR = Path("Webots_Simulation", "traffic_project")

SETTINGS_FILE = _SIMULATOR / "config" / "env_config.json"
"""The settings of the original's simulator, below its root; its clients read them too."""

_COARSE = 0.02  # Largest lag of file times behind the clock, some ticks of the kernel [s]

_START = "start.txt"
_OURS = re.compile(
    r"(DRONE|CAR)\d+_(AlgAction|Ctrl2Global|RewardParams|PointCloud)\.txt"
    r"|(DRONE|CAR)\d+_VideoFrame\.jpeg|recv_action\d+\.txt|start\.txt"
)
"""The files of the protocol; those of an earlier run are deleted."""


class Names:
    """The files by which one tracker's client and its simulator talk.

    Each is written by one side and deleted by the other; it exists while it has not been read.

    Attributes:
        tracker: Name of the tracker, such as `DRONE0`.
        action: The client's action.
        state: The answer's basic packet.
        reward: The answer's reward packet.
        radar: The answer's radar packet.
        picture: The answer's picture.

    Args:
        tracker: Name of the tracker.
    """

    def __init__(self, folder: Path, tracker: str) -> None:
        self.tracker = tracker
        self.action = folder / f"{tracker}_AlgAction.txt"
        self.state = folder / f"{tracker}_Ctrl2Global.txt"
        self.reward = folder / f"{tracker}_RewardParams.txt"
        self.radar = folder / f"{tracker}_PointCloud.txt"
        self.picture = folder / f"{tracker}_VideoFrame.jpeg"


class ExchangeFolders:
    """The folders below the original's root that a server uses; the root may be empty.

    Args:
        root: Folder with the original's `Webots_Simulation`; it may be empty.

    Raises:
        DataFileError: There is no such folder.
        OutputError: Links lead out of it, and nothing outside it is ever changed.
    """

    def __init__(self, root: Path) -> None:
        if not root.is_dir():
            raise DataFileError(
                f"{root}: no such folder; give the one that holds the original's "
                "Webots_Simulation and Alg_Base, or an empty one for a client of your own"
            )
        simulator = root / _SIMULATOR
        self.files, self.logs = simulator / "Files2Alg", simulator / "logs"
        self.settings = root / SETTINGS_FILE
        for path in (self.files, self.logs, self.settings):
            if not path.resolve().is_relative_to(root.resolve()):
                raise OutputError(f"{path}: a link leads out of {root}, where nothing is changed")

    def names(self, tracker: str) -> Names:
        """Return the files of a tracker."""
        return Names(self.files, tracker)

    @contextmanager
    def opened(self, since: float = math.inf) -> Iterator[int]:
        """Keep the folder for this process, without files of an earlier run; yield their number.

        Args:
            since: When clients could first announce themselves [s, as `time.time`]: files that are
                newer are theirs.

        The file by which the original says that it has started exists until the block is left.

        Raises:
            OutputError: Another server uses the folder, or writing failed.
        """
        with folder_lock(self.files, "serving in it"):
            try:
                removed = self._clear(since - _COARSE)
                write_atomic(self.files / _START, b"b'1\\n'\n")
                yield removed
            finally:
                with suppress(OutputError):  # why the server ends is told, not this
                    self._clear()

    def _clear(self, before: float = math.inf) -> int:
        """Delete the files of the protocol that are older than a time; return how many."""
        removed = 0
        with refusals(self.files):
            for found in list(os.scandir(self.files)):
                name = found.name.removeprefix(".").removesuffix(PART_SUFFIX)
                if not _OURS.fullmatch(name) or found.is_dir(follow_symlinks=False):
                    continue
                with suppress(FileNotFoundError):  # a client has just taken it
                    if found.stat(follow_symlinks=False).st_mtime >= before:
                        continue
                    Path(found.path).unlink(missing_ok=True)
                    removed += 1
        return removed


_FASTEST = 1e4  # Largest number in an action, as for the speeds of the environments' actions


class Action(NamedTuple):
    """What a client asks for."""

    command: tuple[float, float, float, float]
    """Forward [m/s], left [m/s], up [m per 2 ms], yaw rate, counter-clockwise [rad/s]."""
    reset: bool  # Whether it asks for a new episode instead


HOVER = Action((0.0, 0.0, 0.0, 0.0), reset=False)
RESET = HOVER._replace(reset=True)  # What clients send first


def parse_action(
    line: bytes,  # Four numbers, and 1 for a reset or 0
) -> Action:
    r"""Return the action of a line `a0,a1,a2,a3,r`, without its line break.

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
