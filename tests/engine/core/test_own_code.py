"""Code of users: found last in the current folder, asked what it has, its end told in words."""

import sys

import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.named_code import origin_of
from eyas.engine.core.own_code import imported, left_out, running, takes


@pytest.fixture
def here(tmp_path, monkeypatch):
    """The current folder, in which Python does not look yet."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [each for each in sys.path if each])
    yield tmp_path
    for name in ("own_thing_of_a_test", "own_package_of_a_test"):
        sys.modules.pop(name, None)


@pytest.mark.skipif(sys.flags.safe_path, reason="Python is told not to look here")
def test_the_current_folder_is_looked_into_last(here):
    (here / "own_thing_of_a_test.py").write_text("THING = 3\n")
    (here / "json.py").write_text("raise RuntimeError\n")
    assert imported("own_thing_of_a_test:THING", "custom.path") == 3
    assert sys.path[-1] == str(here)  # so that no file of it takes the place of a package
    assert imported("json:loads", "custom.path")("1") == 1


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("no path", "custom.path: 'no path' is not a path; allowed: package.module:attribute"),
        ("absent_of_a_test:X", "there is no module 'absent_of_a_test'"),
        ("json:laods", "the module 'json' has no 'laods'; did you mean 'loads'?"),
    ],
)
def test_what_is_not_there_is_told(path, line):
    with pytest.raises(ConfigError) as caught:
        imported(path, "custom.path")
    assert line in str(caught.value)


def test_code_that_ends_the_program_is_told_where_and_errors_pass():
    with (
        pytest.raises(ConfigError, match=r"'X': its code tried to end .*SystemExit\(3\) in .*line"),
        running("custom.path", "X"),
    ):
        sys.exit(3)
    with pytest.raises(ZeroDivisionError), running("custom.path", "X"):
        _ = 1 / 0


def test_members_and_arguments_are_looked_at_without_a_call():
    assert left_out(str, ["upper", "act"]) == ["act"]
    assert takes(lambda a, b: None, 1, 2) is None
    assert takes(lambda a: None, 1, 2).startswith("it cannot be called so")
    assert takes(print, 1) == "it is a built-in function"


@pytest.mark.skipif(sys.flags.safe_path, reason="Python is told not to look here")
def test_the_identity_of_code_changes_with_each_file_of_its_package(here):
    package = here / "own_package_of_a_test"
    package.mkdir()
    (package / "__init__.py").write_text("A = 1\n")
    (package / "inner.py").write_text("B = 1\n")
    imported("own_package_of_a_test:A", "custom.path")
    first = origin_of("own_package_of_a_test:A")
    assert (first.package, first.version, len(first.code)) == (None, None, 12)
    (package / "inner.py").write_text("B = 2\n")
    assert origin_of("own_package_of_a_test:A").code != first.code
