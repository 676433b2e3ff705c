"""A release: its texts, its notes, its page on PyPI. The packages are built in `test_wheel.py`."""

import importlib.util
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
TEXTS = ("CHANGELOG.md", "CITATION.cff", "README.md", ".github/ISSUE_TEMPLATE/config.yml")


def loaded(folder, name):
    """Return a tool of a folder, which looks for those beside it."""
    sys.path.insert(0, str(folder / "tools"))
    try:
        for each in ("version", "pypi_page", "release"):
            sys.modules.pop(each, None)
        spec = importlib.util.spec_from_file_location(f"{name}_tool", folder / f"tools/{name}.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
    finally:
        sys.path.pop(0)


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A repository with what a release changes."""
    for name in ("GIT_AUTHOR_NAME", "GIT_COMMITTER_NAME"):
        monkeypatch.setenv(name, "n")
    for name in ("GIT_AUTHOR_EMAIL", "GIT_COMMITTER_EMAIL"):
        monkeypatch.setenv(name, "e@example.org")
    for path in (*TEXTS, *(f"tools/{name}.py" for name in ("release", "version", "pypi_page"))):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    for words in (("init", "-q"), ("add", "."), ("commit", "-qm", "first")):
        subprocess.run(["git", *words], cwd=tmp_path, check=True)
    return tmp_path


def test_a_release_dates_its_texts_and_nothing_is_left_to_do(copy):
    release = loaded(copy, "release")
    assert release.texts_of("1.2.0")
    release.dated("1.2.0", "2027-01-31", "kestrel")
    again = loaded(copy, "release")
    assert again.texts_of("1.2.0") == []
    assert again.notes("1.2.0").startswith("The first release.")
    assert 'date-released: "2027-01-31"' in (copy / "CITATION.cff").read_text()
    assert "OWNER/eyas" not in (copy / "README.md").read_text()
    said = subprocess.run(["git", "log", "-1", "--format=%s"], cwd=copy, capture_output=True)
    assert said.stdout == b"Eyas 1.2.0\n"


def test_a_second_release_dates_what_has_come_since(copy):
    loaded(copy, "release").dated("1.2.0", "2027-01-31", "kestrel")
    log = copy / "CHANGELOG.md"
    log.write_text(log.read_text().replace("## 1.2.0", "## Unreleased\n\n- More.\n\n## 1.2.0", 1))
    release = loaded(copy, "release")
    release.dated("1.3.0", "2027-02-28", None)
    assert release.notes("1.3.0") == "- More."
    assert (copy / "CITATION.cff").read_text().count("date-released") == 1


def test_a_changelog_without_anything_new_is_not_released(copy):
    loaded(copy, "release").dated("1.2.0", "2027-01-31", None)
    with pytest.raises(SystemExit, match=r"CHANGELOG.md: has no line like"):
        loaded(copy, "release").dated("1.3.0", "2027-02-28", None)


def test_actions_run_on_a_runtime_that_runners_have():
    """Majors that run on node 24, which runners have had since 2026: earlier ones no longer start.

    Sources: `action.yml` of each at the pinned commit.
    """
    oldest = {
        "actions/checkout": 5,
        "actions/setup-python": 6,
        "actions/upload-artifact": 6,
        "actions/download-artifact": 7,
    }
    for path in (ROOT / ".github/workflows").glob("*.yml"):
        for action, major in re.findall(r"uses: (actions/\S+)@\w{40}  # v(\d+)", path.read_text()):
            assert int(major) >= oldest.get(action, 0), (path.name, action)


@pytest.mark.checker
def test_the_page_on_pypi_is_read_as_it_is_rendered():
    pytest.importorskip("readme_renderer")
    tool = loaded(ROOT, "pypi_page")
    ours = tool.REPOSITORY

    def found(text):
        return list(tool.faults(text, tool.rendered(text)))

    good = (
        f"![film]({ours}/raw/main/docs/images/follow.webp) [on]({ours}/blob/main/README.md#start)"
    )
    assert found(good) == []
    assert found("[more](docs/index.md)") == ["docs/index.md: not an address"]
    assert found(f"[more]({ours}/blob/main/docs/lost.md)") == ["docs/lost.md: no such file"]
    assert found(f"[more]({ours}/blob/main/README.md#end)") == ["README.md: no heading #end"]
    assert found("[more](javascript:on)") == ["1 links are written, 0 shown"]


def test_the_recipe_of_conda_asks_for_what_the_package_does():
    recipe = yaml.safe_load((ROOT / "conda/recipe.yaml").read_text())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = {text.replace(">=", " >=") for text in project["dependencies"]}
    wanted |= {f"python {project['requires-python']}", "__linux"}
    assert set(recipe["requirements"]["run"]) == wanted
