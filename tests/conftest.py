"""What all tests share: options, and no skipping where CI says so."""

import ctypes
import gc
import logging
import os
import re
import runpy
import shutil
import signal
import sys
from pathlib import Path
from subprocess import CompletedProcess
from types import SimpleNamespace
from warnings import catch_warnings, simplefilter

import pytest
from hypothesis import settings

import eyas
from eyas.engine.core.doors import STREET

# The maps that a developer has imported are not there for tests.
os.environ["EYAS_MAPS_DIR"] = os.path.join(os.devnull, "maps")

# Programs that tests start print for a terminal of this width, whoever runs the tests where.
os.environ["COLUMNS"] = "80"
for name in ("FORCE_COLOR", "CLICOLOR_FORCE", "NO_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
    os.environ.pop(name, None)

# All maps in all weathers take more room than the usual limit: what a test has made would be gone
# when the next one needs it, and be made again and again.
os.environ.setdefault("EYAS_CACHE_LIMIT", "32G")

# Of the hundreds of programs that tests start, the first compiles the sources for all, and the next
# run of the tests finds them compiled, also on a machine that asks otherwise.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# No test asserts a time, and a submission meets the same examples as the last; others, and more
# of them, are tried by `--hypothesis-profile search`.
settings.register_profile("eyas", deadline=None, derandomize=True)
settings.register_profile("search", deadline=None, max_examples=1000)
settings.load_profile("eyas")


def pytest_addoption(parser):
    parser.addoption("--regenerate", action="store_true", help="redraw the golden pictures")


@pytest.fixture(autouse=True, scope="module")
def memory_given_back():
    """What a file has left in cycles, maps and networks among it, is gone before the next file."""
    yield
    gc.collect()


HOUSES = {path.parent.name for path in Path(eyas.__file__).parent.glob("*/__init__.py")}


def pytest_ignore_collect(collection_path):
    """Leave out files about a house that is not there: the engine is tried without the others."""
    if collection_path.suffix != ".py":
        return None
    named = set(re.findall(r"\beyas\.(\w+)\.\w", collection_path.read_text(encoding="utf-8")))
    return True if named & {*STREET} - HOUSES else None


FIRST = "tests/test_wheel"
"""What would keep one of two workers busy alone if it came last."""


def pytest_configure(config):
    """Workers take files in the order below, not those first that have most tests: what is loaded
    for one file is there for the next in its folder.
    """
    config.option.loadscopereorder = False


def pytest_collection_modifyitems(config, items):
    """What only a release must prove is left out, unless `-m` asks for it; what takes long begins
    first.
    """
    items.sort(key=lambda item: not item.nodeid.startswith(FIRST))
    if "thorough" in config.option.markexpr:
        return
    left_out = {item for item in items if item.get_closest_marker("thorough")}
    if left_out:
        config.hook.pytest_deselected(items=[*left_out])
        items[:] = [item for item in items if item not in left_out]


def pytest_collection_finish():
    """Modules, tests and their cases stay to the end: to look through them after each file, as
    `memory_given_back` has it, takes 0.3 s.
    """
    gc.collect()
    gc.freeze()


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node, error):
    """A worker that is lost ends the tests with a line; pytest-xdist waits for ever, or fails."""
    if error:
        work = node.config.pluginmanager.getplugin("dsession").sched.assigned_work.get(node, {})
        left = [test for tests in work.values() for test, done in tests.items() if not done]
        test = left[0] if left else "nothing"
        pytest.exit(f"worker {node.gateway.id} has ended while it ran {test}; out of memory?")


@pytest.fixture(scope="session")
def emulated():
    """What has `eyas.gpu.cuda` find a card that runs PTX on this processor."""
    if shutil.which("cc") is None:
        pytest.skip("there is no C compiler")
    sys.path.append(str(Path(__file__).parents[1] / "tools"))
    from emulated_card import emulated_card

    return emulated_card


