"""The link: what coding costs, against libjpeg, and what is lost."""

import io

import numpy as np
import pytest
from PIL import Image

from eyas.engine.camera.link import Link, LinkConfig
from eyas.engine.core.variation import Choice
from eyas.lanes import limit_threads, thread_count


def scene(height, width, seed=0):
    """Return a picture with flat parts, edges and some texture."""
    rng = np.random.default_rng(seed)
    rows, columns = np.indices((height, width))
    picture = np.stack([rows * 2, columns * 2, 200 - rows], axis=-1) % 256
    picture[height // 4 : height // 2, width // 3 : -width // 4] = (220, 40, 30)
    picture[height - height // 3 :] += rng.integers(0, 40, (height // 3, width, 3))
    return np.clip(picture, 0, 255).astype(np.uint8)


def link_of(count=1, **settings):
    link = Link(LinkConfig(**settings), count)
    for n in range(count):
        link.begin(n, np.random.default_rng(n))
    return link


def carried(link, pictures, step, trackers=None):
    rgb = np.array(pictures)
    trackers = np.arange(len(rgb)) if trackers is None else trackers
    link.carry(rgb, trackers, np.full(8, step))
    return rgb


def as_jpeg(picture, quality):
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "jpeg", quality=quality, subsampling="4:2:0")
    return np.array(Image.open(file))


@pytest.mark.parametrize("quality", [5, 30, 50, 75, 95])
@pytest.mark.parametrize("size", [(84, 84), (48, 64), (37, 51), (8, 8)])
def test_coding_costs_what_it_costs_in_libjpeg(size, quality):
    picture = scene(*size)
    ours = carried(link_of(quality=quality), picture[None], 0)[0].astype(float)
    theirs = as_jpeg(picture, quality).astype(float)
    lost = np.sqrt(np.square(theirs - picture).mean())
    apart = np.sqrt(np.square(theirs - ours).mean())
    assert lost > 1.5
    # libjpeg computes with whole numbers: coefficients near a half are rounded otherwise.
    assert apart < 1.0 + 0.25 * lost
    if size != (8, 8):
        assert np.median(np.abs(theirs - ours)) <= 1.0
        other = as_jpeg(picture, max(quality - 5, 1)).astype(float)
        assert apart < np.sqrt(np.square(theirs - other).mean())
    assert np.sqrt(np.square(ours - picture).mean()) == pytest.approx(lost, rel=0.05)


@pytest.mark.parametrize("across", [True, False])
def test_the_table_of_luminance_lies_the_right_way_round(across):
    line = np.random.default_rng(4).integers(60, 200, 64)
    grey = np.broadcast_to(line[None] if across else line[:, None], (64, 64))
    picture = np.repeat(grey[..., None], 3, axis=2).astype(np.uint8)
    ours = carried(link_of(quality=30), picture[None], 0)[0].astype(float)
    theirs = as_jpeg(picture, 30).astype(float)
    # All coefficients but those of one direction are 0.
    assert np.abs(ours - theirs).max() <= 2.0
    assert np.abs(ours - picture).max() > 10.0


def test_quality_may_vary_from_episode_to_episode():
    picture = scene(40, 40)
    link = link_of(6, quality=Choice(choice=(5.0, 90.0)))
    shown = carried(link, np.stack([picture] * 6), 0)
    errors = {round(float(np.abs(one.astype(int) - picture).mean()), 3) for one in shown}
    assert len(errors) == 2


def test_lost_slices_show_what_they_showed_before():
    link = link_of(quality=None, slices=4, slice_loss=0.5)
    before = carried(link, np.zeros((1, 40, 16, 3), np.uint8), 0)[0]
    assert not before.any()
    lost = []
    for step in range(1, 400):
        picture = np.full((1, 40, 16, 3), step % 250 + 1, np.uint8)
        shown = carried(link, picture, step)[0]
        again = carried(link, picture, step)[0]
        np.testing.assert_array_equal(shown, again)
        slices = shown.reshape(4, -1)
        old = before.reshape(4, -1)
        new = slices[:, 0] == picture[0, 0, 0, 0]
        assert (slices == slices[:, :1]).all()
        assert (slices[~new] == old[~new]).all()
        lost.append(1.0 - new.mean())
        before = shown
    assert np.mean(lost) == pytest.approx(0.5, abs=0.04)


def test_freezes_come_and_last_as_often_and_as_long_as_said():
    count = 8
    link = link_of(count, quality=None, freezes=0.5, freeze_time=0.4)
    frozen = []
    last = carried(link, np.zeros((count, 8, 8, 3), np.uint8), 0)
    for k in range(1, 3000):
        shown = carried(link, np.full((count, 8, 8, 3), k % 251, np.uint8), 20 * k)
        frozen.append((shown == last).all(axis=(1, 2, 3)))
        last = shown
    # Busy for 0.4 s and free for 2 s, by turns.
    assert np.mean(frozen) == pytest.approx(0.4 / 2.4, rel=0.12)


def test_bytes_depend_on_the_tracker_alone():
    pictures = np.stack([scene(44, 52, seed) for seed in range(4)])
    settings = {"slice_loss": 0.3, "freezes": 1.0, "quality": 20}
    together = link_of(4, **settings)
    threads = thread_count()
    alone = link_of(4, **settings)
    try:
        for step in range(0, 400, 20):
            moved = np.roll(pictures, step, axis=2)
            limit_threads(threads)
            shown = carried(together, moved, step)
            limit_threads(1)
            for n in (3, 1, 0, 2):
                one = carried(alone, moved[n : n + 1], step, np.array([n]))
                np.testing.assert_array_equal(one[0], shown[n])
    finally:
        limit_threads(threads)


def test_a_new_episode_begins_with_a_whole_picture():
    link = link_of(quality=None, slice_loss=1.0)
    carried(link, np.full((1, 16, 16, 3), 10, np.uint8), 0)
    assert (carried(link, np.full((1, 16, 16, 3), 20, np.uint8), 5) == 10).all()
    link.begin(0, np.random.default_rng(9))
    assert (carried(link, np.full((1, 16, 16, 3), 30, np.uint8), 0) == 30).all()
