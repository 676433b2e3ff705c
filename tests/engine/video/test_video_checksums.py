"""Checksums of a recording's episodes: one that is damaged is known."""

from types import SimpleNamespace

import pytest

from eyas.engine.exports.checksums import CHECKSUMS, GROWING, read_checksums
from eyas.engine.exports.writer import Files
from eyas.engine.video.recorder import Checksums

WRITERS = [SimpleNamespace(files=Files(frame=("{:06d}.jpeg",), episode=("labels.jsonl",)))]


@pytest.fixture
def episode(tmp_path):
    folder = tmp_path / "DRONE0" / "episode0"
    folder.mkdir(parents=True)
    for name in ("000000.jpeg", "000001.jpeg", "labels.jsonl"):
        (folder / name).write_text(name)
    return folder


def test_an_episode_matches_until_a_file_changes_comes_or_goes(tmp_path, episode):
    checksums = Checksums(tmp_path, WRITERS)
    assert not checksums.match(episode)
    checksums.add(episode)
    assert checksums.match(episode)
    assert Checksums(tmp_path, WRITERS).match(episode)  # what an earlier run has written
    for change in (
        lambda: (episode / "000001.jpeg").write_text("damaged"),
        lambda: (episode / "000001.jpeg").unlink(),
        lambda: (episode / "000002.jpeg").write_text("one more"),
    ):
        checksums.add(episode)
        change()
        assert not checksums.match(episode)


def test_a_line_that_was_cut_off_spoils_no_other(tmp_path, episode):
    (tmp_path / GROWING).write_bytes(b"0f3a")
    Checksums(tmp_path, WRITERS).add(episode)
    assert Checksums(tmp_path, WRITERS).match(episode)


def test_the_file_of_all_is_in_order_and_replaces_the_growing_one(tmp_path, episode):
    checksums = Checksums(tmp_path, WRITERS)
    checksums.add(episode)
    checksums.finish()
    assert [*read_checksums(tmp_path / CHECKSUMS)] == [
        "DRONE0/episode0/000000.jpeg",
        "DRONE0/episode0/000001.jpeg",
        "DRONE0/episode0/labels.jsonl",
    ]
    assert not (tmp_path / GROWING).exists()
