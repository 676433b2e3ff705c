import logging
import os

import pytest

from eyas.dat.wire.client_session import AnswerFile, ClientSession
from eyas.dat.wire.exchange import HOVER, Action, Names


@pytest.fixture
def heard():
    return []


@pytest.fixture
def session(tmp_path, heard):
    return ClientSession(Names(tmp_path, "DRONE0"), heard.append)


def parts(names, **contents):
    given = {"state": b"s\n", "reward": b"r\n", "picture": b"p", **contents}
    return [
        AnswerFile(getattr(names, name), lambda c=content: c) for name, content in given.items()
    ]


def files(session):
    return sorted(path.name for path in session.names.action.parent.iterdir())


def test_an_action_is_taken_when_its_line_is_whole(session, heard):
    assert not session.poll()
    session.names.action.write_bytes(b"")
    assert not session.poll()
    session.names.action.write_bytes(b"1.0,0,0,")
    assert not session.poll()
    session.names.action.write_bytes(b"1.0,0,0,0,0\r\n2,0,0,0,0\n")
    assert session.poll()
    assert session.action == Action((1.0, 0.0, 0.0, 0.0), reset=False)
    assert heard == [b"1.0,0,0,0,0"]
    assert files(session) == []  # which tells the client to go on


def test_the_files_of_an_answer_come_one_after_the_other(session):
    names = session.names
    session.answer(parts(names))
    for name, content in (("state", b"s\n"), ("reward", b"r\n"), ("picture", b"p")):
        path = getattr(names, name)
        assert session.poll()
        assert not session.poll()
        assert files(session) == [path.name]
        assert path.read_bytes() == content
        path.unlink()
    assert not session.names.action.exists()
    assert session.poll()
    assert session.owes
    assert files(session) == []


def test_a_picture_that_is_not_drawn_yet_is_waited_for(session):
    drawn = [None, None, b"p"]
    session.answer([AnswerFile(session.names.picture, lambda: drawn.pop(0))])
    assert [session.poll() for _ in range(3)] == [False, False, True]
    assert not drawn
    assert session.names.picture.read_bytes() == b"p"


@pytest.mark.parametrize("content", [b"rubbish\n", b"\x00\xff\n", b"\n", b"7" * 5000])
def test_a_malformed_line_is_told_and_means_to_hover(session, caplog, content):
    session.names.action.write_bytes(content)
    assert session.poll()
    assert session.action == HOVER
    assert files(session) == []
    (record,) = caplog.records
    assert record.levelno == logging.ERROR
    assert record.message.startswith("DRONE0: action line b")
    assert record.message.endswith("; it hovers")


def test_a_line_that_never_ends_is_taken_after_a_while(session, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    session.names.action.write_bytes(b"0,0,0,0")
    assert not session.poll()
    now[0] += 0.9
    session.names.action.write_bytes(b"0,0,0,0,1")  # it grows: the client is only slow
    assert not session.poll()
    now[0] += 0.9
    assert not session.poll()
    now[0] += 0.2
    assert session.poll()
    assert session.action.reset


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes")
def test_a_pipe_or_a_link_in_the_place_of_an_action_is_not_read(session, tmp_path, caplog):
    os.mkfifo(session.names.action)
    assert session.poll()
    assert session.action == HOVER
    session.answer([])
    secret = tmp_path / "secret"
    secret.write_text("1,1,1,1,0\n")
    session.names.action.symlink_to(secret)
    assert session.poll()
    assert session.action == HOVER
    assert files(session) == ["secret"]
    assert len(caplog.records) == 2


def test_a_folder_in_the_place_of_an_action_is_put_aside_with_what_is_in_it(session, caplog):
    for number in (1, 2):
        session.names.action.mkdir()
        (session.names.action / "mine.txt").write_text("kept")
        assert session.poll()
        assert session.action == HOVER
        assert files(session)[number - 1 :] == [f"DRONE0_AlgAction.txt.folder-{number}"]
        session.answer([])
    assert caplog.messages == 2 * ["DRONE0: DRONE0_AlgAction.txt: not an ordinary file; it hovers"]
    assert (session.names.action.parent / files(session)[0] / "mine.txt").read_text() == "kept"
    session.names.action.write_text("0,0,0,0,1\n")
    assert session.poll()
    assert session.action.reset


def test_a_new_client_takes_the_place_of_one_that_has_left_its_answer(session, caplog, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    session.answer(parts(session.names))
    session.poll()
    session.names.state.unlink()
    session.poll()
    session.names.action.write_text("0,0,0,0,1\n")
    now[0] += 0.1
    assert session.poll()
    assert files(session) == [session.names.action.name]
    assert "DRONE0: a new action while DRONE0_RewardParams.txt was not taken" in caplog.text
    assert session.poll()
    assert session.action.reset


def test_what_was_not_taken_can_be_withdrawn(session):
    for shown in (False, True):
        session.answer(parts(session.names))
        assert not shown or session.poll()
        session.withdraw()
        assert files(session) == []
        assert session.owes
    session.withdraw()


def test_files_that_cannot_be_written_are_told_once_and_tried_again(session, caplog, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    folder = session.names.action.parent
    folder.rmdir()
    session.answer(parts(session.names))
    with caplog.at_level(logging.INFO, "eyas"):
        for _ in range(5):
            assert not session.poll()
            now[0] += 1.0
        folder.mkdir()
        assert session.poll()
    assert len(caplog.messages) == 2
    assert "cannot write: No such file or directory; trying again" in caplog.messages[0]
    assert caplog.messages[1].endswith("DRONE0_Ctrl2Global.txt: written again")
    assert files(session) == ["DRONE0_Ctrl2Global.txt"]


def test_who_has_to_do_the_next_thing(session):
    assert session.owes  # an action
    session.names.action.write_text("0,0,0,0,0\n")
    session.poll()
    assert not session.owes
    session.answer(parts(session.names, state=None))
    session.poll()
    assert not session.owes  # the state is not ready
    session.answer([])
