"""YOLO labels, read by globox; outlines and oriented boxes against the masks."""

from pathlib import Path

import numpy as np
import pytest
import shapely
import yaml
from globox import AnnotationSet
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from eyas.datasets.outlines import least_rectangles, outlines
from eyas.engine.recordings.format import CLASS_NAMES, objects_of

NAMES = list(CLASS_NAMES.values())
SIZE = np.array([160, 120])

MASKS = arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=9),
               elements=st.booleans(), fill=st.nothing()).filter(np.any)  # fmt: skip


def frames(data):
    """Yield the name of each label without ending, its frame and its objects."""
    for episode in data:
        for frame in episode:
            yield (
                f"{episode.split}/{episode.name}_{frame.number:06d}",
                frame,
                list(objects_of(frame.label)),
            )


def rows_of(folder: Path, name: str) -> list[tuple[str, np.ndarray]]:
    rows = (folder / f"labels/{name}.txt").read_text().splitlines()
    parts = [row.split() for row in rows]
    return [(NAMES[int(p[0])], np.array(p[1:], float).reshape(-1, 2) * SIZE) for p in parts]


@pytest.mark.parametrize("split", ["train", "val"])
def test_globox_reads_the_boxes_back(exported, data, split):
    folder = exported("yolo")
    loaded = AnnotationSet.from_yolo_v5(
        folder / "labels" / split, image_folder=folder / "images" / split
    )
    count = 0
    for name, _, seen in frames(data.split(split)):
        found = loaded[f"{name.split('/')[1]}.jpg"].boxes
        for box, each in zip(found, seen, strict=True):
            assert box.label == str(NAMES.index(each.name))
            assert box.ltrb == pytest.approx(each.label["visible_box"], abs=1e-3)
            count += 1
    assert count > 20


@pytest.mark.parametrize("name", ["yolo", "yolo-seg", "yolo-obb"])
def test_data_yaml_names_splits_and_classes(exported, name):
    folder = exported(name)
    facts = yaml.safe_load((folder / "data.yaml").read_text())
    assert facts == {
        "train": "images/train", "val": "images/val",
        "names": dict(enumerate(NAMES)),
    }  # fmt: skip
    for split in ("train", "val"):
        pictures = {path.stem for path in (folder / facts[split]).iterdir()}
        labels = {path.stem for path in (folder / "labels" / split).iterdir()}
        assert pictures == labels


def filled(points: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return which pixels' middles lie in a polygon, by crossings of a ray, as fillPoly decides."""
    x, y = np.arange(shape[1]) + 0.5, np.arange(shape[0]) + 0.5
    inside = np.zeros(shape, bool)
    for (x0, y0), (x1, y1) in zip(points, np.roll(points, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        crosses = (y > min(y0, y1)) & (y < max(y0, y1))
        at = x0 + (y - y0) * (x1 - x0) / (y1 - y0)
        inside ^= crosses[:, None] & (at[:, None] < x[None, :])
    return inside


@given(st.lists(MASKS, min_size=1, max_size=3))
def test_outlines_fill_their_masks_exactly(masks):
    for points, mask in zip(outlines(masks), masks, strict=True):
        assert np.array_equal(filled(points, mask.shape), mask)


def test_an_outline_has_only_the_corners():
    assert outlines([np.ones((7, 9), bool)])[0].tolist() == [[0, 0], [9, 0], [9, 7], [0, 7]]


@pytest.mark.parametrize("mask", [np.eye(2, dtype=bool), ~np.eye(2, dtype=bool)])
def test_pixels_that_touch_at_a_corner_are_on_one_path(mask):
    (points,) = outlines([mask])
    assert len(points) == 8


@given(MASKS)
def test_the_least_rectangle_is_that_of_shapely(mask):
    check_rectangle(mask, *least_rectangles([mask]))


def test_least_rectangles_of_triangles_lie_along_any_side():
    rng = np.random.default_rng(2)
    masks = [filled(rng.integers(0, 25, (3, 2)), (25, 25)) for _ in range(60)]
    masks = [mask for mask in masks if mask.any()]
    for mask, corners in zip(masks, least_rectangles(masks), strict=True):
        check_rectangle(mask, corners)


def check_rectangle(mask, corners):
    """Check that a rectangle is around all pixels, and no larger than that of shapely."""
    pixels = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for y, x in np.argwhere(mask)])
    rectangle = shapely.Polygon(corners)
    assert rectangle.buffer(1e-6).contains(pixels)
    best = pixels.minimum_rotated_rectangle
    assert rectangle.area <= best.area + 1e-6
    sides = np.diff(np.vstack([corners, corners[:1]]), axis=0)
    assert (sides * np.roll(sides, 1, axis=0)).sum(axis=1) == pytest.approx(np.zeros(4), abs=1e-6)


def test_segments_fill_the_masks_of_the_recording(exported, data):
    folder = exported("yolo-seg")
    for name, frame, seen in frames(data):
        masks = frame.masks()
        for (kind, points), each in zip(rows_of(folder, name), seen, strict=True):
            assert kind == each.name
            assert np.abs(points - points.round()).max() < 1e-3
            assert np.array_equal(filled(points.round(), masks.shape), masks == each.label["id"])


def test_globox_reads_the_segments(exported, data):
    folder = exported("yolo-seg")
    loaded = AnnotationSet.from_yolo_seg(
        folder / "labels/train", image_folder=folder / "images/train"
    )
    for name, _, seen in frames(data.split("train")):
        for box, each in zip(loaded[f"{name.split('/')[1]}.jpg"].boxes, seen, strict=True):
            assert box.ltrb == pytest.approx(each.label["visible_box"], abs=1e-3)


def test_oriented_boxes_are_around_the_visible_pixels(exported, data):
    folder = exported("yolo-obb")
    turned = 0
    for name, frame, seen in frames(data):
        masks = frame.masks()
        for (_, points), each in zip(rows_of(folder, name), seen, strict=True):
            assert points.shape == (4, 2)
            rectangle = shapely.Polygon(points).buffer(1e-3)
            rows, columns = np.nonzero(masks == each.label["id"])
            assert shapely.contains_xy(rectangle, columns + 0.5, rows + 0.5).all()
            left, top, right, bottom = each.label["visible_box"]
            assert rectangle.area <= 1.01 * (right - left) * (bottom - top) + 0.1
            turned += rectangle.area < 0.95 * (right - left) * (bottom - top)
    assert turned
