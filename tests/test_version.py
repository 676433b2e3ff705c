"""The version is that of the tags of git, of an sdist, or of the next release."""

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def loaded(folder):
    """Return the module `tools/version.py` of a folder."""
    spec = importlib.util.spec_from_file_location("version_of", folder / "tools/version.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def git(folder, *words):
    own = ("-c", "user.name=n", "-c", "user.email=e@example.org", "-c", "commit.gpgsign=false")
    subprocess.run(["git", *own, *words], cwd=folder, check=True, capture_output=True)


@pytest.fixture
def copy(tmp_path):
    (tmp_path / "tools").mkdir()
    shutil.copy(ROOT / "tools/version.py", tmp_path / "tools")
    return tmp_path


def test_a_copy_without_git_is_the_next_version_in_development(copy):
    module = loaded(copy)
    assert module.version() == f"{module.NEXT}.dev0"


def test_tags_tell_the_version(copy):
    git(copy, "init", "-q")
    git(copy, "add", ".")
    git(copy, "commit", "-qm", "first")
    module = loaded(copy)
    assert module.version() == f"{module.NEXT}.dev0"
    git(copy, "tag", "v1.2.3")
    assert module.version() == "1.2.3"
    git(copy, "commit", "-q", "--allow-empty", "-m", "second")
    assert module.version() == "1.2.4.dev1"
    git(copy, "tag", "v2.0.0rc1")
    assert module.version() == "2.0.0rc1"
    git(copy, "commit", "-q", "--allow-empty", "-m", "third")
    assert module.version() == "2.0.0rc1.dev1"


def test_an_sdist_says_which_version_it_is(copy):
    (copy / "PKG-INFO").write_text("Metadata-Version: 2.4\nName: eyas\nVersion: 3.1.4\n")
    assert loaded(copy).version() == "3.1.4"


def test_the_texts_that_name_a_version_are_ready_for_it():
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        release = importlib.import_module("release")
    finally:
        sys.path.pop(0)
    missing = release.texts_of(loaded(ROOT).NEXT)
    # What `tools/release.py --tag` fills in: the day and the account.
    assert {line.partition(":")[0] for line in missing} <= {"CHANGELOG.md", "tools/version.py"}
    assert len(release.texts_of("9.9.9")) == 2 + ("OWNER" in release.REPOSITORY)
