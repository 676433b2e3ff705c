"""What is read from source texts: the same whether it was brought, kept or has just been read."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import eyas
from eyas.engine.core.identity.definitions import INDEX as DEFINITIONS
from eyas.lanes import text_index, trusted
from eyas.lanes.container import unpacked
from eyas.lanes.syntax import INDEX as SYNTAX
from eyas.lanes.text_index import TextIndex, digest_of

PACKAGE = Path(eyas.__file__).parent
TEXTS = [b"one", b"two", b"three"]


@pytest.fixture
def cache(tmp_path, monkeypatch):
    path = tmp_path / "cache"
    monkeypatch.setenv("EYAS_CACHE_DIR", str(path))
    monkeypatch.setattr(trusted, "_WARNED", [])
    return path


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "reader.py"
    path.write_text("a first version")
    return path


@pytest.fixture
def made(source, cache):
    """Return a maker of indexes, as in a process each, and the texts that were read."""
    read = []

    def process():
        return TextIndex(source, lambda text: read.append(text) or {"b": [len(text)], "a": None})

    return process, read


def test_texts_are_read_once_and_then_come_from_the_cache(made):
    process, read = made
    first = process()
    told = [first.of(text) for text in TEXTS]
    first.keep()
    assert told == [process().of(text) for text in TEXTS] == [first.of(text) for text in TEXTS]
    assert read == TEXTS


def test_texts_that_came_with_a_wheel_are_not_read_and_not_kept(made, cache):
    process, read = made
    index = process()
    index.shipped.write_bytes(index.content(TEXTS))
    told = [index.of(text) for text in TEXTS]
    index.keep()
    assert told == [{"a": None, "b": [len(text)]} for text in TEXTS]
    assert [*told[0]] == ["a", "b"]  # digests of builds depend on the order
    assert read == TEXTS
    assert not cache.exists()


def test_an_edited_text_is_read_beside_what_came_with_a_wheel(made):
    process, read = made
    process().shipped.write_bytes(process().content(TEXTS))
    read.clear()
    index = process()
    assert index.of(b"edited") == {"a": None, "b": [6]}
    index.keep()
    assert [process().of(text) for text in (*TEXTS, b"edited")]
    assert read == [b"edited"]


def test_what_another_version_of_the_function_has_read_is_passed_over(made, source):
    process, read = made
    process().shipped.write_bytes(process().content(TEXTS))
    process().of(b"edited")
    process().keep()
    read.clear()
    source.write_text("another version")
    for text in (*TEXTS, b"edited"):
        process().of(text)
    assert read == [*TEXTS, b"edited"]


def test_processes_keep_what_others_have_kept_meanwhile(made):
    process, read = made
    one, two = process(), process()
    one.of(b"one")
    two.of(b"two")
    one.keep()
    two.keep()
    assert [process().of(text) for text in (b"one", b"two")]
    assert read == [b"one", b"two"]


def test_the_oldest_texts_go(made, monkeypatch):
    process, read = made
    monkeypatch.setattr(text_index, "_MOST", 2)
    index = process()
    for text in TEXTS:
        index.of(text)
        index.keep()
    process().of(b"three")
    process().of(b"two")
    assert read == TEXTS
    process().of(b"one")
    assert read == [*TEXTS, b"one"]


@pytest.mark.parametrize("damage", [lambda b: b[:-1], lambda b: b"", lambda b: b[:-2] + b"xx"])
@pytest.mark.parametrize("place", ["kept", "shipped"])
def test_a_damaged_index_is_made_anew(made, cache, caplog, damage, place):
    process, read = made
    index = process()
    index.of(b"one")
    index.keep()
    (path,) = cache.glob("definitions/*")
    if place == "shipped":
        path.unlink()
        path = index.shipped
        path.write_bytes(index.content([b"one"]))
    path.write_bytes(damage(path.read_bytes()))
    read.clear()
    index = process()
    assert index.of(b"one") == {"a": None, "b": [3]}
    index.keep()
    assert process().of(b"one") == {"a": None, "b": [3]}
    assert read == [b"one"]
    assert len(caplog.records) == (place == "kept")


def test_without_a_cache_each_process_reads_and_one_line_tells_so(made, cache, caplog):
    process, read = made
    cache.write_text("no folder")
    for _ in range(2):
        index = process()
        for text in TEXTS:
            assert index.of(text) == {"a": None, "b": [len(text)]}
            index.keep()
    assert read == TEXTS * 2
    assert len(caplog.records) == 1
    assert "cannot write" in caplog.text


def test_what_a_function_refuses_is_raised_and_not_kept(cache):
    for index in (DEFINITIONS, SYNTAX):
        for _ in range(2):
            with pytest.raises(SyntaxError):
                index.of(b"def (")


BUILD = """
from eyas.engine.core.identity.build import this_build
from eyas.lanes.identity import language_hash
print(this_build().id, language_hash())
"""


@pytest.mark.slow
def test_two_processes_make_the_indexes_of_a_clone_at_once(tmp_path):
    environment = {**os.environ, "EYAS_CACHE_DIR": str(tmp_path / "cache")}
    command = [sys.executable, "-c", BUILD]
    at_once = [subprocess.Popen(command, env=environment, stdout=-1, text=True) for _ in "ab"]
    told = [process.communicate(timeout=300)[0] for process in at_once]
    told.append(subprocess.run(command, env=environment, stdout=-1, text=True, check=True).stdout)
    assert len(set(told)) == 1
    all_texts = [path.read_bytes() for path in PACKAGE.rglob("*.py")]
    texts = {digest_of(text): text for text in all_texts}
    for index in (DEFINITIONS, SYNTAX):
        (path,) = (tmp_path / "cache/definitions").glob(index._name)
        (name, digests), pieces = unpacked(path.read_bytes())
        assert name == index._name
        kept = dict(zip(digests, map(bytes, pieces), strict=True))
        assert len(kept) > 20
        assert kept.keys() <= texts.keys()
        # Some are read once more: all of them take 11 s.
        (_, digests), pieces = unpacked(index.content([texts[one] for one in sorted(kept)[::9]]))
        assert [kept[one] for one in digests] == [*map(bytes, pieces)]
