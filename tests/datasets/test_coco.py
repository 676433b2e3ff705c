"""COCO, read and scored by pycocotools."""

import json
from contextlib import redirect_stdout
from io import StringIO

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from pycocotools import mask as coco_masks
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from eyas.datasets.rle import encoded_masks
from eyas.engine.recordings.format import objects_of


@pytest.fixture
def truths(exported):
    """The annotations of each split."""
    folder = exported("coco")
    with redirect_stdout(StringIO()):
        return {split: COCO(folder / "annotations" / f"{split}.json") for split in ("train", "val")}


@given(
    arrays(
        np.int32,
        array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=40),
        elements=st.sampled_from([0, 0, 0, 65536, 65537, 70000]),
    )
)
def test_codes_are_those_of_coco_s_own_tools(masks):
    codes = encoded_masks(masks)
    assert codes.keys() == set(np.unique(masks[masks != 0]).tolist())
    for number, (counts, area) in codes.items():
        mask = np.asfortranarray(masks == number, np.uint8)
        assert counts == coco_masks.encode(mask)["counts"].decode()
        assert area == mask.sum()


def test_long_runs_have_the_codes_of_coco_s_own_tools():
    masks = np.zeros((3000, 2000), np.int32)
    masks[2000:, 700:1999] = 65536
    masks[5, 5] = masks[2999, 1999] = 65536
    ((counts, _),) = encoded_masks(masks).values()
    assert counts == coco_masks.encode(np.asfortranarray(masks != 0, np.uint8))["counts"].decode()


@pytest.mark.parametrize("kind", ["bbox", "segm"])
@pytest.mark.parametrize("split", ["train", "val"])
def test_truth_against_itself_scores_one(truths, split, kind):
    truth = truths[split]
    rows = [
        {
            "image_id": row["image_id"],
            "category_id": row["category_id"],
            "score": 1.0,
            "bbox" if kind == "bbox" else "segmentation": row[
                "bbox" if kind == "bbox" else "segmentation"
            ],
        }
        for row in truth.dataset["annotations"]
    ]
    assert scored(truth, rows, kind)[:3] == pytest.approx([1.0, 1.0, 1.0])


def test_shifted_boxes_score_less(truths):
    truth = truths["train"]
    rows = [
        {**row, "score": 1.0, "bbox": [row["bbox"][0] + 0.3 * row["bbox"][2], *row["bbox"][1:]]}
        for row in truth.dataset["annotations"]
    ]
    assert scored(truth, rows, "bbox")[0] < 0.5


def scored(truth, rows, kind):
    with redirect_stdout(StringIO()):
        evaluation = COCOeval(truth, truth.loadRes(rows), kind)
        evaluation.evaluate()
        evaluation.accumulate()
        evaluation.summarize()
    return evaluation.stats.tolist()


@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # in its decode
def test_masks_decode_to_those_of_the_recording_pixel_for_pixel(truths, data):
    for split, truth in truths.items():
        names = {video["id"]: video["name"] for video in truth.dataset["videos"]}
        episodes = {episode.name: episode for episode in data.split(split)}
        for image in truth.dataset["images"]:
            frame = episodes[names[image["video_id"]]][image["frame_id"]]
            masks = frame.masks()
            rows = truth.imgToAnns[image["id"]]
            expected = [seen.label["id"] for seen in objects_of(frame.label)]
            assert len(rows) == len(expected)
            left = masks != 0
            for row, number in zip(rows, expected, strict=True):
                mask = truth.annToMask(row).astype(bool)
                assert np.array_equal(mask, masks == number)
                assert row["area"] == mask.sum()
                ys, xs = np.nonzero(mask)
                x, y, width, height = row["bbox"]
                assert (x, y, x + width, y + height) == (
                    *(xs.min(), ys.min(), xs.max() + 1, ys.max() + 1),
                )
                left &= ~mask
            assert not left.any()


def test_a_track_is_one_object_of_one_episode(truths, data):
    for split, truth in truths.items():
        tracks = {}
        names = {video["id"]: video["name"] for video in truth.dataset["videos"]}
        frames = {episode.name: episode for episode in data.split(split)}
        images = {image["id"]: image for image in truth.dataset["images"]}
        for image, rows in truth.imgToAnns.items():
            name = names[images[image]["video_id"]]
            label = frames[name][images[image]["frame_id"]].label
            for row, seen in zip(rows, objects_of(label), strict=True):
                tracks.setdefault(row["track_id"], set()).add((name, seen.label["id"]))
        assert all(len(objects) == 1 for objects in tracks.values())
        assert len({*map(tuple, tracks.values())}) == len(tracks)


def test_pictures_are_there_and_have_the_size_of_the_file(exported):
    folder = exported("coco", copies=True)
    for path in folder.glob("annotations/*.json"):
        content = json.loads(path.read_text())
        assert all((folder / image["file_name"]).is_file() for image in content["images"])
        assert {(image["width"], image["height"]) for image in content["images"]} == {(160, 120)}


def test_what_is_too_small_is_marked_as_ignored(exported):
    folder = exported("coco", least_side=12)
    rows = json.loads((folder / "annotations/train.json").read_text())["annotations"]
    marked = [bool(row["iscrowd"]) for row in rows]
    small = [min(row["amodal_bbox"][2:]) < 12 for row in rows]
    assert marked == small
    assert len(set(marked)) == 2
