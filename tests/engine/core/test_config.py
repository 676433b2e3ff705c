from enum import StrEnum
from typing import Annotated, Literal

import pytest
from pydantic import AfterValidator, Field, model_validator

from eyas.engine.core.config import Config, shown, updated, validated
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.variation import Uniform, Variation, within


class Colour(StrEnum):
    RED = "red"
    GREEN = "green"


class Inner(Config):
    count: Annotated[int, Field(ge=1, le=5)] = 2
    speed: Annotated[float, Field(gt=0)] = 1.5
    flag: bool = False
    name: Annotated[str, Field(min_length=1)] = "x"
    colour: Colour = Colour.RED
    ends: tuple[float, float] = (0.0, 1.0)
    samples: Literal[1, 4] = 1
    height: Annotated[Variation, AfterValidator(within(0.0, 10.0))] = 3.0
    seed: Annotated[int, Field(ge=0)] | None = None

    @model_validator(mode="after")
    def _in_order(self) -> "Inner":
        if self.ends[0] > self.ends[1]:
            raise ValueError("ends must rise")
        return self


class Outer(Config):
    inner: Inner = Inner()
    seed: int = 0


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"count": 9}, "inner.count: 9 is not allowed: a whole number from 1 to 5"),
        ({"count": 2.0}, "inner.count: 2.0 is not allowed: a whole number from 1 to 5"),
        ({"count": True}, "inner.count: true is not allowed: a whole number from 1 to 5"),
        ({"speed": "1.5"}, "inner.speed: '1.5' is not allowed: a number above 0"),
        ({"speed": float("nan")}, "inner.speed: NaN is not allowed: a number above 0"),
        ({"flag": 1}, "inner.flag: 1 is not allowed: true or false"),
        ({"name": ""}, "inner.name: '' is not allowed: text, not empty"),
        ({"colour": 3}, "inner.colour: 3 is not allowed: 'red' or 'green'"),
        (
            {"colour": "rad"},
            "inner.colour: 'rad' is not allowed; did you mean 'red'?; known: green, red",
        ),
        ({"ends": [2, 1]}, "inner.ends: [2, 1] is not allowed: must rise"),
        ({"ends": [2]}, "inner.ends: [2] is not allowed: a list of 2, each a number"),
        ({"samples": 2}, "inner.samples: 2 is not allowed: 1 or 4"),
        ({"height": 11}, "inner.height: 11 is not allowed: it must stay within 0 and 10"),
        (
            {"height": "x"},
            "inner.height: 'x' is not allowed: a number, "
            '{"uniform": [low, high]}, {"mirrored": [low, high]} or {"choice": [a, b, ...]}',
        ),
        ({"seed": -1}, "inner.seed: -1 is not allowed: null or a whole number of at least 0"),
        ({"a\nb": 1}, "inner.a\\nb: unknown key; known: "),
    ],
)
def test_a_wrong_value_is_told_with_path_value_and_what_is_allowed(values, line):
    with pytest.raises(ConfigError) as caught:
        validated(Outer, {"inner": values})
    assert str(caught.value).startswith(line)


def test_an_unknown_key_is_told_before_a_wrong_value_and_with_the_nearest():
    with pytest.raises(
        ConfigError, match=r"^inner\.cuont: unknown key; did you mean 'count'\?; known: "
    ):
        validated(Outer, {"seed": "x", "inner": {"count": 99, "cuont": 1}})


def test_unknown_names_have_their_own_kind_of_error():
    with pytest.raises(UnknownNameError):
        validated(Outer, {"inner": {"colour": "blue"}})


def test_a_group_must_be_an_object():
    with pytest.raises(ConfigError, match=r"^inner: 5 is not allowed: an object with count, speed"):
        validated(Outer, {"inner": 5})


def test_the_root_stands_before_the_path():
    with pytest.raises(ConfigError, match=r"^file\.npz: config\.seed: 'a' is not allowed"):
        validated(Outer, {"seed": "a"}, "file.npz: config")


def test_whole_numbers_lists_and_names_are_taken_where_they_lose_nothing():
    inner = validated(Outer, {"inner": {"speed": 2, "ends": [1, 2], "colour": "green"}}).inner
    assert (inner.speed, inner.ends, inner.colour) == (2.0, (1.0, 2.0), Colour.GREEN)
    assert isinstance(inner.speed, float)
    assert isinstance(inner.ends[0], float)


def test_settings_made_in_python_are_refused_with_one_line_too():
    with pytest.raises(ConfigError, match=r"^count: 9 is not allowed: a whole number from 1 to 5$"):
        Inner(count=9)
    with pytest.raises(ConfigError, match=r"^inner\.count: '2' is not allowed"):
        Outer(inner={"count": "2"})


def test_updated_changes_what_is_named_and_keeps_the_rest():
    before = Outer(inner=Inner(count=4, height=Uniform(uniform=(1.0, 2.0))), seed=7)
    after = updated(before, {"inner": {"height": {"uniform": [3, 4]}}})
    assert after == Outer(inner=Inner(count=4, height=Uniform(uniform=(3.0, 4.0))), seed=7)
    with pytest.raises(ConfigError, match=r"^inner\.count: 0 "):
        updated(before, {"inner": {"count": 0}})


def test_values_are_shown_on_one_line_and_cut():
    assert shown("a\nb") == r"'a\nb'"
    assert shown(Uniform(uniform=(1.0, 2.0))) == '{"uniform": [1.0, 2.0]}'
    assert len(shown(list(range(1000)))) == 80


class Holder(Config):
    inner: Inner | None = None


def test_a_group_that_may_be_null_is_checked_and_changed_as_any_other():
    with pytest.raises(ConfigError, match=r"^inner\.cuont: unknown key; did you mean 'count'"):
        updated(Holder(), {"inner": {"cuont": 3}})
    with pytest.raises(ConfigError, match=r"^inner\.count: 0 is not allowed"):
        updated(Holder(), {"inner": {"count": 0}})
    first = updated(Holder(), {"inner": {"count": 3}})
    second = updated(first, {"inner": {"height": 4.0}})
    assert second.inner == Inner(count=3, height=4.0)
    assert updated(second, {"inner": None}) == Holder()
