import logging
import os

import pytest

from eyas.wire.codec import HOVER, Action
from eyas.wire.exchange import Names
from eyas.wire.post import Part, Post


@pytest.fixture
def heard():
    return []


@pytest.fixture
def post(tmp_path, heard):
    return Post(Names(tmp_path, "DRONE0"), heard.append)


def parts(names, **contents):
    given = {"state": b"s\n", "reward": b"r\n", "picture": b"p", **contents}
    return [Part(getattr(names, name), lambda c=content: c) for name, content in given.items()]


def files(post):
    return sorted(path.name for path in post.names.action.parent.iterdir())


def test_an_action_is_taken_when_its_line_is_whole(post, heard):
    assert not post.poll()
    post.names.action.write_bytes(b"")
    assert not post.poll()
    post.names.action.write_bytes(b"1.0,0,0,")
    assert not post.poll()
    post.names.action.write_bytes(b"1.0,0,0,0,0\r\n2,0,0,0,0\n")
    assert post.poll()
    assert post.action == Action((1.0, 0.0, 0.0, 0.0), reset=False)
    assert heard == [b"1.0,0,0,0,0"]
    assert files(post) == []  # which tells the client to go on


def test_the_files_of_an_answer_come_one_after_the_other(post):
    names = post.names
    post.answer(parts(names))
    for name, content in (("state", b"s\n"), ("reward", b"r\n"), ("picture", b"p")):
        path = getattr(names, name)
        assert post.poll()
        assert not post.poll()
        assert files(post) == [path.name]
        assert path.read_bytes() == content
        path.unlink()
    assert not post.names.action.exists()
    assert post.poll()
    assert post.owes
    assert files(post) == []


def test_a_picture_that_is_not_drawn_yet_is_waited_for(post):
    drawn = [None, None, b"p"]
    post.answer([Part(post.names.picture, lambda: drawn.pop(0))])
    assert [post.poll() for _ in range(3)] == [False, False, True]
    assert not drawn
    assert post.names.picture.read_bytes() == b"p"


@pytest.mark.parametrize("content", [b"rubbish\n", b"\x00\xff\n", b"\n", b"7" * 5000])
def test_a_malformed_line_is_told_and_means_to_hover(post, caplog, content):
    post.names.action.write_bytes(content)
    assert post.poll()
    assert post.action == HOVER
    assert files(post) == []
    (record,) = caplog.records
    assert record.levelno == logging.ERROR
    assert record.message.startswith("DRONE0: action line b")
    assert record.message.endswith("; it hovers")


def test_a_line_that_never_ends_is_taken_after_a_while(post, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    post.names.action.write_bytes(b"0,0,0,0")
    assert not post.poll()
    now[0] += 0.9
    post.names.action.write_bytes(b"0,0,0,0,1")  # it grows: the client is only slow
    assert not post.poll()
    now[0] += 0.9
    assert not post.poll()
    now[0] += 0.2
    assert post.poll()
    assert post.action.reset


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes")
def test_a_pipe_or_a_link_in_the_place_of_an_action_is_not_read(post, tmp_path, caplog):
    os.mkfifo(post.names.action)
    assert post.poll()
    assert post.action == HOVER
    post.answer([])
    secret = tmp_path / "secret"
    secret.write_text("1,1,1,1,0\n")
    post.names.action.symlink_to(secret)
    assert post.poll()
    assert post.action == HOVER
    assert files(post) == ["secret"]
    assert len(caplog.records) == 2


def test_a_folder_in_the_place_of_an_action_is_put_aside_with_what_is_in_it(post, caplog):
    for number in (1, 2):
        post.names.action.mkdir()
        (post.names.action / "mine.txt").write_text("kept")
        assert post.poll()
        assert post.action == HOVER
        assert files(post)[number - 1 :] == [f"DRONE0_AlgAction.txt.folder-{number}"]
        post.answer([])
    assert caplog.messages == 2 * ["DRONE0: DRONE0_AlgAction.txt: not an ordinary file; it hovers"]
    assert (post.names.action.parent / files(post)[0] / "mine.txt").read_text() == "kept"
    post.names.action.write_text("0,0,0,0,1\n")
    assert post.poll()
    assert post.action.reset


def test_a_new_client_takes_the_place_of_one_that_has_left_its_answer(post, caplog, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    post.answer(parts(post.names))
    post.poll()
    post.names.state.unlink()
    post.poll()
    post.names.action.write_text("0,0,0,0,1\n")
    now[0] += 0.1
    assert post.poll()
    assert files(post) == [post.names.action.name]
    assert "DRONE0: a new action while DRONE0_RewardParams.txt was not taken" in caplog.text
    assert post.poll()
    assert post.action.reset


def test_what_was_not_taken_can_be_withdrawn(post):
    for shown in (False, True):
        post.answer(parts(post.names))
        assert not shown or post.poll()
        post.withdraw()
        assert files(post) == []
        assert post.owes
    post.withdraw()


def test_files_that_cannot_be_written_are_told_once_and_tried_again(post, caplog, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    folder = post.names.action.parent
    folder.rmdir()
    post.answer(parts(post.names))
    with caplog.at_level(logging.INFO, "eyas"):
        for _ in range(5):
            assert not post.poll()
            now[0] += 1.0
        folder.mkdir()
        assert post.poll()
    assert len(caplog.messages) == 2
    assert "cannot write: No such file or directory; trying again" in caplog.messages[0]
    assert caplog.messages[1].endswith("DRONE0_Ctrl2Global.txt: written again")
    assert files(post) == ["DRONE0_Ctrl2Global.txt"]


def test_who_has_to_do_the_next_thing(post):
    assert post.owes  # an action
    post.names.action.write_text("0,0,0,0,0\n")
    post.poll()
    assert not post.owes
    post.answer(parts(post.names, state=None))
    post.poll()
    assert not post.owes  # the state is not ready
    post.answer([])
