import threading

import pytest

from eyas.core.errors import OutputError
from eyas.modes.video.lanes import WriterLanes


def test_calls_of_a_key_keep_their_order():
    lanes = WriterLanes(3)
    done: list[list[int]] = [[], [], []]
    for number in range(300):
        lanes.submit(number % 3, done[number % 3].append, number)
    lanes.finish()
    assert done == [list(range(key, 300, 3)) for key in range(3)]


def test_nothing_runs_after_a_call_that_failed():
    lanes = WriterLanes(1)
    may_fail, done = threading.Event(), []

    def fail() -> None:
        may_fail.wait(10)
        raise OutputError("full")

    lanes.submit(0, fail)
    lanes.submit(0, done.append, 1)
    may_fail.set()
    with pytest.raises(OutputError, match="full"):
        lanes.finish()
    lanes.stop()
    assert done == []
