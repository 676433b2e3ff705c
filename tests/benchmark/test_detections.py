"""Detectors with the output of YOLO as box trackers."""

import numpy as np
import pytest

from eyas.benchmark.policies.box_trackers import box_tracker
from eyas.benchmark.policies.detections import DetectionTracker, _Form
from eyas.engine.core.errors import EyasError


class Session:
    """Answers with the boxes that it has been given, in one of YOLO's forms."""

    def __init__(self, rows):
        self.rows, self.fed = rows, None

    def get_inputs(self):
        return [type("Value", (), {"name": "images"})]

    get_outputs = get_inputs

    def run(self, outputs, feed):
        self.fed = feed["images"]
        return [np.array(self.rows, np.float32)[None]]


def form(*kind):
    return _Form(64, 64, np.float32, *kind)


PICTURE = np.full((32, 64, 3), 255, np.uint8)  # a border of 16 pixels above and below
WANTED = (20.0, 10.0, 8.0, 6.0)  # in the picture: in the input 16 pixels lower


@pytest.mark.parametrize(
    ("kind", "rows"),
    [
        ((True, False, True), [[20, 26, 28, 32, 0.9, 2], [50, 26, 58, 32, 0.95, 2]]),
        ((False, False, True), [[24, 29, 8, 6, 0.9, 0.1, 0.9], [54, 29, 8, 6, 1, 1, 1]]),
        ((False, True, False), [[24, 54], [29, 29], [8, 8], [6, 6], [0.1, 0.1], [0.8, 0.9]]),
        ((False, True, False), [[0.375], [0.453125], [0.125], [0.09375], [0.8]]),
    ],
)
def test_each_form_gives_the_box_in_the_picture(kind, rows):
    session = Session(rows)
    tracker = DetectionTracker(session, form(*kind))
    tracker.begin(PICTURE, (19.0, 10.0, 8.0, 6.0))
    assert tracker.update(PICTURE) == pytest.approx(WANTED, abs=1e-4)
    assert session.fed.shape == (1, 3, 64, 64)
    assert session.fed[0, 0, 15, 0] == pytest.approx(114 / 255)
    assert session.fed[0, 0, 16, 0] == 1.0


def test_what_is_far_away_small_or_uncertain_is_not_it():
    session = Session(
        [[20, 26, 28, 32, 0.05, 2], [50, 26, 58, 32, 0.9, 2], [20, 26, 22, 28, 0.9, 2]]
    )
    tracker = DetectionTracker(session, form(True, False, True))
    tracker.begin(PICTURE, (19.0, 10.0, 8.0, 6.0))
    assert tracker.update(PICTURE) is None


def test_it_goes_on_at_its_velocity_where_it_is_hidden():
    session = Session([])
    tracker = DetectionTracker(session, form(True, False, True))
    tracker.begin(PICTURE, (0.0, 10.0, 8.0, 6.0))
    for step in range(8):
        session.rows = [[5.0 * step, 26, 5.0 * step + 8, 32, 0.9, 2]]
        tracker.update(PICTURE)
    session.rows = np.zeros((0, 6))
    assert tracker.update(PICTURE) is None
    assert tracker.update(PICTURE) is None
    session.rows = [[50, 26, 58, 32, 0.9, 2], [20, 26, 28, 32, 0.99, 2]]
    assert tracker.update(PICTURE)[0] == pytest.approx(50.0)


def test_a_file_that_is_no_detector_is_one_line(tmp_path):
    pytest.importorskip("onnxruntime")
    (tmp_path / "a.onnx").write_bytes(b"no network")
    with pytest.raises(EyasError, match="not a network in ONNX"):
        box_tracker(str(tmp_path / "a.onnx"))