@pytest.fixture
def eyas_command(monkeypatch, capsys):
    """Runs a command of `eyas` in this process, which saves the seconds that a start takes; where
    the process is the subject, tests start one. `eyas_command("video", ..., folder=...)`.
    """

    def run(*words, folder=None):
        from eyas.cli.main import main

        with monkeypatch.context() as patch, catch_warnings():
            simplefilter("default")
            patch.setattr(logging.root, "handlers", [])  # or it would print no line of the log
            patch.setattr(sys, "argv", ["eyas", *map(str, words)])
            patch.setattr(sys, "path", [*sys.path])
            if folder is not None:
                patch.chdir(folder)
            with pytest.raises(SystemExit) as caught:
                main()
        told = capsys.readouterr()
        return CompletedProcess(words, caught.value.code or 0, told.out, told.err)

    return run


@pytest.fixture
def empty_cache(tmp_path):
    """A folder for a cache with nothing but what sources say, which takes seconds to read: a wheel
    brings it.
    """
    from eyas.engine.core.identity.build import this_build
    from eyas.lanes.text_index import FOLDER
    from eyas.lanes.trusted import cache_folder

    this_build()
    shutil.copytree(cache_folder() / FOLDER, tmp_path / "cache" / FOLDER)
    return tmp_path / "cache"


@pytest.fixture
def regenerate(request):
    return request.config.getoption("--regenerate")


@pytest.fixture(autouse=True)
def signals():
    """Signals do in each test, and in the processes that it starts, what they do in a terminal,
    also if they were ignored when the tests were started, as in the background of a script.
    """
    hook, numbers = sys.unraisablehook, (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [signal.getsignal(number) for number in numbers]
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # `nohup` ignores it
    yield
    sys.unraisablehook = hook
    for number, handler in zip(numbers, before, strict=True):
        signal.signal(number, handler)


@pytest.fixture(autouse=True)
def memory():
    """Worlds that tests have loaded go when a process has 1,300 MiB, of which 600 are what the
    tests import.
    """
    yield
    pages = Path("/proc/self/statm")
    if pages.is_file() and int(pages.read_text().split()[1]) * 4096 > 1300 << 20:
        for name in ("eyas.engine.sim.assets", "eyas.engine.sim.scenes"):
            for each in vars(sys.modules.get(name, sys)).values():
                getattr(each, "cache_clear", int)()
        gc.collect()
        getattr(ctypes.CDLL(None), "malloc_trim", bool)(0)


@pytest.fixture(autouse=True)
def level():
    """Commands that a test has run in this process leave the level of the log as it was."""
    log = logging.getLogger("eyas")
    before = log.level
    yield
    log.setLevel(before)


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """Where EYAS_TEST_NO_SKIP is set (CI), a skipped test has failed: nothing may be missing but a
    graphics processor and checkers of formats that pip does not bring.
    """
    report = (yield).get_result()
    missing = report.skipped and not hasattr(report, "wasxfail")
    if (
        os.environ.get("EYAS_TEST_NO_SKIP")
        and missing
        and not (item.get_closest_marker("card") or item.get_closest_marker("checker"))
    ):
        report.outcome = "failed"
        report.longrepr = f"skipped, which is not allowed here: {report.longrepr}"


def pytest_assertrepr_compare(op, left, right):
    """Where folders differ, names of files are printed instead of megabytes of contents."""
    folders = all(
        isinstance(side, dict) and any(isinstance(v, bytes) for v in side.values())
        for side in (left, right)
    )
    if op != "==" or not folders:
        return None
    names = sorted(
        str(name) for name in left.keys() | right.keys() if left.get(name) != right.get(name)
    )
    return [
        f"the same {len(left)} files",
        f"{len(names)} differ or are missing: {', '.join(names[:9])}",
    ]


@pytest.fixture(scope="session")
def around():
    """Build trackers among a few solids, see `solid_worlds.build`."""
    return runpy.run_path(str(Path(__file__).parent / "solid_worlds.py"))["build"]


@pytest.fixture(scope="session")
def plain_words():
    """A reader of phrases, see `plain_words`."""
    return SimpleNamespace(**runpy.run_path(str(Path(__file__).parent / "plain_words.py")))


@pytest.fixture(scope="session")
def staying():
    """Which actors of a traffic source stay from a time to another [s]: a function of the three."""

    def actors(source, start, end):
        stays = source.stays()
        there = (stays.enters - 1e-9 <= start) & (end - 1e-9 <= stays.leaves)
        return sorted(set(stays.actor[there].tolist()))

    return actors
