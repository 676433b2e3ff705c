"""The tool that counts how often detectors call a car a vehicle."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest

TOOL = runpy.run_path(str(Path(__file__).parents[3] / "tools" / "judge_cars.py"))
BOX = (100, 100, 200, 180)


@pytest.fixture
def said(tmp_path):
    """Return what the tool hears of one car from a detector that prints these boxes."""

    def hear(*boxes):
        answer = tmp_path / "answer"
        answer.write_text(json.dumps({"name": "000", "boxes": boxes}) + "\n")
        view = TOOL["View"](np.zeros((480, 640, 3), np.uint8), BOX, "lake behind")
        return [view], TOOL["names_of"](f"sh -c 'test -s $1/000.ppm && cat {answer}' sh", [view])

    return hear


def test_only_sure_boxes_over_the_target_count(said):
    _, named = said(
        ["truck", 0.3, *BOX],
        ["car", 0.5, 105, 100, 200, 170],
        ["bus", 0.1, *BOX],
        ["car", 0.9, 150, 140, 300, 300],
    )
    assert named == [[("car", 0.5), ("truck", 0.3)]]


def test_the_report_tells_any_word_from_the_surest(said):
    views, named = said(["cell phone", 0.6, *BOX], ["car", 0.2, *BOX])
    side = views[0]._replace(name="lake side")
    line = TOOL["report"](13, [*views, side], named * 2)
    assert "a vehicle 100 (34 to 100) %" in line
    assert "surest word 0 (0 to 66)" in line
    assert "score >= .3 0 (0 to 66)" in line
    assert "{'cell phone': 2}" in line


def test_boxes_apart_do_not_overlap():
    assert TOOL["overlap"]((0, 0, 2, 2), (1, 0, 3, 2)) == pytest.approx(1 / 3)
    assert TOOL["overlap"]((0, 0, 2, 2), (3, 3, 4, 4)) == 0.0
