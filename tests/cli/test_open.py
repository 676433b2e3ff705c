"""`eyas open`: what there is to look at in a folder."""

import pytest
from typer.testing import CliRunner

from eyas.cli.app import app
from eyas.engine.core.errors import DataFileError


@pytest.fixture
def opened(monkeypatch):
    found = []
    monkeypatch.setattr("webbrowser.open", found.append)
    return found


def test_the_best_of_a_folder_is_opened(tmp_path, opened):
    film = tmp_path / "DRONE0" / "episode0" / "episode.webp"
    film.parent.mkdir(parents=True)
    film.write_bytes(b"")
    (film.parent / "000000.png").write_bytes(b"")
    (film.parent / "episode.json").write_bytes(b"")
    ran = CliRunner().invoke(app, ["open", str(tmp_path)])
    assert ran.output.strip() == str(film)
    page = tmp_path / "overview.html"
    page.write_text("")
    CliRunner().invoke(app, ["open", str(tmp_path)])
    assert opened == [film.as_uri(), page.as_uri()]
    assert CliRunner().invoke(app, ["open", str(film), "--print"]).output.strip() == str(film)
    assert len(opened) == 2


@pytest.mark.parametrize(("name", "line"), [("a", "no such file"), (".", "holds no page")])
def test_nothing_to_look_at_is_one_line(tmp_path, opened, name, line):
    with pytest.raises(DataFileError, match=line):
        CliRunner().invoke(app, ["open", str(tmp_path / name)], catch_exceptions=False)
    assert not opened
