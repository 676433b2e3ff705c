import threading

import pytest

from eyas.engine.core.errors import OutputError
from eyas.engine.video.recorder import WriterThreads


def test_calls_of_a_key_keep_their_order():
    threads = WriterThreads(3)
    done: list[list[int]] = [[], [], []]
    for number in range(300):
        threads.submit(number % 3, done[number % 3].append, number)
    threads.finish()
    assert done == [list(range(key, 300, 3)) for key in range(3)]


def test_nothing_runs_after_a_call_that_failed():
    threads = WriterThreads(1)
    may_fail, done = threading.Event(), []

    def fail() -> None:
        may_fail.wait(10)
        raise OutputError("full")

    threads.submit(0, fail)
    threads.submit(0, done.append, 1)
    may_fail.set()
    with pytest.raises(OutputError, match="full"):
        threads.finish()
    threads.stop()
    assert done == []
