"""Which coding a line gets, and pictures which size: line, machine and time are made up."""

import pytest

from eyas.demo.frame import FACTORS, IN_FLIGHT, CodingChoice
from eyas.demo.session import FRAME, AdaptiveSize

SIZES = (45e3, 15e3, 6e3, 3e3)
"""Of a picture at each level [bytes]."""
WHOLE = 40e3


def send(line, seconds, speed, delay=0.001, frame=FRAME, begun=0.0):
    """Send frames over a line of a speed [bytes/s] and a delay of each answer [s].

    Returns the frames that have arrived in a second, on the average, and the time.
    """
    now, free, due, arrived, level = begun, begun, begun, 0, line.level
    under_way = []
    while now < begun + seconds:
        if under_way and under_way[0][1] <= now:
            sent, now = under_way.pop(0)
            line.arrive(now - sent, now)
            arrived += 1
        elif now >= due and len(under_way) < IN_FLIGHT:
            size = WHOLE if line.level != level and line.level else SIZES[line.level]
            level, free, due = line.level, max(free, now) + size / speed, max(due, now) + frame
            under_way.append((now, free + delay))
        else:
            now = min([due] * (len(under_way) < IN_FLIGHT) + [then for _, then in under_way[:1]])
    return arrived / seconds, now


def automatic():
    line = CodingChoice(0.0)
    line.choose("auto", 0.0)
    return line


@pytest.mark.parametrize(
    ("speed", "level"), [(100e6, 0), (2e6, 0), (600e3, 1), (200e3, 2), (90e3, 3), (40e3, 3)]
)
def test_a_line_gets_the_largest_pictures_that_it_carries(speed, level):
    line = automatic()
    _, now = send(line, 30.0, speed)
    assert line.level == level
    if level < len(FACTORS):
        assert send(line, 30.0, speed, begun=now)[0] >= 25.0


def test_a_long_way_is_no_reason_for_small_pictures():
    line = automatic()
    send(line, 20.0, 100e6, delay=0.2)
    assert line.level == 0


def test_a_slow_machine_is_no_reason_for_small_pictures():
    line = automatic()
    send(line, 20.0, 100e6, frame=0.1)
    assert line.level == 0


def test_a_line_that_gets_better_gets_larger_pictures_again():
    line = automatic()
    _, now = send(line, 20.0, 200e3)
    assert line.level == 2
    _, now = send(line, 60.0, 100e6, begun=now)
    assert line.level == 0


def test_larger_pictures_are_tried_less_and_less_often():
    line = automatic()
    tries, now = [], 0.0
    for _ in range(600):
        before = line.level
        _, now = send(line, 1.0, 700e3, begun=now)
        tries += [now] if line.level < before else []
    assert 2 <= len(tries) <= 7
    assert tries[-1] - tries[-2] > 2 * (tries[1] - tries[0])


def test_what_the_page_chooses_stays():
    line = automatic()
    line.choose("jpeg", 0.0)
    _, now = send(line, 20.0, 60e3)
    assert line.level == 0
    line.choose("h264", now)
    send(line, 60.0, 100e6, begun=now)
    assert line.level == 1


def test_pictures_shrink_at_once_and_grow_after_a_while():
    size = AdaptiveSize()
    size.fit(1280, 720)
    first = size.now
    for _ in range(20):
        size.spent(0.05)
    small = size.now
    assert small[0] < first[0]
    for _ in range(20):
        size.spent(0.002)
    assert size.now == small
    for _ in range(4000):
        size.spent(0.002)
    assert size.now == (1280, 720)


def test_pictures_keep_their_size_when_the_time_is_neither_short_nor_long():
    size = AdaptiveSize()
    size.fit(1280, 720)
    sizes = set()
    for i in range(2000):
        size.spent(0.016 + 0.006 * (i % 7 - 3) / 3)
        sizes.add(size.now)
    assert len(sizes) == 1
