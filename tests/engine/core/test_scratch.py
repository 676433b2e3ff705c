"""Temporary folders, and what killed processes leave of them."""

import os
import subprocess
import sys
import tempfile

import pytest

from eyas.engine.core.scratch import remove_left_scratch, scratch

HOLDS = """
import sys, time
from eyas.engine.core.scratch import scratch
with scratch() as folder:
    (folder / "roads.xml").write_text("x")
    print(folder, flush=True)
    time.sleep(600)
"""

pytest.importorskip("fcntl")


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.fixture
def holder(place):
    """A process in a folder of its own."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDS],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"TMPDIR": str(place)},
    )
    process.folder = place / process.stdout.readline().strip().rpartition("/")[2]
    yield process
    process.kill()
    process.wait()
    process.stdout.close()


def test_a_folder_lasts_as_long_as_it_is_used(place):
    with scratch() as folder:
        (folder / "net.xml").write_text("x")
        assert folder.parent == place
    assert list(place.iterdir()) == []


def test_what_a_killed_process_has_left_is_removed_and_nothing_else(place, holder):
    os.utime(holder.folder, (0, 0))
    (place / "eyas-scratch-of-someone").mkdir()
    (place / "eyas-scratch-link").symlink_to(place / "eyas-scratch-of-someone")
    (place / "others").mkdir()
    kept = {path for path in place.iterdir() if path != holder.folder}
    for path in kept:
        os.utime(path, (0, 0))
    with scratch():
        assert (holder.folder / "roads.xml").exists()  # it lives
    holder.kill()
    holder.wait()
    os.utime(holder.folder)
    remove_left_scratch()
    assert set(place.iterdir()) == kept


def test_a_folder_that_was_never_locked_goes_with_its_process(place, holder):
    never = place / f"eyas-scratch-{holder.pid}-x"
    never.mkdir()
    remove_left_scratch()
    assert never.exists()
    holder.kill()
    holder.wait()
    remove_left_scratch()
    assert not list(place.iterdir())
