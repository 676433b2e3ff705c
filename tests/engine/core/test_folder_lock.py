import errno
import logging
import os
import re
import signal
import subprocess
import sys

import pytest

from eyas.engine.core.errors import OutputError
from eyas.engine.core.folder_lock import fcntl, folder_lock
from eyas.engine.settings.config import EyasConfig
from eyas.engine.video.folder import check_folder, open_folder

HOLD = """
import sys, time
from pathlib import Path
from eyas.engine.core.folder_lock import folder_lock
with folder_lock(Path(sys.argv[1]), "recording into it"):
    print("locked", flush=True)
    time.sleep(60)
"""


WITHOUT_LOCKS = """
import sys
sys.modules["fcntl"] = None
from pathlib import Path
from eyas.engine.core.folder_lock import folder_lock
with folder_lock(Path(sys.argv[1]), "recording into it"):
    print("records", flush=True)
"""


@pytest.fixture
def other(tmp_path):
    """Another process that holds the folder's lock."""
    command = [sys.executable, "-c", HOLD, str(tmp_path / "a")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "locked\n"
        yield process
        process.kill()


def test_a_second_recorder_is_refused_in_one_line_that_names_the_first(tmp_path, other):
    line = f"{tmp_path / 'a'}: process {other.pid} is recording into it; "
    with (
        pytest.raises(OutputError, match=f"^{re.escape(line)}"),
        folder_lock(tmp_path / "a", "recording into it"),
    ):
        raise AssertionError("both record")
    assert (tmp_path / "a" / ".lock").read_text() == str(other.pid)


def test_what_a_killed_recorder_leaves_locks_nobody_out(tmp_path, other):
    other.send_signal(signal.SIGKILL)
    other.wait()
    assert (tmp_path / "a" / ".lock").exists()
    check_folder(tmp_path / "a", EyasConfig(), overwrite=False, resume=False)
    with folder_lock(tmp_path / "a", "recording into it"):
        assert (tmp_path / "a" / ".lock").read_text() == str(os.getpid())
    assert not list((tmp_path / "a").iterdir())


def test_the_lock_goes_with_the_recorder_even_one_that_fails(tmp_path):
    with pytest.raises(ZeroDivisionError), folder_lock(tmp_path / "a", "recording into it"):
        raise ZeroDivisionError
    assert not list((tmp_path / "a").iterdir())


def test_overwriting_a_recording_keeps_the_lock(tmp_path):
    path = tmp_path / "a"
    with folder_lock(path, "recording into it"):
        open_folder(path, EyasConfig(), overwrite=False, resume=False)
        open_folder(path, EyasConfig(), overwrite=True, resume=False)
        with (
            pytest.raises(OutputError, match=f"process {os.getpid()}"),
            folder_lock(path, "recording into it"),
        ):
            raise AssertionError("both record")


def test_a_file_where_the_folder_should_be_is_one_line(tmp_path):
    (tmp_path / "a").write_text("mine")
    with (
        pytest.raises(OutputError, match="cannot write"),
        folder_lock(tmp_path / "a", "recording into it"),
    ):
        raise AssertionError("there is no folder")


def test_without_locks_of_the_file_system_there_is_a_warning(tmp_path, monkeypatch, caplog):
    def refuse(file, operation):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with caplog.at_level(logging.WARNING, "eyas"), folder_lock(tmp_path / "a", "recording into it"):
        (line,) = caplog.messages
    assert "no other process is recording into it: No locks available" in line
    assert not list((tmp_path / "a").iterdir())


def test_without_locks_of_the_system_it_records_too(tmp_path):
    command = [sys.executable, "-c", WITHOUT_LOCKS, str(tmp_path / "a")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == "records\n"
    assert "make sure that no other process is recording into it" in done.stderr
    assert not list((tmp_path / "a").iterdir())
