"""How calls are timed and counted, and what the table shows."""

import re
from types import SimpleNamespace

import pytest

from eyas.cli.bench import measurement
from eyas.cli.bench.measurement import (
    HardwareCounts,
    Measurement,
    measurement_table,
    of_pictures,
    timed,
)


class Clock:
    """Clocks that go on only when a call spends time: it works on two processors [s]."""

    def __init__(self, monkeypatch):
        self.now = 0.0
        clocks = SimpleNamespace(perf_counter=lambda: self.now, process_time=lambda: 2.0 * self.now)
        monkeypatch.setattr(measurement, "time", clocks)

    def call(self):
        self.now += 0.01


def test_a_rate_is_of_wall_time_and_the_cost_is_of_all_processors(monkeypatch):
    timing = timed(Clock(monkeypatch).call, 1.0)
    assert timing.rate == pytest.approx(100.0)
    assert timing.cpu == pytest.approx(0.02)
    assert timing.repeats >= 3


def test_pictures_are_counted_one_by_one_and_pixel_by_pixel(monkeypatch):
    monkeypatch.setattr(measurement, "why_not", lambda: None)
    monkeypatch.setattr(measurement, "counted", lambda call: HardwareCounts(640, 320))
    line = of_pictures("name", "all", Clock(monkeypatch).call, (4, 8, 2), 1.0)
    assert line.value == pytest.approx(400.0)
    assert line.cpu_microseconds == pytest.approx(5000.0)
    assert (line.instructions, line.cycles) == (10.0, 5.0)


def test_without_access_to_counters_their_columns_are_left_out(monkeypatch):
    monkeypatch.setattr(measurement, "why_not", lambda: "forbidden")
    line = of_pictures("name", "all", Clock(monkeypatch).call, (4, 8, 2), 1.0)
    assert (line.instructions, line.cycles) == (None, None)
    counted = Measurement("other", 1.0, "/s", "all", 3, 5.0, 10.0, 5.0)
    titles = [
        [str(column.header) for column in measurement_table(lines, "machine").columns]
        for lines in ([line], [line, counted])
    ]
    assert len(titles[1]) == len(titles[0]) + 2
    assert not any("pixel" in title for title in titles[0])


def test_counters_count_what_a_call_does_or_say_why_they_cannot():
    reason = measurement.why_not()
    if reason is not None:
        assert reason
        with pytest.raises(Exception, match=re.escape(reason)):
            measurement.counted(lambda: None)
        return
    few = measurement.counted(lambda: sum(range(1_000)))
    many = measurement.counted(lambda: sum(range(1_000_000)))
    assert many.instructions > 10 * few.instructions > 0
    assert many.cycles > 0


def test_another_system_has_no_counters(monkeypatch):
    monkeypatch.setattr(measurement.platform, "system", lambda: "Other")
    assert "Other" in measurement.why_not()
