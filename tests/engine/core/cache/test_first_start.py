"""What a first start tells: what is made, how much is done, and how much is left."""

import logging

import pytest

from eyas.engine.core.cache import first_start
from eyas.engine.core.cache.first_start import reported
from eyas.engine.core.cache.folder import EntryKind


@pytest.fixture
def lines(monkeypatch, caplog):
    """Return a function that makes things, some seconds each; it returns what was told."""
    clock = [0.0]
    monkeypatch.setattr(first_start, "_made", {})
    monkeypatch.setattr(first_start.time, "perf_counter", lambda: clock[0])
    caplog.set_level(logging.INFO, "eyas")

    def make(**kinds):
        caplog.clear()
        for kind, seconds in kinds.items():
            with reported(EntryKind[kind]):
                clock[0] += seconds
        assert all(record.passing for record in caplog.records)
        return [message for message in caplog.messages if message]

    return make


def test_it_is_told_in_words_what_is_made_and_how_much_is_left(lines):
    houses, people = lines(SCENE=1.3, SOLIDS=1.0, MOTION=2.0)
    assert houses == "making streets, houses and plants, once; 2 % done, about 5 s left"
    assert people == "making traffic and people, once; 29 % done, about 4 s left"


def test_on_a_slow_machine_more_time_is_left(lines):
    _, people = lines(SCENE=13.0, MOTION=20.0)
    assert people.endswith("29 % done, about 35 s left")


def test_a_short_rest_is_not_told(lines):
    assert lines(AMBIENT=0.2) == []
