"""Code that only Linux or POSIX can run has a guard, so that Windows and macOS can import the rest.

Nobody has run Eyas there. What is looked at here is the text of the program.
"""

import ast
import re
from pathlib import Path

import pytest

import eyas

SOURCES = sorted(Path(eyas.__file__).parent.rglob("*.py"))

MODULES = frozenset("fcntl grp posix pty pwd resource syslog termios tty".split())
"""Modules that Windows lacks."""

FUNCTIONS = {
    "os": frozenset(
        "chown fchmod fchown fork forkpty getegid geteuid getgid getloadavg getpgid getuid killpg"
        " memfd_create mkfifo nice openpty posix_fadvise posix_fallocate posix_spawn pread preadv"
        " pwrite pwritev sched_getaffinity sched_setaffinity sched_setscheduler sched_yield"
        " sendfile setpriority setsid statvfs sysconf uname wait3 wait4"
        " O_CLOEXEC O_DIRECTORY O_NOFOLLOW O_TMPFILE".split()
    ),
    "signal": frozenset(
        "SIGALRM SIGCHLD SIGHUP SIGKILL SIGPIPE SIGSTOP SIGUSR1 SIGUSR2 alarm pause"
        " pthread_kill pthread_sigmask setitimer sigwait".split()
    ),
}
"""What some of Windows, macOS and Linux lack in modules that all have."""


MENTIONED = re.compile(rf"\b({'|'.join(MODULES.union(*FUNCTIONS.values()))})\b")


def unguarded(text: str) -> list[str]:
    """Return what a program uses of these and has no guard for.

    A guard is `except ImportError` around the import of a module. For a function it is a guarded
    module in the same file, whose absence the code asks for, or `hasattr` with its name.
    """
    if not MENTIONED.search(text):
        return []
    tree = ast.parse(text)
    tries = [
        each
        for each in ast.walk(tree)
        if isinstance(each, ast.Try)
        and any("ImportError" in ast.unparse(caught.type or caught) for caught in each.handlers)
    ]
    guarded = {found for each in tries for one in each.body for found in _modules(one)}
    asked = {
        str(each.args[1].value)
        for each in ast.walk(tree)
        if isinstance(each, ast.Call)
        and ast.unparse(each.func) in ("hasattr", "getattr")
        and len(each.args) > 1
        and isinstance(each.args[1], ast.Constant)
    }
    wrong = [found for found in _modules(tree) if found not in guarded]
    for each in ast.walk(tree):
        if isinstance(each, ast.Attribute) and isinstance(each.value, ast.Name):
            lacking = each.attr in FUNCTIONS.get(each.value.id, ())
            if lacking and each.attr not in asked and not guarded:
                wrong.append(f"{each.value.id}.{each.attr}")
    return wrong


def _modules(tree: ast.AST) -> list[str]:
    """Return which of `MODULES` are imported anywhere in a piece of a program."""
    names = []
    for each in ast.walk(tree):
        if isinstance(each, ast.Import):
            names += [alias.name for alias in each.names]
        elif isinstance(each, ast.ImportFrom):
            names.append(each.module or "")
    return [name for name in names if name in MODULES]


@pytest.mark.slow
def test_no_module_needs_linux_to_be_imported_or_to_draw():
    found = {path.name: unguarded(path.read_text()) for path in SOURCES}
    assert {name: wrong for name, wrong in found.items() if wrong} == {}
    assert len(SOURCES) > 500


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("import fcntl", ["fcntl"]),
        ("def f():\n    from resource import getrusage", ["resource"]),
        ("try:\n    import fcntl\nexcept OSError:\n    pass", ["fcntl"]),
        ("try:\n    import fcntl\nexcept ImportError:\n    fcntl = None", []),
        ("import os\nos.fork()", ["os.fork"]),
        ("import os\nx = os.getuid() if hasattr(os, 'getuid') else 0", []),
        ("import os, signal\nos.kill(1, signal.SIGKILL)", ["signal.SIGKILL"]),
    ],
)
def test_what_counts_as_a_guard(text, wrong):
    assert unguarded(text) == wrong
