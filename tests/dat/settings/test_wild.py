"""Wild settings load, or are refused in one line."""

import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.settings.file import load_settings

from .wild import try_case

CASES = 1000


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_wild_settings_load_or_are_refused_in_one_line(tmp_path, part):
    loaded = sum(try_case(number, tmp_path) for number in range(part, CASES, 4))
    assert 0.05 * CASES / 4 < loaded < 0.95 * CASES / 4


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda path: path.mkdir(), "cannot read"),
        (lambda path: path.write_bytes(b" " * 10_000_000), "not valid JSON"),
        (lambda path: path.write_bytes(b'{"seed": "' + b"a" * 10_000_000 + b'"}'), "seed"),
        (lambda path: path.symlink_to(path), "cannot read"),
    ],
    ids=["folder", "spaces", "long", "loop"],
)
def test_what_is_no_settings_file_is_refused_in_one_line(tmp_path, made, said):
    path = tmp_path / "settings.json"
    made(path)
    with pytest.raises(EyasError, match=said) as caught:
        load_settings(path)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 5000
