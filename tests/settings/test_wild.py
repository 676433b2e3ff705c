"""Wild settings load, or are refused in one line."""

import logging

import pytest

from .wild import try_case

CASES = 2000


@pytest.mark.parametrize("part", range(4))
def test_wild_settings_load_or_are_refused_in_one_line(tmp_path, part):
    logging.getLogger("eyas").setLevel(logging.ERROR)
    loaded = sum(try_case(number, tmp_path) for number in range(part, CASES, 4))
    assert 0.05 * CASES / 4 < loaded < 0.95 * CASES / 4
