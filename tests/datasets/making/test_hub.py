"""A data set on the Hugging Face hub, of which a stand-in runs on this machine."""

import json
import os
import subprocess
import sys
from types import SimpleNamespace

import pytest
import yaml

import eyas
from eyas.datasets.card import REPOSITORY_SPLITS
from eyas.engine.exports.hub import HubRepository
from tests.kit.hub import running_hub

pytestmark = pytest.mark.slow
pytest.importorskip("huggingface_hub", reason="extra hub")


@pytest.fixture
def hub():
    with running_hub() as running:
        yield running


def eyas_dataset(hub, *words, **changes):
    """Run `eyas dataset` where the stand-in is the hub."""
    environment = os.environ | hub.environment() | changes
    command = [sys.executable, "-m", "eyas", "dataset", *map(str, words)]
    return subprocess.run(command, env=environment, capture_output=True, text=True)


def test_one_option_publishes_a_data_set_whole(made, recipe_file, hub, contents):
    words = ("make", recipe_file, "--out", made, "--resume", "--quiet", "--push-to-hub", "me/tiny")
    done = eyas_dataset(hub, *words)
    assert (done.returncode, done.stderr) == (0, "")
    arrived = hub.repositories["dataset", "me/tiny"]
    files = contents(made)
    tables = {f"parts/{split}/metadata.jsonl" for split in REPOSITORY_SPLITS}
    assert arrived["files"].keys() == files.keys() | tables
    for name in files.keys() - {"README.md"}:
        assert arrived["files"][name] == files[name], name
    assert arrived["commits"][-1][1][-1] == "README.md"  # the page appears when all is there


def test_its_card_leads_the_hub_to_pictures_with_boxes(made, hub):
    done = eyas_dataset(hub, "push", made, "me/tiny", "--private")
    assert done.stdout == f"{hub.address}/datasets/me/tiny\n"
    arrived = hub.repositories["dataset", "me/tiny"]
    assert arrived["private"]
    front = yaml.safe_load(arrived["files"]["README.md"].split(b"---\n")[1])
    for each in front["configs"][0]["data_files"]:
        split = {own: name for name, own in REPOSITORY_SPLITS.items()}[each["split"]]
        assert each["path"][0] == f"parts/{split}/metadata.jsonl"
        lines = arrived["files"][each["path"][0]].splitlines()
        rows = {row["file_name"]: row for row in map(json.loads, lines)}
        assert {f"parts/{split}/{name}" for name in rows} == {
            name
            for name in arrived["files"]
            if name.startswith(f"parts/{split}/") and name.endswith(".jpeg")
        }
        for episode in eyas.load(made).split(split).episodes:
            for frame in episode:
                name = "/".join(episode.picture_file(frame.number).parts[-4:])
                told, label = rows[name]["objects"], frame.label
                assert len(told["bbox"]) == len(told["category"]) == len(told["track_id"])
                if True in told["is_target"]:
                    left, top, wide, high = told["bbox"][told["is_target"].index(True)]
                    own = [left, top, left + wide, top + high]
                    assert own == label["target_visible_box"]
                else:
                    assert label["visible_fraction"] == 0


def test_many_files_are_several_commits_and_the_card_is_in_the_last(monkeypatch):
    monkeypatch.setattr("eyas.engine.exports.hub.COMMIT_FILES", 2)
    commits = []
    api = SimpleNamespace(create_commit=lambda _, files, **__: commits.append(files))
    hub = SimpleNamespace(CommitOperationAdd=lambda path_in_repo, path_or_fileobj: path_in_repo)
    repository = object.__new__(HubRepository)
    repository.name, repository.kind = "me/tiny", "dataset"
    repository._api, repository._hub = api, hub
    repository.push(dict.fromkeys(("README.md", "b", "c", "a"), b""), "all")
    assert commits == [["a", "b"], ["c", "README.md"]]


def test_what_cannot_be_published_is_said_before_anything_is_drawn(tmp_path, recipe_file, hub):
    words = ("make", recipe_file, "--out", tmp_path / "out", "--push-to-hub")
    no_key = eyas_dataset(hub, *words, "me/tiny", HF_TOKEN="hf_unknown")
    assert no_key.stderr.strip() == (
        "eyas: error: me/tiny: the Hugging Face hub does not know who sends: hf auth login, or "
        "HF_TOKEN"
    )
    no_name = eyas_dataset(hub, *words, "a/b/c")
    assert "'a/b/c': not a name on the Hugging Face hub" in no_name.stderr
    nowhere = eyas_dataset(hub, *words, "me/tiny", HF_ENDPOINT="http://127.0.0.1:9")
    assert "me/tiny: the Hugging Face hub was not reached" in nowhere.stderr
    hub.refusal = 403, {"error": "no\n\x1b[31m such right" * 200}
    refused = eyas_dataset(hub, *words, "me/tiny")
    assert "me/tiny: the Hugging Face hub refuses (403)" in refused.stderr
    for done in (no_key, no_name, nowhere, refused):
        assert (done.returncode, len(done.stderr.strip().splitlines())) == (2, 1)
        assert "\x1b" not in done.stderr
    assert not (tmp_path / "out").exists()
    unfinished = eyas_dataset(hub, "push", tmp_path, "me/tiny")
    assert "not a finished data set: it has no dataset.json" in unfinished.stderr
    assert not hub.repositories
