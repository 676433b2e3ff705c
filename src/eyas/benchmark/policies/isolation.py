"""What keeps a policy's process from reading the evaluator's, on Linux; elsewhere nothing does.

The evaluator's memory and environment are closed to other processes of the same user, its command
line, which may name seeds, is shortened, and the policy's process gives up what rights it has.
Where `bwrap` (bubblewrap) works, it does not see the evaluator's process at all. Files of the user
can still be read: code of strangers belongs into a container.
"""

import ctypes
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

_DUMPABLE, _NO_NEW_PRIVILEGES = 4, 38  # Options of prctl
_CAPABILITIES = 0x20080522  # Version of the structure that capset takes
_ARGUMENTS = 47, 48  # Fields of /proc/self/stat: where the command line begins and ends
_KEPT = 2  # Words of the command line that stay: Python and the program


@cache
def close_memory() -> None:
    """Close this process to others of its user, and shorten its command line."""
    if sys.platform != "linux":
        return
    ctypes.CDLL(None).prctl(_DUMPABLE, 0, 0, 0, 0)
    try:
        fields = Path("/proc/self/stat").read_text().rpartition(")")[2].split()
        words = Path("/proc/self/cmdline").read_bytes().split(b"\0")[:_KEPT]
    except OSError:  # nothing is mounted there, and so nothing can be read there
        return
    begin, end = (int(fields[number - 2]) for number in _ARGUMENTS)
    shown = sum(len(word) + 1 for word in words)
    ctypes.memset(begin + shown, 0, max(end - begin - shown, 0))


def give_up_rights() -> None:
    """Give up all capabilities, as the superuser has them, and the way to new ones."""
    if sys.platform != "linux":
        return
    libc = ctypes.CDLL(None)
    libc.prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0)
    libc.capset((ctypes.c_uint32 * 2)(_CAPABILITIES, 0), (ctypes.c_uint32 * 6)())


@cache
def wrapped() -> tuple[str, ...]:
    """Return the words before a command with which it sees no other processes; none: not here."""
    program = shutil.which("bwrap")
    if program is None:
        return ()
    hidden = ("--unshare-pid", "--proc", "/proc", "--die-with-parent")
    words = (program, "--dev-bind", "/", "/", *hidden)
    try:
        tried = subprocess.run([*words, sys.executable, "-c", ""], capture_output=True, timeout=20)
    except (OSError, subprocess.TimeoutExpired):
        return ()
    return words if tried.returncode == 0 else ()
