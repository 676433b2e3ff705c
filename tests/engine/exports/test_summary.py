import math

from eyas.engine.exports.writer import Scores, Summary, total


def test_frames_are_counted_with_their_scores(frame):
    summary = Summary(0, Scores())
    for reward in (0.5, 0.25, math.nan):
        summary = summary.plus(frame(0, reward=reward))
    assert summary == Summary(3, Scores(2, 0.75, 3))


def test_a_total_of_unknown_scores_is_unknown():
    known = Summary(2, Scores(2, 1.5, 1))
    assert total([known, known]) == Summary(4, Scores(4, 3.0, 2))
    assert total([known, Summary(3)]) == Summary(5, None)
