import json
import math

import pytest

from eyas.core.errors import DataFileError
from eyas.exports.labels import read_labels, rounded, rounded_list, write_labels


def test_labels_read_back_equal(tmp_path, frame_label):
    labels = [frame_label(0), frame_label(1, reward=None, done=True)]
    write_labels(tmp_path / "labels.jsonl", labels)
    assert read_labels(tmp_path / "labels.jsonl") == labels


def test_each_line_is_a_record_that_any_reader_understands(tmp_path, frame_label):
    write_labels(tmp_path / "labels.jsonl", [frame_label(frame) for frame in range(3)])
    records = [json.loads(line) for line in (tmp_path / "labels.jsonl").read_text().splitlines()]
    assert [record["frame"] for record in records] == [0, 1, 2]
    assert records[2]["target_box"] == [10, 11, 20, 17]


def test_numbers_have_fixed_decimals_and_no_negative_zero():
    assert rounded(1.23456749) == 1.234567
    assert json.dumps(rounded(-1e-9)) == "0.0"
    assert rounded_list([math.nan, math.inf, 2]) == [None, None, 2.0]


@pytest.mark.parametrize(
    ("damage", "line"),
    [
        (lambda text: text[:-30], "line 2 is cut off or not JSON"),
        (lambda text: text.replace('"reward"', '"rewind"'), "line 1 is not the label of a frame"),
    ],
)
def test_damaged_labels_say_where(tmp_path, frame_label, damage, line):
    path = tmp_path / "labels.jsonl"
    write_labels(path, [frame_label(0), frame_label(1)])
    path.write_text(damage(path.read_text()))
    with pytest.raises(DataFileError, match=line):
        read_labels(path)
