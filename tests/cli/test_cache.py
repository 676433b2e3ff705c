"""`eyas cache`: what it shows, and what it removes."""

import pytest

from eyas.cli import cache as mode
from eyas.cli.cache import run_clear, run_info
from eyas.engine.core.errors import OutputError, UnknownNameError

KEY = "0123456789abcdef" * 2


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path))
    monkeypatch.delenv("EYAS_CACHE_LIMIT", raising=False)
    for name, size in (
        (f"geometry/eyas-{KEY}.npy", 3 << 20),
        (f"geometry/eyas-{KEY[::-1]}.npy", 1 << 20),
        (f"traffic/citystreet-0-{KEY}.npz", 1 << 19),
        ("mine.txt", 1 << 20),
    ):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(bytes(size))
    return tmp_path


def rows(text):
    """Return what is in the table, by the first word of each row."""
    lines = [line.strip("│ ").split("│") for line in text.splitlines() if line.startswith("│")]
    return {cells[0].split()[0]: [cell.strip() for cell in cells[1:3]] for cells in lines}


def test_info_tells_the_place_the_limit_and_the_kinds(folder, capsys):
    run_info()
    said = capsys.readouterr().out
    assert said.splitlines()[:2] == [
        f"{folder} (EYAS_CACHE_DIR moves it)",
        "4.5 MiB of at most 2,048.0 MiB (EYAS_CACHE_LIMIT changes it)",
    ]
    assert rows(said) == {"geometry": ["2", "4.0 MiB"], "traffic": ["1", "0.5 MiB"]}


def test_clear_removes_one_kind_or_all_and_says_how_much(folder, capsys):
    run_clear("geometry")
    assert capsys.readouterr().out == "freed 4.0 MiB\n"
    run_info()
    assert rows(capsys.readouterr().out).keys() == {"traffic"}
    run_clear(None)
    assert capsys.readouterr().out == "freed 0.5 MiB\n"
    assert [path.name for path in folder.iterdir()] == ["mine.txt"]
    run_info()
    assert rows(capsys.readouterr().out) == {}


def test_an_unknown_kind_is_refused(folder):
    with pytest.raises(UnknownNameError, match=r"^--kind: 'geometri' .* did you mean 'geometry'"):
        run_clear("geometri")
    assert (folder / "geometry").is_dir()


def test_what_cannot_be_removed_is_told(monkeypatch, capsys):
    monkeypatch.setattr(mode, "clear", lambda folder, kind: 0)
    with pytest.raises(OutputError, match=r"traffic.*: cannot remove it \(one of 1 entries\)"):
        run_clear("traffic")
    assert capsys.readouterr().out == "freed 0.0 MiB\n"
