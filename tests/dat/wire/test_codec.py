import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from eyas.dat.wire.exchange import Action, packet_line, parse_action
from eyas.engine.core.errors import ActionError


@pytest.mark.parametrize(
    ("line", "action"),
    [
        (b"40.0,0.0,0.0,-2.0,0", Action((40.0, 0.0, 0.0, -2.0), reset=False)),
        (b"0,0,0,0,1", Action((0.0, 0.0, 0.0, 0.0), reset=True)),
        (b" 1e1, -.5,0.01,0 ,1.0", Action((10.0, -0.5, 0.01, 0.0), reset=True)),
    ],
)
def test_an_action_is_read_as_python_reads_numbers(line, action):
    assert parse_action(line) == action


@pytest.mark.parametrize(
    "line",
    [
        *(b"", b"1,2,3,4", b"1,2,3,4,5,0", b"1,2,3,4,", b"1,2,,4,0", b"1;2;3;4;0", b"a,b,c,d,0"),
        *(
            b"nan,0,0,0,0",
            b"-inf,0,0,0,0",
            b"-1e5,0,0,0,0",
            b"0,0,0,1e5,0",
            b"0,0,0,0,2",
            b"0,0,0,0,0.5",
        ),
        *(b"\xff\xfe\x00,1", b"\xd9\xa1,0,0,0,0", b"0,0,0,0,nan"),
    ],
)
def test_anything_else_is_one_line(line):
    with pytest.raises(ActionError, match=r"^action line b.* is not allowed: four numbers"):
        parse_action(line)


@given(st.binary(max_size=60))
def test_garbage_never_becomes_a_wild_command(line):
    try:
        action = parse_action(line)
    except ActionError:
        return
    assert len(action.command) == 4
    assert all(abs(number) <= 1e4 for number in action.command)


@given(arrays(np.float64, st.integers(1, 70), elements=st.floats(allow_nan=True)))
def test_each_number_reads_back_to_the_same_double(numbers):
    line = packet_line(numbers).decode()
    assert line.endswith("\n")
    read = np.array([float(word) for word in line.rstrip("\n").split(",")])
    np.testing.assert_array_equal(read, numbers)


def test_whole_numbers_have_no_point_and_words_follow():
    numbers = np.array([4.0, 0.5, -10.0, 1e-7, math.pi])
    assert packet_line(numbers, "BmwX5Simple") == b"4,0.5,-10,1e-07,3.141592653589793,BmwX5Simple\n"
