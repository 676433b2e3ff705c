"""The command that installs an extra, for each way in which Eyas can have been installed."""

import json
from importlib import metadata

import pytest

from eyas.engine.core import installed
from eyas.engine.core.errors import MissingExtraError
from eyas.engine.core.installed import install_command


@pytest.fixture
def noted(tmp_path, monkeypatch):
    """Let Eyas be installed as an installer has noted; None: by its name."""

    def note(said):
        folder = tmp_path / "eyas-9.dist-info"
        folder.mkdir(exist_ok=True)
        (folder / "METADATA").write_text("Name: eyas\nVersion: 9\n")
        if said is not None:
            (folder / "direct_url.json").write_text(json.dumps(said))
        monkeypatch.setattr(
            installed, "distribution", lambda name: metadata.PathDistribution(folder)
        )

    return note


def test_by_its_name_from_an_index(noted):
    noted(None)
    assert install_command("train") == "pip install 'eyas[train]'"


@pytest.mark.parametrize("editable", [True, False])
def test_by_the_folder_of_a_clone(noted, tmp_path, editable):
    clone = tmp_path / "my clone"
    clone.mkdir()
    noted({"url": clone.as_uri(), "dir_info": {"editable": editable}})
    flag = "-e " if editable else ""
    assert install_command("train") == f"pip install {flag}'{clone}[train]'"
    assert str(MissingExtraError("learning", "train")).endswith(
        f"pip install {flag}'{clone}[train]'"
    )


def test_by_the_place_of_a_wheel_or_a_repository(noted):
    wheel = "file:///tmp/eyas-9-py3-none-any.whl"
    noted({"url": wheel, "archive_info": {}})
    assert install_command("sumo") == f"pip install 'eyas[sumo] @ {wheel}'"
    noted({"url": "https://a.b/eyas.git", "vcs_info": {"vcs": "git", "commit_id": "0abc"}})
    assert install_command("sumo") == "pip install 'eyas[sumo] @ git+https://a.b/eyas.git@0abc'"


@pytest.mark.parametrize("said", [[], {}, "text"])
def test_a_note_that_says_nothing_is_no_error(noted, said):
    noted(said)
    assert install_command("train") == "pip install 'eyas[train]'"


def test_sources_that_are_used_where_they_lie(monkeypatch):
    def missing(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(installed, "distribution", missing)
    assert install_command("train") == f"pip install -e '{installed._CLONE}[train]'"
