import re

import pytest

from eyas.engine.exports.writer import Files, joined, pattern_of


def test_a_pattern_takes_the_names_that_the_notation_gives_and_no_others():
    for number in (0, 12, 123_456_789):
        assert re.fullmatch(pattern_of("img1/{:06d}.jpg"), f"img1/{number:06d}.jpg")
        assert re.fullmatch(pattern_of("chunk-{:d}"), f"chunk-{number:d}")
    for name in ("img1/00001.jpg", "img1/00000a.jpg", "img1/000000xjpg", "000000.jpg"):
        assert not re.fullmatch(pattern_of("img1/{:06d}.jpg"), name)


@pytest.mark.parametrize("name", ["{name}.csv", "{}.csv", "{:s}.csv"])
def test_only_numbers_stand_in_a_name(name):
    with pytest.raises(ValueError, match="is not a file's name"):
        Files(episode=(name,))


def test_joined_names_stay_what_they_are():
    first, second = Files(frame=("a",), episode=("b",)), Files(episode=("c",), run=("d",))
    assert joined([first, second]) == Files(frame=("a",), episode=("b", "c"), run=("d",))
